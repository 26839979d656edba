#!/usr/bin/env python3
"""Do parts of the same recorded frames agree as well as their covariances say? No truth is needed.

  test/recorded_pairs.py --matches=DIR[,DIR] [--calibration_sigma_deg=0.02] [--per_pair]

The matches of each pair are split into two parts in three ways:

  cameras  those of camera 0 with itself against those of camera 1 with itself
  halves   the left half of the image of the first view against the right half; rows that share a
           pixel or a landmark stay together
  kinds    intra-camera matches against matches between cameras. Rows of the two share pixels, so
           their errors are not quite independent

rigel_estimate runs on each part, with the error of the calibration stated. Printed are the medians
over the pairs of the NEES of the difference of the rotations, d' C^-1 d with d = log(Ra Rb'), over
that of chi2 with three degrees of freedom: 1 is right, 4 means sigmas two times too small. C is the
sum of the covariances of the noise and (Sa - Sb) E (Sa - Sb)', as the calibration is the same in
both parts (difference_covariance() in measure.py).

  pairs, left out  pairs, and those without a rotation or a valid covariance in one of the parts
  median, p90      of that ratio
  deg              RMS of the difference, degrees
  sd               RMS of its stated standard deviation, degrees
"""
import math
import os
import tempfile

import measure
import splits


def cameras(file):
    """Rows of camera 0 and of camera 1."""
    parts = [], []
    for row, match in zip(file.rows, file.matches()):
        if match[0] == match[3] and match[0] < 2:
            parts[match[0]].append(row)
    return parts


def halves(file):
    """Rows of the left and of the right half, by the groups of rows that belong together."""
    middle, matches, parts = [c.width / 2 for c in file.cameras()], file.matches(), ([], [])
    for group in splits.groups_of(file):
        i, u = matches[group[0]][:2]
        parts[u >= middle[i]].extend(file.rows[k] for k in group)
    return parts


def kinds(file):
    """Intra-camera rows and others."""
    parts = [], []
    for row, match in zip(file.rows, file.matches()):
        parts[match[0] != match[3]].append(row)
    return parts


WAYS = {"cameras": cameras, "halves": halves, "kinds": kinds}


def measure_way(programs, directory, way, flags, calibration):
    """The figures of a directory, split in one way."""
    files = [measure.MatchFile(path) for path in measure.match_files(directory)]
    with tempfile.TemporaryDirectory() as folder:
        for file in files:
            for name, rows in zip("ab", WAYS[way](file)):
                file.write(os.path.join(folder, name), rows)
        results = [programs.estimate(os.path.join(folder, name), flags)[0] for name in "ab"]
    ratios, squares, variances = {}, [], []
    for file in files:
        pair = [result.get(file.name, {}) for result in results]
        covariance = measure.difference_covariance(*pair, calibration)
        value = measure.difference_nees(*pair, calibration)
        if value is None:
            continue
        ratios[file.name] = value / measure.CHI2_MEDIAN[3]
        difference = measure.rotation_difference(*map(measure.refined_motion, pair))
        squares.append(measure.dot(difference, difference))
        variances.append(sum(covariance[k][k] for k in range(3)))

    def root_deg(values):
        average = measure.mean(values)
        return None if average is None else math.degrees(math.sqrt(average))
    ordered = sorted(ratios.values())
    return {"matches": os.path.basename(os.path.normpath(directory)), "way": way,
            "pairs": len(files), "left_out": len(files) - len(ratios),
            "median": measure.median(ordered),
            "p90": ordered[int(0.9 * len(ordered))] if ordered else None,
            "difference_deg": root_deg(squares), "sd_deg": root_deg(variances),
            "pair_ratios": ratios}


def main():
    parser = measure.make_parser(__doc__)
    parser.add_argument("--matches", required=True,
                        help="directories of match files, comma separated")
    parser.add_argument("--ways", default=",".join(WAYS), help="comma separated (all)")
    parser.add_argument("--calibration_sigma_deg", type=float, default=0.02,
                        help="error of the calibration, degrees (0.02)")
    parser.add_argument("--calibration_sigma_m", type=float, default=0.003,
                        help="error of the calibration, metres (0.003)")
    parser.add_argument("--per_pair", action="store_true", help="print each pair, too")
    arguments = parser.parse_args()
    ways = arguments.ways.split(",")
    if any(way not in WAYS for way in ways):
        parser.error("--ways: expected %s" % ", ".join(WAYS))
    programs = measure.Programs(arguments.bin, arguments.seed, arguments.threads)
    calibration = arguments.calibration_sigma_deg, arguments.calibration_sigma_m
    flags = programs.calibration_error("rigel_estimate", *calibration)
    results = [measure_way(programs, directory, way, flags, calibration)
               for directory in arguments.matches.split(",") for way in ways]
    members = ["matches", "way", "pairs", "left_out", "median", "p90", "difference_deg", "sd_deg"]
    measure.print_table(["rotation, NEES over that of chi2", "way", "pairs", "left out", "median",
                         "p90", "deg", "sd"], [[r[m] for m in members] for r in results])
    for result in results if arguments.per_pair else []:
        print()
        measure.print_table(["%s, %s" % (result["matches"], result["way"]), "ratio"],
                            list(result["pair_ratios"].items()))
    measure.finish(programs, arguments, results=results)


if __name__ == "__main__":
    measure.run_main(main)
