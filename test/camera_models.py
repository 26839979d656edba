#!/usr/bin/env python3
"""Whether the camera models project as their sources say: a second implementation, and COLMAP.

    test/camera_models.py PROGRAM [--colmap]

PROGRAM is camera_points of the build. Each of its points is projected here by the formula of the model's source,
written down anew, and must have its pixel to 1e-6 pixels. The sources: OpenCV's calib3d for opencv, full_opencv and
opencv_fisheye; COLMAP's sensor/models for the other models of COLMAP; Mei and Rives 2007 (omni), Usenko, Demmel and
Cremers 2018 (double_sphere, fov beyond 90 degrees), Khomutenko, Garcia and Martinet 2016 (eucm).
With --colmap, COLMAP's models go through `colmap bundle_adjuster` with no iteration as well: the cost that it prints,
in pixels, must be below 1e-5. It has no rays beyond 90 degrees, so these are left out. So is fov with omega below 0.01:
there its distortion has the series of the inverse.
Exit code 0 if all agree, 1 if not, 77 with --colmap where there is no colmap.
"""

import math
import os
import re
import shutil
import subprocess
import sys
import tempfile

MOST_PX = 1e-6
MOST_COLMAP_PX = 1e-5
FEWEST_POINTS = 1000


def brown(x, y, k1, k2, p1, p2, k3=0.0, k4=0.0, k5=0.0, k6=0.0):
  r2 = x**2 + y**2
  radial = (1 + k1 * r2 + k2 * r2**2 + k3 * r2**3) / (1 + k4 * r2 + k5 * r2**2 + k6 * r2**3)
  return (x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x**2),
          y * radial + p1 * (r2 + 2 * y**2) + 2 * p2 * x * y)


def polar(X, Y, Z):
  """The angle to the axis and the direction about it."""
  return math.acos(Z / math.sqrt(X * X + Y * Y + Z * Z)) if Z < 0 else math.atan(math.hypot(X, Y) / Z), math.atan2(Y, X)


def on_circle(radius, direction):
  return radius * math.cos(direction), radius * math.sin(direction)


def scaled(x, y, fx, fy, cx, cy):
  return fx * x + cx, fy * y + cy


def pinhole(P, fx, fy, cx, cy):
  return scaled(P[0] / P[2], P[1] / P[2], fx, fy, cx, cy)


def radial(P, f, cx, cy, k1, k2=0.0):
  return scaled(*brown(P[0] / P[2], P[1] / P[2], k1, k2, 0.0, 0.0), f, f, cx, cy)


def opencv(P, fx, fy, cx, cy, *k):
  return scaled(*brown(P[0] / P[2], P[1] / P[2], *k), fx, fy, cx, cy)


def opencv_fisheye(P, fx, fy, cx, cy, k1, k2=0.0, k3=0.0, k4=0.0):
  t, direction = polar(*P)
  return scaled(*on_circle(t + k1 * t**3 + k2 * t**5 + k3 * t**7 + k4 * t**9, direction), fx, fy, cx, cy)


def radial_fisheye(P, f, cx, cy, k1, k2=0.0):
  return opencv_fisheye(P, f, f, cx, cy, k1, k2)


def thin_prism_fisheye(P, fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, sx1, sy1):
  t, direction = polar(*P)
  x, y = on_circle(t, direction)
  radial_part = k1 * t**2 + k2 * t**4 + k3 * t**6 + k4 * t**8
  dx = x * radial_part + 2 * p1 * x * y + p2 * (t**2 + 2 * x**2) + sx1 * t**2
  dy = y * radial_part + 2 * p2 * x * y + p1 * (t**2 + 2 * y**2) + sy1 * t**2
  return scaled(x + dx, y + dy, fx, fy, cx, cy)


def fov(P, fx, fy, cx, cy, omega):
  X, Y, Z = P
  angle = math.atan2(2 * math.hypot(X, Y) * math.tan(omega / 2), Z)
  return scaled(*on_circle(angle / omega, math.atan2(Y, X)), fx, fy, cx, cy)


def omni(P, xi, fx, fy, cx, cy, *k):
  """On the unit sphere, from a centre that is xi behind that of the sphere."""
  X, Y, Z = (c / math.sqrt(sum(c * c for c in P)) for c in P)
  return scaled(*brown(X / (Z + xi), Y / (Z + xi), *k), fx, fy, cx, cy)


