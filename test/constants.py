#!/usr/bin/env python3
"""Whether each named number says its unit and its reason.

    test/constants.py [SOURCE_DIRECTORY]

Reads the constants of core, minimal, problems and tools: declarations that begin with constexpr or const, maybe after
static or inline, of a name kLikeThis and a value with a number in it. Fails, with one line for each finding, on one
without a comment of at least four words: on its own lines, in the comment lines right above it, or both together. The
unit alone is no reason. That what the comment says is true, a reader has to judge.
A comment above covers the constants that follow it line by line if it has the word "these" or "both".
Fails also on a number without a name in a comparison or a product of decimals, as `x < 0.01` and `1.5 * x`. Allowed are
0, 0.5, 1 and 2, and in products whole numbers below 10, 0.25 and powers of ten, which formulas and units have. And on a
member of a public header (docs/api.md) with a number as its default and without such a comment. 0, 1 and members
num_... need none.
No comment is asked of a constant that its name and value explain:
  - one without a number: texts, truth values, what others compute;
  - a table with texts in its rows, as of names and columns: each row names itself;
  - one that other names define, as a size of others: no number in it has more than one digit;
  - a number of mathematics: 15 digits or more, or a fraction of two digits, as 1.0 / 3.0;
  - how many of one unit another has: kThisPerThat;
  - marks, of which only the name counts: -1 for "none", and the exit codes kExit...
Exit code 0 if there is no finding, else 1; also 1 where there is no constant at all.
"""

import os
import re
import sys

FOLDERS = ("core", "minimal", "problems", "tools")
FEWEST_WORDS = 4

# A comment, or a text in quotes.
COMMENT_OR_TEXT = re.compile(r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"|(?<!\w)'(?:\\.|[^'\\\n])+'", flags=re.S)
CONSTANT = re.compile(
    r"^[ \t]*(?:(?:static|inline)[ ]+)*(?:constexpr|const)[ ]+(?P<type>[\w:<>,*& ]+?)[ ]?(?<!\w)(?P<name>k[A-Z]\w*)"
    r"(?:\[[^\]]*\])*[ ]*(?:=(?!=)|(?=\{))", flags=re.M)
NUMBER = re.compile(r"(?<![\w.])(?:0[xX][0-9a-fA-F']+|(?:\d[\d']*\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)[fFuUlL]*")
TYPE = re.compile(r"\b(?:std::)?(?:size_t|u?int\d*(?:_t)?|double|float|unsigned|long|char)\b")

DECIMAL = r"(?<![\w.])(?:\d+\.\d*(?:[eE][-+]?\d+)?|\d+[eE][-+]?\d+)(?![\w.])"
COMPARED = re.compile(r"(?:(?<![<>-])[<>]=?[ ]*-?(" + DECIMAL + r")(?![ ]*\*))|(" + DECIMAL + r")[ ]*[<>]=?(?![<>])")
MULTIPLIED = re.compile(r"\*[ ]*-?(" + DECIMAL + r")|(" + DECIMAL + r")[ ]*\*")
MEMBER = re.compile(r"^  (?:double|int|size_t|uint64_t)[ ]+(?P<name>[a-z]\w*)[ ]*=[ ]*(?P<value>-?[\d.eE+-]+);", flags=re.M)


def source_files(root):
  for layer in FOLDERS:
    for folder, folders, names in os.walk(os.path.join(root, layer)):
      folders.sort()
      for name in sorted(names):
        if name.endswith((".h", ".cc")):
          yield os.path.relpath(os.path.join(folder, name), root)


def split(text):
  """The code with blanks for comments and empty quotes for texts, of the same lines, and the comment of each line."""
  comments = {}

  def blank(match):
    found = match[0]
    if found[0] != "/":
      return found[0] + " " * (len(found) - 2) + found[-1]
    first = text.count("\n", 0, match.start())
    for i, line in enumerate(found.split("\n")):
      comments[first + i] = line.strip("/* ")
    return re.sub(r"[^\n]", " ", found)

  return COMMENT_OR_TEXT.sub(blank, text), comments


def end_of_statement(code, begin):
  depth = 0
  for i in range(begin, len(code)):
    if code[i] in "([{":
      depth += 1
    elif code[i] in ")]}":
      depth -= 1
    elif code[i] == ";" and depth == 0:
      return i
  return len(code)


