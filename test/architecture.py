#!/usr/bin/env python3
"""Who may include whom, how tests are named, and which headers are installed.

    test/architecture.py [SOURCE_DIRECTORY]

Reads the #include lines of the library and the programs. Fails, with one line for each finding, on
  - an include that the table below does not allow, a folder that is not in it, and a cycle between modules;
  - an include that names no file, or that leaves out "rigel/" and so hides from this table;
  - a test of the library whose name does not begin with a header of its folder, or with the folder's own name;
  - an installed header that is neither public nor included by one that is, and on one of these that is not installed.
The public headers are those of the tables of docs/api.md; the installed ones are listed in cmake/RigelHeaders.cmake.
Exit code 0 if there is no finding, else 1.
"""

import os
import re
import sys

# Each module with the modules it may use, all of which stand above it. Tests
# see all.
MAY_USE = {
    "core": "",
    "minimal/numerics": "core",
    "minimal/solvers": "core minimal/numerics",
    "minimal": "core minimal/solvers",
    "minimal/ransac": "core minimal",
    "refine/least_squares": "core",
    "refine/search": "core minimal/solvers minimal minimal/ransac refine/least_squares",
    "refine": "core minimal/solvers minimal minimal/ransac refine/least_squares refine/search",
    "problems/io": "core",
    "problems/sensors": "core problems/io",
    "problems/scenes": "core problems/io",
    "problems/rigs": "core problems/io",
    "problems/images": "core problems/io problems/rigs",
    "problems/trajectories": "core refine problems/io",
    "problems/calibration": "core problems/io",
    "problems/evaluation":
        "core minimal refine/least_squares refine/search refine problems/io problems/scenes problems/trajectories",
    "problems/benchmarks":
        "core minimal minimal/ransac refine/least_squares refine problems/io problems/scenes problems/evaluation",
    "problems/experiments": "core minimal problems/io problems/scenes problems/evaluation",
    "tools":
        "core minimal refine/least_squares refine problems/io problems/sensors problems/scenes problems/rigs "
        "problems/images problems/trajectories problems/calibration problems/evaluation problems/benchmarks "
        "problems/experiments",
}

FEWEST_PUBLIC, MOST_PUBLIC, MOST_INSTALLED = 12, 25, 30


def read(root, path):
  with open(os.path.join(root, path), encoding="utf-8") as file:
    return file.read()


def source_files(root):
  for layer in sorted({module.split("/")[0] for module in MAY_USE}):
    for folder, folders, names in os.walk(os.path.join(root, layer)):
      folders.sort()
      for name in sorted(names):
        if name.endswith((".h", ".cc")):
          yield os.path.relpath(os.path.join(folder, name), root)


def check_table(findings):
  above = set()
  for module, uses in MAY_USE.items():
    for used in uses.split():
      if used not in above:
        findings.append(f"the table lets {module} use {used}, which does not stand above it")
    above.add(module)


def find_cycle(arrows):
  """Modules that use each other in turn, the first again at the end; empty if there are none."""
  done = set()

  def visit(module, path):
    if module in path:
      return path[path.index(module):] + [module]
    if module in done:
      return []
    for used in sorted(arrows.get(module, ())):
      cycle = visit(used, path + [module])
      if cycle:
        return cycle
    done.add(module)
    return []

  for module in sorted(arrows):
    cycle = visit(module, [])
    if cycle:
      return cycle
  return []


TALK = re.compile(r"\b(?:std::)?(?:f?printf|puts|getenv)\(|std::(?:cerr|cout|clog)\b")


