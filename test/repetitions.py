#!/usr/bin/env python3
"""Whether the same lines stand in two places.

    test/repetitions.py [SOURCE_DIRECTORY]

Reads what is written by hand in core, minimal, refine, problems, tools and cmake: *.h, *.cc, *.py, *.sh, *.cmake and
CMakeLists.txt, and the one of the root. Fails, with one line for each finding, on a run of eight or more equal lines in
two places, of two files or of one, and names both.
Lines are compared without the blanks at their ends. Blank lines do not count: the lines before and after one follow
each other. Lines of #include, import and from do not count either: two files that use the same thing say so in the same
words. All else counts, comments and lines of brackets too; there is no text of a licence in the files that had to be
left out. Tests are left out: each is to be read alone.
Before that the script holds itself against a text with eight equal lines and one with seven.
Exit code 0 if there is no finding, else 1; also 1 where there is no file at all.
"""

import os
import re
import sys

FOLDERS = ("core", "minimal", "refine", "problems", "tools", "cmake")
FEWEST_LINES = 8

NO_LINE = re.compile(r"\s*$|\s*#\s*include\b|\s*(?:import|from)\s+[\w.]+")


def is_source(name):
  return name.endswith((".h", ".cc", ".py", ".sh", ".cmake")) or name == "CMakeLists.txt"


def source_files(root):
  if os.path.isfile(os.path.join(root, "CMakeLists.txt")):
    yield "CMakeLists.txt"
  for layer in FOLDERS:
    for folder, folders, names in os.walk(os.path.join(root, layer)):
      folders.sort()
      for name in sorted(filter(is_source, names)):
        yield os.path.relpath(os.path.join(folder, name), root)


def lines_of(text):
  """(number, line without blanks around it) of each line that counts."""
  return [(number, line.strip()) for number, line in enumerate(text.split("\n"), 1) if not NO_LINE.match(line)]


def length_of_run(lines1, k1, lines2, k2):
  """Equal lines from k1 and k2 on; a run does not overlap with itself."""
  length = 0
  while k1 + length < len(lines1) and k2 + length < len(lines2) and lines1[k1 + length][1] == lines2[k2 + length][1] \
      and not (lines1 is lines2 and k1 + length == k2):
    length += 1
  return length


def find(texts):
  """One line for each run that stands in a second place; `texts` by the path of their file."""
  findings = []
  first = {}  # where each eight lines stand first: path and place
  files = {}
  for path, text in texts.items():
    lines = files[path] = lines_of(text)
    k = 0
    while k + FEWEST_LINES <= len(lines):
      key = tuple(line for _, line in lines[k:k + FEWEST_LINES])
      path1, k1 = first.setdefault(key, (path, k))
      length = length_of_run(files[path1], k1, lines, k) if (path1, k1) != (path, k) else 0
      if length < FEWEST_LINES:
        k += 1
        continue
      findings.append(f"{path}:{lines[k][0]}: {length} lines as from {path1}:{files[path1][k1][0]} on: {lines[k][1][:60]}")
      k += length
  return findings


def check_itself():
  equal = "\n".join(f"step({k});" for k in range(FEWEST_LINES))
  fewer = equal.rsplit("\n", 1)[0]
  block = "\n".join(f'#include "{k}.h"\nimport m{k}' for k in range(FEWEST_LINES))
  spread = equal.replace("\n", "\n\n  ")
  return find({"a": f"a\n{equal}\na", "b": f"b\nb\n{spread}\nb"}) == ["b:3: 8 lines as from a:2 on: step(0);"] and \
      find({"a": f"a\n{equal}\nb\n{equal}"}) == ["a:11: 8 lines as from a:2 on: step(0);"] and \
      not find({"a": f"a\n{equal}", "b": f"b\n{fewer}"}) and not find({"a": f"a\n{block}", "b": f"b\n{block}"}) and \
      not find({"a": "same\n" * (2 * FEWEST_LINES - 1)}) and len(find({"a": "same\n" * (2 * FEWEST_LINES)})) == 1


def main():
  if sys.argv[1:] in (["-h"], ["--help"]):
    print(__doc__)
    sys.exit(0)
  root = sys.argv[1] if len(sys.argv) > 1 else os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
  texts = {}
  for path in source_files(root):
    with open(os.path.join(root, path), encoding="utf-8") as file:
      texts[path] = file.read()
  findings = find(texts)
  if not check_itself():
    findings.append("the script does not find what it should")
  if not texts:
    findings.append(f"{root}: no file found")
  for finding in findings:
    print(finding)
  print(f"{len(texts)} files, {len(findings)} findings")
  sys.exit(1 if findings else 0)


if __name__ == "__main__":
  main()
