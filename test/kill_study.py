#!/usr/bin/env python3
"""Kills programs at random moments and looks at what the next run makes of it.

  test/kill_study.py [--kills=30] [--seed=1] [TOOL ...]

Each of rigel_experiment, rigel_match, rigel_calibrate_prior --in_place and rigel_compare is killed
(SIGKILL) at that many moments, drawn uniformly from the time that it takes, and at as many within
3 ms after its first temporary file is seen. The next run must end with code 0, leave no file that
an undisturbed run does not leave, and each file the same to the last byte. Only kills that found
the program at work count.

The build is $RIGEL_BUILD_DIR, by default build/release.

Exit code: 0 all as it should be, 1 not, 77 there are no programs.
"""
import argparse
import os
import random
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import zlib

BUILD = os.environ.get("RIGEL_BUILD_DIR") or os.path.join(
    os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "build", "release")


def program(name):
    return os.path.join(BUILD, "bin", "rigel_" + name)


def files_of(directory):
    found = {}
    for folder, _, names in os.walk(directory):
        for name in names:
            path = os.path.join(folder, name)
            with open(path, "rb") as file:
                found[os.path.relpath(path, directory)] = file.read()
    return found


def write_png(path, rows):
    """A grey image; `rows` are bytes."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + \
            struct.pack(">I", zlib.crc32(kind + data))
    head = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 0, 0, 0, 0)
    data = zlib.compress(b"".join(b"\0" + row for row in rows))
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", data) +
                   chunk(b"IEND", b""))


def make_images(root, frames):
    """A stereo sequence in KITTI's form before a far wall of random squares."""
    width, height, square = 320, 240, 6
    generator = random.Random(1)
    across = (width + 8 * frames) // square + 2
    wall = [bytes(value for _ in range(across) for value in [generator.randrange(256)] * square)
            for _ in range(height // square)]
    sequence = os.path.join(root, "sequences", "00")
    projection = "300 0 160 {} 0 300 120 0 0 0 1 0"
    for camera, shift in ((0, 0), (1, 3)):
        folder = os.path.join(sequence, f"image_{camera}")
        os.makedirs(folder)
        for frame in range(frames):
            begin = 4 * frame + shift
            rows = [wall[y // square][begin:begin + width] for y in range(height)]
            write_png(os.path.join(folder, f"{frame:06d}.png"), rows)
    with open(os.path.join(sequence, "calib.txt"), "w", encoding="ascii") as file:
        file.write("P0: " + projection.format(0) + "\nP1: " + projection.format(-150) + "\n")


class Case:
    """`command` works in `out`, which begins as a copy of `start` if there is one; `again` are the
    flags of the next run."""

    def __init__(self, name, command, out, start=None, again=()):
        self.name, self.command, self.out, self.start = name, command, out, start
        self.again = list(again)

    def prepare(self):
        shutil.rmtree(self.out, ignore_errors=True)
        if self.start:
            shutil.copytree(self.start, self.out)
        else:
            os.makedirs(self.out)

    def run(self, more=()):
        return subprocess.run(self.command + list(more), stdout=subprocess.DEVNULL,
                              stderr=subprocess.PIPE, text=True, check=False)


def cases(work):
    matches = os.path.join(work, "matches")
    subprocess.run([program("simulate"), "--output=" + matches, "--pairs=40", "--num_matches=100",
                    "--inter_share=0.5", "--motion=planar", "--rotation_deg=3"],
                   check=True, stderr=subprocess.DEVNULL)
    out = os.path.join(work, "out")
    result = [
        Case("compare", [program("compare"), "--matches=" + matches, "--solvers=4pt-axis,3pt",
                         "--no_times", "--per_pair", f"--json={out}/x.json", f"--csv={out}/x.csv"],
             out),
        Case("calibrate_prior", [program("calibrate_prior"), "--matches=" + out, "--in_place",
                                 "--lines=normal,axis,gravity", "--refine=full"],
             out, start=matches),
        Case("experiment", [program("experiment"), "--name=outliers", "--quick", "--pairs=2",
                            "--no_times", "--output=" + out, f"--html={out}/page.html"],
             out, again=["--resume"]),
    ]
    if os.path.exists(program("match")):
        images = os.path.join(work, "images")
        make_images(images, 30)
        result.append(Case("match", [program("match"), "--kitti_root=" + images, "--sequence=00",
                                     "--output=" + out, "--max_features=300"],
                           out, again=["--resume"]))
    return result


def is_writing(directory):
    with os.scandir(directory) as entries:
        return any(".rigel-tmp" in entry.name for entry in entries)


def kill(case, moment, writing):
    """Kills the program that many seconds after it began, or began to write. Whether it was still
    at work then."""
    with subprocess.Popen(case.command, stdout=subprocess.DEVNULL,
                          stderr=subprocess.DEVNULL) as process:
        while writing and process.poll() is None and not is_writing(case.out):
            pass
        try:
            process.wait(moment)
            return False
        except subprocess.TimeoutExpired:
            process.kill()
            return True


def study(case, kills, generator):
    case.prepare()
    begin = time.monotonic()
    undisturbed = case.run()
    length = time.monotonic() - begin
    if undisturbed.returncode != 0:
        print(f"{case.name}: the undisturbed run fails: {undisturbed.stderr}")
        return False
    expected = files_of(case.out)
    runs = killed = partial = left_over = wrong = 0
    while killed < 2 * kills and runs < 20 * kills:
        writing = killed >= kills
        moment = generator.uniform(0, 0.003 if writing else length)
        case.prepare()
        before = files_of(case.out)
        killed += kill(case, moment, writing)
        runs += 1
        after = files_of(case.out)
        left_over += bool(set(after) - set(expected))
        partial += after not in (before, expected)
        run = case.run(case.again)
        now = files_of(case.out)
        if run.returncode == 0 and now == expected:
            continue
        wrong += 1
        print(f"{case.name}, killed {moment:.4f} s after it began{' to write' if writing else ''}: exit code {run.returncode}\n{run.stderr}"
              f"  too many: {sorted(set(now) - set(expected))}\n"
              f"  missing: {sorted(set(expected) - set(now))}\n"
              f"  differ: {sorted(k for k in expected if k in now and now[k] != expected[k])}")
    print(f"{case.name:16} {length:6.2f} s {runs:5} runs {killed:4} killed at work, "
          f"{partial:3} with a part done, {left_over:3} with left-overs; wrong afterwards: {wrong}",
          flush=True)
    return wrong == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tools", nargs="*", metavar="TOOL", help="as compare; all by default")
    parser.add_argument("--kills", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    if not os.path.exists(program("compare")):
        print(f"no programs in {BUILD}/bin")
        return 77
    with tempfile.TemporaryDirectory(prefix="rigel_kill_") as work:
        chosen = [case for case in cases(work)
                  if not arguments.tools or case.name in arguments.tools]
        results = [study(case, arguments.kills, random.Random(arguments.seed)) for case in chosen]
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main())
