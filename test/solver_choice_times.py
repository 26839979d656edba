#!/usr/bin/env python3
"""The time of auto with --prior=body against 5pt+1, pair by pair: rows of docs/solver_choice.md.

    test/solver_choice_times.py BIN NAME=DIRECTORY ...

The least of REPEATS runs of each, which take turns, so that other work on the machine counts little.
"""
import json
import os
import subprocess
import sys
import tempfile

REPEATS = 9


def run(binary, directory, solver, report):
    subprocess.run([binary, '--matches=' + directory, '--solvers=' + solver, '--prior=body', '--shard=0/1',
                    '--json=' + report], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    with open(report, encoding='utf-8') as file:
        pairs = json.load(file)['pair_results']
    return {p['pair']: p['solvers'][solver] for p in pairs}


def quantile(values, share):
    values = sorted(values)
    return values[min(len(values) - 1, int(share * len(values)))]


def row(binary, name, directory, report):
    runs = {'auto': [], '5pt+1': []}
    for _ in range(REPEATS):
        for solver, results in runs.items():
            results.append(run(binary, directory, solver, report))
    least = {solver: {pair: min(r[pair]['time_ms']['ransac'] + r[pair]['time_ms']['refine'] for r in results)
                      for pair in results[0]}
             for solver, results in runs.items()}
    ratios = [least['auto'][pair] / least['5pt+1'][pair] for pair in least['auto']]
    errors = {solver: [p['refined']['rotation_deg'] for p in results[0].values() if 'refined' in p]
              for solver, results in runs.items()}
    cells = [name, str(len(ratios))]
    cells += ['%.2f / %.2f' % (quantile(ratios, 0.5), quantile(ratios, 0.9))]
    for solver in runs:
        cells.append('%.2f / %.2f' % (quantile(least[solver].values(), 0.5), quantile(least[solver].values(), 0.9)))
    for solver in runs:
        cells.append('%.4f / %.4f' % (quantile(errors[solver], 0.5), quantile(errors[solver], 0.9)))
    print('| ' + ' | '.join(cells) + ' |', flush=True)


def main():
    binary = os.path.join(sys.argv[1], 'rigel_compare')
    with tempfile.TemporaryDirectory() as work:
        for argument in sys.argv[2:]:
            name, directory = argument.split('=', 1)
            row(binary, name, directory, os.path.join(work, 'report.json'))


if __name__ == '__main__':
    main()
