#!/usr/bin/env python3
"""How long the sentences of a page are.

    test/sentences.py [--long=WORDS] [--max_lines=N] [--max_mean=WORDS] PAGE...
    test/sentences.py --max_words=WORDS FOLDER...

Prints for each Markdown page its lines, its sentences and their mean number of words; with --long also each sentence
of more words than that. Code, tables, headings and HTML comments are no sentences. A word has a letter or a digit. A
sentence ends at . ! or ?, at the end of its paragraph or of its list item.
With --max_words: each sentence of more words in the comments of the headers in these folders and below. Comment lines
that are indented, as equations and lists, are no sentences.
Exit code 1 if a page has more lines or a larger mean than is allowed or a sentence more words, 2 on a wrong call, else
0.
"""

import argparse
import os
import re
import sys

LIST_ITEM = re.compile(r"\s*(?:[-*]|\d+\.)\s+")


def paragraphs(text):
  """The prose of a page: one string for each paragraph and each list item."""
  text = re.sub(r"<!--.*?-->", "", text, flags=re.S)
  text = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
  found, lines, in_list = [], [], False
  for line in text.split("\n") + [""]:
    is_item = LIST_ITEM.match(line)
    is_code = line.startswith("    ") and not lines and not (in_list and is_item)
    if is_item or is_code or not line.strip() or line.startswith(("#", "|")):
      if lines:
        found.append(" ".join(lines))
      lines = []
    if line.strip() and not is_code and not line.startswith(("#", "|")):
      in_list = bool(is_item) or (in_list and line.startswith(" "))
      lines.append(LIST_ITEM.sub("", line, count=1) if is_item else line.strip())
  return found


def sentences(text):
  for paragraph in paragraphs(text):
    paragraph = re.sub(r"!\[[^\]]*\]\([^)]*\)", "", paragraph)  # pictures
    paragraph = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", paragraph)  # of a link its text
    for sentence in re.split(r"(?<=[.!?])(?<!\.\.)[*\")]*\s+", paragraph):
      words = [word for word in sentence.split() if re.search(r"\w", word)]
      if words:
        yield words


def header_paragraphs(text):
  found, lines = [], []
  for line in text.split("\n") + [""]:
    comment = re.match(r"\s*// ?(\S.*)", line)
    if comment:
      lines.append(comment[1].strip())
    elif lines:
      found.append(" ".join(lines))
      lines = []
  return found


def long_sentences(folders, max_words):
  headers = 0
  for folder in folders:
    for where, below, names in os.walk(folder):
      below.sort()
      for name in sorted(names):
        if not name.endswith(".h"):
          continue
        headers += 1
        with open(os.path.join(where, name), encoding="utf-8") as file:
          found = [words for text in header_paragraphs(file.read()) for words in sentences(text)]
        for words in found:
          if len(words) > max_words:
            yield f"{os.path.join(where, name)}: {len(words)} words: {' '.join(words)}"
  if headers == 0:
    yield "no header"


def main():
  parser = argparse.ArgumentParser(description=__doc__.split("\n")[0], allow_abbrev=False)
  parser.add_argument("--long", type=int, metavar="WORDS")
  parser.add_argument("--max_lines", type=int, metavar="N")
  parser.add_argument("--max_mean", type=float, metavar="WORDS")
  parser.add_argument("--max_words", type=int, metavar="WORDS")
  parser.add_argument("page", nargs="+", metavar="PAGE or FOLDER")
  arguments = parser.parse_args()
  if arguments.max_words is not None:
    found = list(long_sentences(arguments.page, arguments.max_words))
    for text in found:
      print(text)
    return 1 if found else 0
  missed = False
  print("lines sentences  mean  page")
  for page in arguments.page:
    with open(page, encoding="utf-8") as file:
      text = file.read()
    lines = text.count("\n")
    found = list(sentences(text))
    mean = sum(map(len, found)) / max(len(found), 1)
    print(f"{lines:5} {len(found):9} {mean:5.1f}  {page}")
    for words in found:
      if arguments.long is not None and len(words) > arguments.long:
        print(f"      {len(words)} words: {' '.join(words)}")
    if arguments.max_lines is not None and lines > arguments.max_lines:
      print(f"{page}: {lines} lines, at most {arguments.max_lines} are allowed", file=sys.stderr)
      missed = True
    if arguments.max_mean is not None and mean > arguments.max_mean:
      print(f"{page}: {mean:.1f} words a sentence, at most {arguments.max_mean:g} are allowed", file=sys.stderr)
      missed = True
  return 1 if missed else 0


if __name__ == "__main__":
  sys.exit(main())