def explains_itself(name, value):
  numbers = NUMBER.findall(value)
  if not numbers or '"' in value:
    return True
  digits = [re.sub(r"[eE].*|[^\d]", "", number) for number in numbers]
  names = re.search(r"(?<!\w)[A-Za-z_]\w*", TYPE.sub("", NUMBER.sub("", value)))
  if names and all(re.fullmatch(r"\d[uUlL]*", number) for number in numbers):
    return True
  if len(digits) == 1 and len(digits[0]) >= 15 or re.fullmatch(r"\s*\d\.0 / \d\.0\s*", value):
    return True
  if re.fullmatch(r"k\w+Per[A-Z]\w*", name):
    return True
  return re.fullmatch(r"\s*-1\s*", value) or name.startswith("kExit")


def words(comment):
  return re.findall(r"\S*\w\S*", comment)


def check_file(path, text, findings):
  """How many constants the file has, and how many of these explain themselves."""
  code, comments = split(text)
  lines = code.split("\n")
  last_end, above = -1, ""  # the line of the last constant's end, and the comment above the first of its run
  constants = exempt = 0
  for match in CONSTANT.finditer(code):
    end = end_of_statement(code, match.end())
    first = code.count("\n", 0, match.start())
    last = code.count("\n", 0, end)
    top = first
    while top - 1 in comments and not lines[top - 1].strip():
      top -= 1
    own = " ".join(comments[i] for i in range(top, first))
    if top < first:
      above = own
    elif first == last_end + 1:
      own = above if re.search(r"\b(?:these|both)\b", above, flags=re.I) else ""
    else:
      above = ""
    last_end = last
    constants += 1
    if explains_itself(match["name"], code[match.end():end]):
      exempt += 1
      continue
    said = own + " " + " ".join(comments[i] for i in range(first, last + 1) if i in comments)
    if len(words(said)) < FEWEST_WORDS:
      declaration = " ".join(text[match.start():end].split())
      findings.append(f"{path}:{first + 1}: no unit and reason: {declaration[:100]}")
  return constants, exempt


def is_plain(number, in_product):
  value = float(number)
  if value in (0, 0.5, 1, 2):
    return True
  return in_product and (value == 0.25 or value < 10 and value.is_integer() or re.fullmatch(r"10*", f"{value:.0f}") or
                         re.fullmatch(r"1e-\d+", number))


def check_bare(path, text, findings):
  """Comparisons and products with numbers that have no name."""
  code, _ = split(text)
  constants = [(match.start(), end_of_statement(code, match.end())) for match in CONSTANT.finditer(code)]
  for pattern in (COMPARED, MULTIPLIED):
    for match in pattern.finditer(code):
      number = match[1] or match[2]
      if is_plain(number, pattern is MULTIPLIED) or any(begin <= match.start() <= end for begin, end in constants):
        continue
      line = code.count("\n", 0, match.start())
      findings.append(f"{path}:{line + 1}: {number} has no name: {text.splitlines()[line].strip()[:100]}")


def check_members(path, text, findings):
  """Members of a public header with a number as their default."""
  code, comments = split(text)
  lines = code.split("\n")
  for match in MEMBER.finditer(code):
    if float(match["value"]) in (0, 1, -1) or match["name"].startswith("num_"):
      continue
    line = top = code.count("\n", 0, match.start())
    while top - 1 in comments and not lines[top - 1].strip():
      top -= 1
    said = " ".join(comments[i] for i in range(top, line + 1) if i in comments)
    if len(words(said)) < FEWEST_WORDS:
      findings.append(f"{path}:{line + 1}: no unit and reason: {match[0].strip()}")


def public_headers(root):
  with open(os.path.join(root, "docs/api.md"), encoding="utf-8") as file:
    return set(re.findall(r"^\| `([^`]+\.h)` \| \S", file.read(), flags=re.M))


def main():
  if sys.argv[1:] in (["-h"], ["--help"]):
    print(__doc__)
    sys.exit(0)
  root = sys.argv[1] if len(sys.argv) > 1 else os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
  findings, bare = [], []
  public = public_headers(root)
  files = constants = exempt = 0
  for path in source_files(root):
    with open(os.path.join(root, path), encoding="utf-8") as file:
      text = file.read()
    counts = check_file(path, text, findings)
    check_bare(path, text, bare)
    if path in public:
      check_members(path, text, bare)
    files += 1
    constants += counts[0]
    exempt += counts[1]
  if not constants:
    print(f"{root}: no constant found")
  for finding in findings + bare:
    print(finding)
  print(f"{files} files, {constants} constants; {exempt} explain themselves, {constants - exempt - len(findings)} are "
        f"explained, {len(findings)} are not; "
        f"{len(bare)} other findings")
  sys.exit(1 if findings or bare or not constants else 0)


if __name__ == "__main__":
  main()
