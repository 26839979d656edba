#!/usr/bin/env python3
"""Whether the programs have the flags that the pages give them.

    test/page_flags.py BIN [SOURCE_DIRECTORY]

Looks in README.md, CONTRIBUTING.md and docs/*.md for `rigel_NAME --flag`, in blocks of code and in lines. Fails, with
one line for each finding, on a flag that the --help of that program in the folder BIN does not list. A program that is
not in BIN, as rigel_match without OpenCV, is passed over.
Exit code 0 if there is no finding, else 1; also 1 where there is no flag at all. 2 on a wrong call.
"""

import glob
import os
import re
import subprocess
import sys

BLOCK = re.compile(r"(?:^    [^\n]*\n)+", flags=re.M)


def commands(text):
  """The lines of the blocks of code, and the code within lines; what a backslash continues is one line."""
  text = text.replace("\\\n", " ")
  for block in BLOCK.findall(text):
    yield from block.split("\n")
  for code in re.findall(r"`([^`]+)`", BLOCK.sub("", text)):
    yield code.replace("\n", " ")


def flags(command):
  """Pairs of a program and a flag."""
  parts = re.split(r"(?<![\w/.-])(?:[\w./]*/)?(rigel_[a-z_]+(?:\.py)?)(?= |$)", command)
  for program, arguments in zip(parts[1::2], parts[2::2]):
    for flag in re.findall(r"(?<![\w-])--([a-z]\w*)", re.split(r" [|;&#]|[;)] ", arguments)[0]):
      yield program, flag


def known_flags(path):
  done = subprocess.run([path, "--help"], capture_output=True, text=True, check=False)
  names = set(re.findall(r"^  (?:-\w, )?--([a-z]\w*)", done.stdout, flags=re.M))
  # Of a switch --x also --nox.
  return names | {"no" + name for name in names} | {"help", "version", "flagfile"}


def main():
  if sys.argv[1:] in (["-h"], ["--help"]) or not 2 <= len(sys.argv) <= 3:
    print(__doc__)
    sys.exit(0 if sys.argv[1:] in (["-h"], ["--help"]) else 2)
  programs = sys.argv[1]
  root = sys.argv[2] if len(sys.argv) > 2 else os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
  known, findings, count = {}, [], 0
  for page in ["README.md", "CONTRIBUTING.md", *sorted(glob.glob("docs/*.md", root_dir=root))]:
    with open(os.path.join(root, page), encoding="utf-8") as file:
      text = file.read()
    for command in commands(text):
      for program, flag in flags(command):
        path = os.path.join(programs, program)
        if not os.path.exists(path):
          continue
        if program not in known:
          known[program] = known_flags(path)
        count += 1
        if flag not in known[program]:
          findings.append(f"{page}: {program} has no --{flag}: {command.strip()}")
  for finding in findings:
    print(finding)
  print(f"{count} flags of {len(known)} programs, {len(findings)} findings")
  sys.exit(1 if findings or not count else 0)


if __name__ == "__main__":
  main()