def double_sphere(P, xi, alpha, fx, fy, cx, cy):
  X, Y, Z = P
  d1 = math.sqrt(X * X + Y * Y + Z * Z)
  d2 = math.sqrt(X * X + Y * Y + (xi * d1 + Z)**2)
  below = alpha * d2 + (1 - alpha) * (xi * d1 + Z)
  return scaled(X / below, Y / below, fx, fy, cx, cy)


def eucm(P, alpha, beta, fx, fy, cx, cy):
  X, Y, Z = P
  below = alpha * math.sqrt(beta * (X * X + Y * Y) + Z * Z) + (1 - alpha) * Z
  return scaled(X / below, Y / below, fx, fy, cx, cy)


PROJECT = {
    "pinhole": pinhole, "simple_pinhole": lambda P, f, cx, cy: pinhole(P, f, f, cx, cy), "simple_radial": radial,
    "radial": radial, "opencv": opencv, "full_opencv": opencv, "opencv_fisheye": opencv_fisheye,
    "simple_radial_fisheye": radial_fisheye, "radial_fisheye": radial_fisheye,
    "thin_prism_fisheye": thin_prism_fisheye, "fov": fov, "omni": omni, "double_sphere": double_sphere, "eucm": eucm}


def in_colmap(model, parameters):
  return model not in ("omni", "double_sphere", "eucm") and (model != "fov" or parameters[4] >= 0.01)


def read(program):
  """(name, model, (width, height), parameters, [(X, Y, Z, u, v)]) for each camera."""
  cameras = []
  for line in subprocess.run([program], check=True, capture_output=True, text=True).stdout.splitlines():
    words = line.split()
    if words[0] == "camera":
      cameras.append((words[1], words[2], (int(words[3]), int(words[4])), [float(w) for w in words[5:]], []))
    else:
      cameras[-1][4].append(tuple(float(w) for w in words))
  return cameras


def worst_difference(model, parameters, points):
  worst = 0.0
  for X, Y, Z, u, v in points:
    pixel = PROJECT[model]((X, Y, Z), *parameters)
    worst = max(worst, math.hypot(pixel[0] - u, pixel[1] - v))
  return worst


def colmap_cost(model, size, parameters, points):
  """What bundle_adjuster prints, in pixels, for two images that see all points from the origin."""
  # In COLMAP the centre of the top left pixel is (0.5, 0.5).
  first_centre = PROJECT[model].__code__.co_varnames.index("cx") - 1
  parameters = list(parameters)
  for k in (first_centre, first_centre + 1):
    parameters[k] += 0.5
  points = [point for point in points if point[2] > 0]
  with tempfile.TemporaryDirectory() as folder:
    for name in ("cameras", "images", "points3D"):
      with open(os.path.join(folder, name + ".txt"), "w", encoding="utf-8") as file:
        if name == "cameras":
          print(1, model.upper(), *size, *map(repr, parameters), file=file)
        elif name == "images":
          for image in (1, 2):
            print(image, 1, 0, 0, 0, 0, 0, 0, 1, f"{image}.png", file=file)
            print(*(f"{u + 0.5!r} {v + 0.5!r} {k + 1}" for k, (_, _, _, u, v) in enumerate(points)), file=file)
        else:
          for k, point in enumerate(points):
            print(k + 1, *map(repr, point[:3]), 0, 0, 0, 0, 1, k, 2, k, file=file)
    said = subprocess.run(
        ["colmap", "bundle_adjuster", "--input_path", folder, "--output_path", folder,
         "--BundleAdjustment.max_num_iterations", "0"], capture_output=True, text=True)
  cost = re.search(r"Initial cost : (\S+)", said.stdout + said.stderr)
  return float(cost[1]) if cost else math.inf


def main():
  if sys.argv[1:] in (["-h"], ["--help"]):
    print(__doc__)
    sys.exit(0)
  with_colmap = "--colmap" in sys.argv[2:]
  if with_colmap and not shutil.which("colmap"):
    print("no colmap")
    sys.exit(77)
  cameras = read(sys.argv[1])
  failed = {camera[1] for camera in cameras} != set(PROJECT)
  for name, model, size, parameters, points in cameras:
    worst = worst_difference(model, parameters, points)
    failed |= not worst <= MOST_PX or len(points) < FEWEST_POINTS
    line = f"{name:16} {model:22} {len(points)} points, largest difference {worst:.1e} px"
    if with_colmap and in_colmap(model, parameters):
      cost = colmap_cost(model, size, parameters, points)
      failed |= not cost <= MOST_COLMAP_PX
      line += f"; COLMAP's cost {cost:g} px"
    print(line)
  print("failed" if failed else "all agree")
  sys.exit(1 if failed else 0)


if __name__ == "__main__":
  main()
