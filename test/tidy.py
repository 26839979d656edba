#!/usr/bin/env python3
"""clang-tidy with the repository's .clang-tidy on the library, the programs and docs/examples. A finding is an error.

    test/tidy.py [FILE...]        some files alone, as named from the repository's root

Configures build/tidy with clang, to know how files are compiled, and builds nothing. Runs as many at once as
CMAKE_BUILD_PARALLEL_LEVEL says, or as there are cores.
Most of the time goes into the headers of Eigen and the standard library, which clang-tidy walks through for each
source. So sources of the same flags are tidied in groups: one source that includes its members. Members of a group
share no name that they declare in a namespace without a name. A group that still does not compile is tidied file by
file. In a group misc-unused-using-decls and misc-unused-alias-decls see nothing: they look at the outer file alone.
Exit code 0 if there is no finding, 1 if there is one or if clang-tidy failed on a file, 2 on a wrong call.
"""

import concurrent.futures
import json
import os
import re
import shlex
import shutil
import subprocess
import sys

ROOT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
BUILD = os.path.join(ROOT, "build", "tidy")
FOLDERS = ("core", "minimal", "refine", "problems", "tools", "docs/examples")
EXAMPLES_LIKE = "tools/rigel_estimate.cc"  # docs/examples is a project of its own: flags of a program
MOST_IN_GROUP = 6  # more of them hold more memory and leave cores idle at the end

# What a file declares at the beginning of a line; blocks in a namespace are not indented.
NAME = re.compile(r"^(?:template <[^\n]*>\n)?[A-Za-z][^\n;={}()]*?[ *&](\w+)(?=[ \[]*[({;=:]|\[)", flags=re.M)


def sources():
  for folder in FOLDERS:
    for where, folders, names in os.walk(os.path.join(ROOT, folder)):
      folders.sort()
      for name in sorted(names):
        if name.endswith(".cc"):
          yield os.path.relpath(os.path.join(where, name), ROOT)


def configure():
  os.makedirs(BUILD, exist_ok=True)
  done = subprocess.run(["cmake", "-S", ROOT, "-B", BUILD, "-G", "Ninja", "-DCMAKE_CXX_COMPILER=clang++",
                         "-DRIGEL_BUILD_TESTS=OFF", "-DRIGEL_CCACHE=OFF"], stdout=subprocess.PIPE,
                        stderr=subprocess.STDOUT, text=True, check=False)
  if done.returncode != 0:
    sys.exit(f"{done.stdout}failed: cmake")
  with open(os.path.join(BUILD, "compile_commands.json"), encoding="utf-8") as file:
    commands = json.load(file)
  flags = {}
  for entry in commands:
    path = os.path.relpath(os.path.realpath(entry["file"]), ROOT)
    words = shlex.split(entry["command"])[1:]
    kept, skip = [], False
    for word in words:
      if skip or word in ("-o", "-c"):
        skip = not skip and word in ("-o", "-c")
      else:
        kept.append(word)
    flags[path] = tuple(kept)
  return flags


def own_names(path):
  """What the file declares in namespaces without a name, and main."""
  with open(os.path.join(ROOT, path), encoding="utf-8") as file:
    text = file.read()
  names = set(re.findall(r"^int (main)\(", text, flags=re.M))
  for block in re.findall(r"^namespace \{$(.*?)^\}  // namespace$", text, flags=re.M | re.S):
    names.update(NAME.findall(block))
  return names


def grouped(files, flags):
  """Lists of files; those of one list have the same flags and share no name."""
  groups = []
  for path in files:
    names = own_names(path)
    for group in groups:
      if flags[group[0][0]] == flags[path] and len(group[0]) < MOST_IN_GROUP and not names & group[1]:
        group[0].append(path)
        group[1].update(names)
        break
    else:
      groups.append(([path], names))
  return [group[0] for group in groups]


def run(source, flags):
  command = ["clang-tidy", "--quiet", "--warnings-as-errors=*", f"--config-file={ROOT}/.clang-tidy", source, "--", *flags]
  return subprocess.run(command, capture_output=True, text=True, check=False)


def tidy(number, group, flags):
  """What clang-tidy says of the group, an empty text if nothing."""
  source = os.path.join(ROOT, group[0])
  if len(group) > 1:
    # Of sources that another includes, clang's analyzer looks only at those in a file of such a name.
    source = os.path.join(BUILD, f"UnifiedSource{number}.cc")
    with open(source, "w", encoding="utf-8") as file:
      for path in group:
        file.write(f'#include "{BUILD}/include/rigel/{path}"  // NOLINT(bugprone-suspicious-include)\n')
  done = run(source, flags)
  if done.returncode == 0:
    return ""
  if len(group) > 1 and ("clang-diagnostic-error" in done.stdout or "error:" not in done.stdout):
    return "".join(tidy(number, [path], flags) for path in group)
  if done.returncode != 1 or "error:" not in done.stdout:
    end = "\n".join(done.stderr.strip().split("\n")[-20:])
    return f"{' '.join(group)}: clang-tidy ended with {done.returncode} and no finding\n{done.stdout}{end}\n"
  return done.stdout


def main():
  if any(argument.startswith("-") for argument in sys.argv[1:]):
    print(__doc__)
    return 0 if sys.argv[1] in ("-h", "--help") else 2
  if not shutil.which("clang-tidy") or not shutil.which("clang++"):
    print("clang-tidy: clang-tidy or clang++ is not installed; tools/install_dependencies.sh clang clang-tidy")
    return 1
  flags = configure()
  files = sys.argv[1:] or list(sources())
  for path in files:
    if not os.path.isfile(os.path.join(ROOT, path)):
      print(f"there is no {path}")
      return 2
    if path.startswith("docs/examples/"):
      flags[path] = flags[EXAMPLES_LIKE]
  missing = [path for path in files if path not in flags]
  built = [path for path in files if path in flags]
  groups = grouped(built, flags)
  jobs = int(os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL") or os.cpu_count())
  with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
    found = list(pool.map(lambda item: tidy(item[0], item[1], flags[item[1][0]]), enumerate(groups)))
  for text in found:
    print(text, end="")
  for path in missing:
    print(f"not built here, for want of OpenCV or OpenGV: {path}")
  print(f"clang-tidy: {len(built)} files, groups: {len(groups)}; "
        f"{sum(map(bool, found)) or 'no'} {'of them with findings' if any(found) else 'finding'}")
  return 1 if any(found) or not built else 0


if __name__ == "__main__":
  sys.exit(main())