def check_includes(root, findings):
  """The includes of each file, and the arrows between modules."""
  includes, arrows = {}, {}
  for path in source_files(root):
    module = os.path.dirname(path)
    if module not in MAY_USE:
      findings.append(f"{path}: the folder is no module of the table")
      continue
    includes[path] = []
    for number, line in enumerate(read(root, path).split("\n"), 1):
      if not module.startswith("tools") and TALK.search(line.split("//")[0]):
        findings.append(f"{path}:{number}: a library prints nothing and reads no environment")
      match = re.match(r'\s*#\s*include\s*(?:"([^"]*)"|<(rigel/[^>]*)>)', line)
      if not match:
        continue
      where = f"{path}:{number}"
      if match[2]:
        findings.append(f"{where}: <{match[2]}>: write it in quotes")
      elif not match[1].startswith("rigel/"):
        findings.append(f'{where}: "{match[1]}" does not begin with rigel/')
        continue
      used = (match[1] or match[2])[len("rigel/"):]
      if not os.path.isfile(os.path.join(root, used)):
        findings.append(f"{where}: there is no {used}")
        continue
      includes[path].append(used)
      used_module = os.path.dirname(used)
      if used_module == module:
        continue
      arrows.setdefault(module, set()).add(used_module)
      if used_module not in MAY_USE[module].split():
        findings.append(f"{where}: {module} may not use {used_module} ({used})")
  cycle = find_cycle(arrows)
  if cycle:
    findings.append("a cycle of modules: " + " -> ".join(cycle))
  return includes, arrows


def with_included(headers, includes):
  found, todo = set(), list(headers)
  while todo:
    header = todo.pop()
    if header not in found:
      found.add(header)
      todo += includes.get(header, [])
  return found


def check_headers(root, includes, findings):
  public = re.findall(r"^\| `([^`]+\.h)` \| \S", read(root, "docs/api.md"), flags=re.M)
  text = re.search(r"set\(RIGEL_HEADERS\s([^)]*)\)", read(root, "cmake/RigelHeaders.cmake"))
  installed = text[1].split() if text else []
  for header in sorted(set(public) - set(includes)):
    findings.append(f"docs/api.md: there is no {header}")
  needed = with_included(public, includes)
  for header in sorted(set(installed) - needed):
    findings.append(f"cmake/RigelHeaders.cmake: {header} is installed, and docs/api.md neither lists nor needs it")
  for header in sorted(needed - set(installed)):
    findings.append(f"cmake/RigelHeaders.cmake: {header} is needed by the headers of docs/api.md, and not installed")
  for name, headers in (("docs/api.md", public), ("cmake/RigelHeaders.cmake", installed)):
    if len(set(headers)) != len(headers):
      findings.append(f"{name}: a header stands there twice")
  if not FEWEST_PUBLIC <= len(public) <= MOST_PUBLIC:
    findings.append(f"docs/api.md: {len(public)} headers, expected {FEWEST_PUBLIC} to {MOST_PUBLIC}")
  if len(installed) > MOST_INSTALLED:
    findings.append(f"cmake/RigelHeaders.cmake: {len(installed)} headers, expected at most {MOST_INSTALLED}")
  return public, installed


def check_tests(root, findings):
  """Whether each test of the library names a header, or the folder of several."""
  for layer in ("core", "minimal", "refine", "problems"):
    for folder, _, names in os.walk(os.path.join(root, "test", layer)):
      tested = os.path.relpath(folder, os.path.join(root, "test"))
      subjects = {os.path.basename(tested)}
      if os.path.isdir(os.path.join(root, tested)):
        subjects.update(name[:-2] for name in os.listdir(os.path.join(root, tested)) if name.endswith(".h"))
      for name in sorted(names):
        words = name[:-len("_test.cc")].split("_") if name.endswith("_test.cc") else []
        if words and not any("_".join(words[:n]) in subjects for n in range(1, len(words) + 1)):
          findings.append(f"test/{tested}/{name}: neither a header of {tested} nor {os.path.basename(tested)} comes first")


def main():
  if sys.argv[1:] in (["-h"], ["--help"]):
    print(__doc__)
    sys.exit(0)
  root = sys.argv[1] if len(sys.argv) > 1 else os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
  findings = []
  check_table(findings)
  includes, arrows = check_includes(root, findings)
  public, installed = check_headers(root, includes, findings)
  check_tests(root, findings)
  for finding in findings:
    print(finding)
  print(f"{len(includes)} files, {len(MAY_USE)} modules, {sum(map(len, arrows.values()))} arrows; "
        f"{len(public)} public headers, {len(installed)} installed")
  sys.exit(1 if findings else 0)


if __name__ == "__main__":
  main()
