#!/usr/bin/env python3
"""Whether what the pages name exists.

    test/links.py [SOURCE_DIRECTORY]

Reads all Markdown files of the source tree. Fails, with one line for each finding, on
  - a link to a file that is not there, or to a heading that its page does not have;
  - a file of the source tree, named with its folder, that is not there, also in the comments of sources and scripts;
  - a header that a comment names and no folder has;
  - C++ code of the README that is not in docs/examples/first_motion.cc, which a test compiles and runs;
  - a name that a page says is in such a file, as `core/pose.h`, `RotationY()`, and that the file does not have.
A NAME.h stands for any file. CHANGELOG.md may name what is gone.
Exit code 0 if there is no finding, else 1; also 1 where there is no page at all.
"""

import os
import re
import sys

FOLDERS = ("core", "minimal", "refine", "problems", "tools", "test", "docs", "cmake")
SKIPPED = (".git", "build", "seeds", "compatibility")
SOURCES = (".h", ".cc", ".py", ".sh", ".cmake")
README_EXAMPLE = "docs/examples/first_motion.cc"
FILE = re.compile(r"(?<![\w/.$}-])(?:rigel/|\./)?((?:" + "|".join(FOLDERS) +
                  r")/[\w./+-]*\.(?:h|cc|md|py|sh|json|cmake|txt|png))(?![\w*])")


def files(root):
  for folder, folders, names in os.walk(root):
    folders[:] = sorted(name for name in folders if name not in SKIPPED)
    for name in sorted(names):
      yield os.path.relpath(os.path.join(folder, name), root)


def read(root, path):
  with open(os.path.join(root, path), encoding="utf-8") as file:
    return file.read()


def without_code(text):
  text = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
  return re.sub(r"`[^`\n]*`", lambda match: match[0] if "](" not in match[0] else "", text)


def anchors(text):
  """The anchors of the headings, as GitHub makes them."""
  found = set()
  for heading in re.findall(r"^#+ +(.*?) *$", re.sub(r"^```.*?^```", "", text, flags=re.M | re.S), flags=re.M):
    heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
    found.add(re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-"))
  return found


def page_findings(root, page):
  text = read(root, page)
  for target in re.findall(r"\]\(([^)\s]+)\)", without_code(text)):
    if re.match(r"[a-z]+:", target):
      continue
    name, _, anchor = target.partition("#")
    path = os.path.normpath(os.path.join(os.path.dirname(page), name)) if name else page
    if not os.path.exists(os.path.join(root, path)):
      yield f"{page}: the link {target} leads nowhere"
    elif anchor and anchor not in anchors(read(root, path)):
      yield f"{page}: {path} has no heading #{anchor}"
  if page == "CHANGELOG.md":
    return
  for path, names in re.findall(r"`([\w/]+/[\w.]+\.(?:h|cc|py))`((?:, `[\w:]+(?:\(\))?`)+)", text):
    if not os.path.exists(os.path.join(root, path)):
      continue  # told below
    content = read(root, path)
    for name in re.findall(r"[\w:]+", names):
      if not re.search(r"\b" + name.split("::")[-1] + r"\b", content):
        yield f"{page}: {path} does not have {name}"


def readme_code_findings(root):
  """The C++ lines of the README, in their order, are lines of its example; comments /* */ stand for what is left out."""
  blocks = "".join(re.findall(r"^```cpp\n(.*?)^```", read(root, "README.md"), flags=re.M | re.S))
  if not blocks:
    yield "README.md: there is no C++ code"
  example = iter([line.strip() for line in read(root, README_EXAMPLE).split("\n")])
  for line in blocks.split("\n"):
    if line.strip() and "/*" not in line and line.strip() not in example:
      yield f"README.md: not in {README_EXAMPLE}, or not in this place: {line}"
      return


def named_files(root, path, headers):
  text = read(root, path)
  for name in sorted(set(FILE.findall(text))):
    if "NAME" not in name and not os.path.exists(os.path.join(root, name)):
      yield f"{path}: there is no {name}"
  if path.endswith((".h", ".cc")):
    comments = "\n".join(re.findall(r"//.*", text))
    for name in sorted(set(re.findall(r"\b\w+\.h\b", comments)) - headers):
      yield f"{path}: there is no {name}"


def main():
  if sys.argv[1:] in (["-h"], ["--help"]):
    print(__doc__)
    sys.exit(0)
  root = sys.argv[1] if len(sys.argv) > 1 else os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
  pages = 0
  findings = []
  headers = {os.path.basename(path) for path in files(root) if path.endswith(".h")}
  for path in files(root):
    if path.endswith(".md"):
      pages += 1
      findings += page_findings(root, path)
    if path.endswith(SOURCES + (".md",)) and path != "CHANGELOG.md":
      findings += named_files(root, path, headers)
  if os.path.exists(os.path.join(root, README_EXAMPLE)):
    findings += readme_code_findings(root)
  for finding in findings:
    print(finding)
  if pages == 0:
    print(f"{root}: no page")
  return 1 if findings or pages == 0 else 0


if __name__ == "__main__":
  sys.exit(main())
