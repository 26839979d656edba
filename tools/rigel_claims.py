#!/usr/bin/env python3
"""Checks claims, of the paper and of Rigel, against the results of rigel_experiment.

  rigel_claims.py DIR

Reads NAME.json of each experiment in DIR, prints a verdict on each claim, and writes claims.md and
claims.json to DIR. The claims are data: rigel_claims.json, beside this script (docs/formats.md).
rigel_experiment runs this script after each run. It needs only Python's standard library.

Exit code: 0 done, 1 failed, 2 wrong flag.
"""
import argparse
import json
import os
import sys
import textwrap

sys.dont_write_bytecode = True  # the folder of the programs stays as it was installed
from rigel_claims_results import Results
from rigel_claims_verdict import Claim
from rigel_files import Bad, printable, read_json, write_whole

VERSION = "@PROJECT_VERSION@"
FIRST_LINE = "<!-- Written by rigel_claims.py; do not edit. -->"
TABLE_HEAD = ["| of | experiment | claim | verdict | figures | where not |",
              "| --- | --- | --- | --- | --- | --- |"]
LIST = os.path.join(os.path.dirname(os.path.abspath(__file__)), "rigel_claims.json")


def read_list(path):
    """(claims, groups of solvers, units of x by experiment)."""
    text = read_json(path)
    claims = []
    for entry in text["claims"]:
        for each in entry.get("each", [{}]):
            claims.append({**entry, **each, "claim": entry["claim"].format(**each)})
    return claims, text["groups"], text["experiments"]


def read_results(directory, units):
    """Results by experiment, in the order of the list; what cannot be read is told."""
    results = {}
    for name, unit in units.items():
        path = os.path.join(directory, name + ".json")
        if not os.path.exists(path):
            continue
        try:
            results[name] = Results(read_json(path), name, unit is not None)
        except (Bad, AttributeError, KeyError, OverflowError, TypeError, ValueError) as error:
            what = " ".join(str(error).removeprefix(path + ": ").split())[:200]
            print(printable(f"{path}: not among the claims: {what}"), file=sys.stderr)
    return results


def about(results):
    """The text above the table, lines of Markdown."""
    return ["The claims of the paper's experiments and Rigel's own, checked against results of `rigel_experiment`:", "",
            *(f"- `{name}`: {result.size}" for name, result in results.items()), "",
            "Errors are medians in degrees. Times are of the machine that ran the experiments. The paper's claims are",
            "checked on the raw motions of its own loop, where the most inliers win. A claim is confirmed if it holds in",
            "all cases, partly if in three of four, unless it says otherwise. Medians of few pairs scatter; with too few",
            "pairs there is no verdict."]


def markdown(judged, results):
    keys = ("of", "experiment", "claim", "verdict", "figures", "where_not")
    lines = [FIRST_LINE, "", "# Claims", "", *about(results), "", *TABLE_HEAD]
    for claim in judged:
        cells = [f"**{claim[key]}**" if key == "verdict" else claim[key] for key in keys]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def say(judged):
    """Verdicts to stdout, 100 columns. Raises OSError if it cannot be written."""
    if sys.stdout is None:
        raise OSError("closed")
    for claim in judged:
        print(textwrap.fill(f"{claim['experiment']}: {claim['claim']}", 100,
                            initial_indent=claim["verdict"].ljust(15), subsequent_indent=" " * 15,
                            break_long_words=False, break_on_hyphens=False))
    sys.stdout.flush()


def judge(claims, groups, units, results):
    """The claims of experiments that are among the results, as claims.json has them."""
    judged = []
    for entry in claims:
        name = entry["experiment"]
        if name not in results:
            continue
        verdict, figures, where_not = Claim(entry, groups, units[name], results[name]).judge()
        judged.append({"of": entry["of"], "experiment": name, "claim": entry["claim"],
                       "verdict": verdict, "figures": figures, "where_not": where_not})
    return judged


def run(directory):
    claims, groups, units = read_list(LIST)
    results = read_results(directory, units)
    if not results:
        raise Bad(f"{directory}: no results of rigel_experiment (NAME.json) in this directory")
    judged = judge(claims, groups, units, results)
    report = {"format": "rigel-claims 1", "rigel_version": VERSION, "claims": judged}
    for name, text in (("claims.md", markdown(judged, results)),
                       ("claims.json", json.dumps(report, indent=1, ensure_ascii=False) + "\n")):
        path = os.path.join(directory, name)
        try:
            write_whole(path, text.encode("utf-8", "backslashreplace"))
        except OSError as error:
            raise Bad(f"{path}: cannot be written: {error}") from error
    try:
        say(judged)
    except OSError as error:
        if sys.stdout is not None:  # or the interpreter tries again when it ends
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise Bad("stdout: cannot be written") from error


def main():
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory", metavar="DIR", help="directory of results, --output of rigel_experiment")
    try:
        run(parser.parse_args().directory)
    except Bad as error:
        print(printable(f"rigel_claims.py: {error}"), file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
