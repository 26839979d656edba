#!/usr/bin/env python3
"""Do two halves of the same matches agree as well as their covariances say? No truth is needed.

  test/splits.py --bin=build/release/bin --matches=DIR[,DIR] [--halvings=5] [--seed=1]

The matches of each pair are split at random into two halves. Matches that share a pixel, directly
or through others, or that name the same landmark stay together, so the halves are independent.
rigel_estimate runs on both. The NEES of the rotations' difference is d' (C1 + C2)^-1 d with
d = log(R1 R2') and the stated covariances. Its median over all pairs and halvings is divided by
that of chi2 with three degrees of freedom, so that 1 is right; 4 means sigmas two times too small.
`low` and `high` are the least and the largest such median of one halving. Pairs without a rotation
or a valid covariance in one of the halves are counted in `left out`.

Without --matches, on files of rigel_simulate, where 1 is right.
"""
import os
import random
import tempfile

import measure


def groups_of(file):
    """Lists of the indices of matches that belong together, by their first index."""
    parent = list(range(len(file.rows)))

    def root(k):
        while parent[k] != k:
            parent[k] = parent[parent[k]]
            k = parent[k]
        return k

    owner = {}
    landmark = file.column("landmark")
    for k, (i, u, v, j, u2, v2) in enumerate(file.matches()):
        keys = [(1, i, u, v), (2, j, u2, v2)]
        if landmark is not None:
            keys.append(file.rows[k][landmark])
        for key in keys:
            a, b = root(k), root(owner.setdefault(key, k))
            parent[max(a, b)] = min(a, b)
    groups = {}
    for k in range(len(parent)):
        groups.setdefault(root(k), []).append(k)
    return list(groups.values())


def halves_of(file, generator):
    """The matches of two halves. Groups come in random order (without a generator in their own),
    each into the half that has fewer matches, so that the halves are alike in size."""
    groups = groups_of(file)
    if generator:
        generator.shuffle(groups)
    halves = [], []
    for group in groups:
        smaller = halves[0] if len(halves[0]) <= len(halves[1]) else halves[1]
        smaller.extend(group)
    return [[file.rows[k] for k in sorted(half)] for half in halves]


def measure_directory(programs, directory, arguments):
    """The figures of a directory."""
    files = [measure.MatchFile(path) for path in measure.match_files(directory)]
    all_values, medians, pairs, left_out = [], [], {}, 0
    for halving in range(1 if arguments.even_odd else arguments.halvings):
        generator = None if arguments.even_odd else random.Random(1000 * arguments.seed + halving)
        with tempfile.TemporaryDirectory() as folder:
            for file in files:
                for name, rows in zip("ab", halves_of(file, generator)):
                    file.write(os.path.join(folder, name), rows)
            results = [programs.estimate(os.path.join(folder, name), arguments.flags)[0]
                       for name in "ab"]
        values = []
        for file in files:
            value = None
            if all(file.name in result for result in results):
                value = measure.difference_nees(results[0][file.name], results[1][file.name])
            if value is None:
                left_out += 1
            else:
                value /= measure.CHI2_MEDIAN[3]
                values.append(value)
                pairs.setdefault(file.name, []).append(value)
        if values:
            medians.append(measure.median(values))
        all_values += values
    return {"matches": directory, "pairs": len(files), "left_out": left_out,
            "median": measure.median(all_values), "low": min(medians, default=None),
            "high": max(medians, default=None),
            "pair_medians": {name: measure.median(values) for name, values in pairs.items()}}


def main():
    parser = measure.make_parser(__doc__)
    parser.add_argument("--matches", help="directories of match files, comma separated")
    parser.add_argument("--halvings", type=int, default=5, help="random halvings of each pair (5)")
    parser.add_argument("--even_odd", action="store_true",
                        help="one halving instead, into even and odd matches")
    parser.add_argument("--per_pair", action="store_true",
                        help="print the median of each pair, too")
    parser.add_argument("flags", nargs="*", metavar="-- FLAG",
                        help="further flags of rigel_estimate, after --")
    arguments = parser.parse_args()
    programs = measure.Programs(arguments.bin, arguments.seed, arguments.threads)
    with tempfile.TemporaryDirectory() as folder:
        directories = (arguments.matches or folder).split(",")
        if not arguments.matches:
            programs.simulate(folder, "scene", 20, num_matches=400, outlier_share=0.2)
        results = [measure_directory(programs, directory, arguments) for directory in directories]
    measure.print_table(
        ("rotation, NEES over that of chi2", "pairs", "left out", "median", "low", "high"),
        [(os.path.basename(os.path.normpath(r["matches"])) if arguments.matches else "simulated",
          r["pairs"], r["left_out"], r["median"], r["low"], r["high"]) for r in results])
    if arguments.per_pair:
        for result in results:
            print()
            measure.print_table(("pair", "median"), list(result["pair_medians"].items()))
    measure.finish(programs, arguments, results=results)


if __name__ == "__main__":
    measure.run_main(main)
