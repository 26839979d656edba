"""A camera rig from above and from the side: rig files, as rigel_rig writes them."""
import math

from rigel_files import Bad
from rigel_plot_style import (BLACK, BLUE, GREEN, GREY, INDIGO, OLIVE, ORANGE, PINK, RED, SKY, WINE,
                              faded, new_figure)
from rigel_plot_trajectory import cross, direction_text, dot

COLORS = [BLUE, RED, GREEN, ORANGE, PINK, INDIGO, OLIVE, SKY, WINE, GREY]
# As in problems/rigs/rig_check.cc.
UPRIGHT, MORE_UPRIGHT = 0.75, 0.2
# A body whose origin is farther from the cameras than this, times the size of the rig, is left out
# of the picture.
FAR_ORIGIN = 3.0


class Camera:
    """Name, Q and s (body_from_camera) and half fields of view (left, right, up, down), radians."""

    def __init__(self, name, Q, s, views):
        self.name, self.Q, self.s, self.views = name, Q, s, views

    def ray(self, x, y, z):
        """A direction of the camera in the body frame."""
        return tuple(dot(row, (x, y, z)) for row in self.Q)


def rotation(q):
    """Rows of the rotation of a quaternion w x y z."""
    size = math.hypot(*q)
    w, x, y, z = (c / size for c in q)
    return [(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y))]


def image_radius(model, p, angle):
    """Distance from the centre of an image of focal length 1 (core/camera.h), without what is not
    radial. None beyond the lens's domain."""
    s, c = math.sin(angle), math.cos(angle)
    if model in ("omni", "double_sphere", "eucm"):
        if model == "omni":
            below = c + p[0]
        elif model == "double_sphere":
            z = p[0] + c
            below = p[1] * math.hypot(s, z) + (1 - p[1]) * z
        else:
            below = p[0] * math.sqrt(p[1] * s * s + c * c) + (1 - p[0]) * c
        r = s / below if below > 0 else None
    elif "fisheye" in model:
        r = angle
    elif model == "fov":
        r = math.atan2(2 * math.tan(p[4] / 2) * s, c) / p[4]
    else:
        r = s / c if c > 0 else None
    if r is None:
        return None
    # k1, k2, ..; and of full_opencv k4, k5, k6 below the line.
    places = {"simple_radial": [3], "radial": [3, 4], "opencv": [4, 5], "full_opencv": [4, 5, 8],
              "opencv_fisheye": [4, 5, 6, 7], "simple_radial_fisheye": [3],
              "radial_fisheye": [3, 4], "thin_prism_fisheye": [4, 5, 8, 9], "omni": [5, 6]}
    factor = 1 + sum(p[place] * r ** (2 * n + 2) for n, place in enumerate(places.get(model, [])))
    if model == "full_opencv":
        factor /= 1 + sum(p[9 + n] * r ** (2 * n + 2) for n in range(3))
    return r * factor


def half_view(model, p, focal, pixels):
    """The angle at which the image is `pixels` from its centre, or where it ends before."""
    step = math.radians(0.25)
    last = 0.0
    for n in range(1, int(math.pi / step)):
        r = image_radius(model, p, n * step)
        if r is None or r <= last:
            return (n - 1) * step
        if focal * r >= pixels:
            return (n - (focal * r - pixels) / (focal * (r - last))) * step
        last = r
    return math.pi


def lens_of(camera):
    """Model and parameters, also from the older keys."""
    if "parameters" in camera:
        return camera["model"], camera["parameters"]
    p = [camera[k] for k in ("fx", "fy", "cx", "cy")]
    d = camera.get("distortion", [])
    if camera["model"].startswith("equidistant"):
        return "opencv_fisheye", p + d
    if not any(d):
        return "pinhole", p
    if camera["model"].startswith("radial"):
        d = [d[0], d[1], 0, 0, d[2]]
    return "full_opencv", p + d + [0, 0, 0]


def camera_of(camera, name):
    model, p = lens_of(camera)
    one_focal = model in ("simple_pinhole", "simple_radial", "radial", "simple_radial_fisheye",
                          "radial_fisheye")
    at = {"omni": 1, "double_sphere": 2, "eucm": 2}.get(model, 0)
    fx, fy, cx, cy = [p[0]] * 2 + p[1:3] if one_focal else p[at:at + 4]
    views = [half_view(model, p, f, pixels) for f, pixels in (
        (fx, cx + 0.5), (fx, camera["width"] - 0.5 - cx),
        (fy, cy + 0.5), (fy, camera["height"] - 0.5 - cy))]
    return Camera(camera.get("name", name), rotation(camera["q"]), tuple(camera["s"]), views)


def mean(vectors):
    return tuple(sum(v[k] for v in vectors) / len(vectors) for k in range(3))


def column(Q, k):
    return tuple(row[k] for row in Q)


def nearest_axis(v, without=()):
    k = max((k for k in range(3) if k not in without), key=lambda k: abs(v[k]))
    return tuple(math.copysign(1.0, v[k]) if n == k else 0.0 for n in range(3))


def axes_of(rig, cameras):
    """Down and forward in the body frame, as core/body_axes.h takes them."""
    down = rig.get("down") or nearest_axis(mean([column(c.Q, 1) for c in cameras]))
    ahead = rig.get("forward") or mean([column(c.Q, 2) for c in cameras])
    across = tuple(a - dot(ahead, down) * d for a, d in zip(ahead, down))
    if "forward" not in rig:
        if math.hypot(*across) < 0.5:  # they look all around
            axis = nearest_axis(down)
            across = {(0, 0, -1): (1, 0, 0), (0, 1, 0): (0, 0, 1)}.get(
                axis, column(cameras[0].Q, 2))
        along = max(range(3), key=lambda k: abs(down[k]))
        across = nearest_axis(across, (along,))
        across = tuple(a - dot(across, down) * d for a, d in zip(across, down))
    size = math.hypot(*across)
    return tuple(down), tuple(a / size for a in across)


def look(poses):
    """How far cameras agree on down and look away from their middle."""
    middle = mean([s for _, s in poses])
    away = [tuple(a - b for a, b in zip(s, middle)) for _, s in poses]
    size = sum(math.hypot(*v) for v in away)
    outward = sum(dot(column(Q, 2), v) for (Q, _), v in zip(poses, away)) / size if size else 0.0
    return math.hypot(*mean([column(Q, 1) for Q, _ in poses])), outward


def inverse(Q, s):
    T = [column(Q, k) for k in range(3)]
    return T, tuple(-dot(row, s) for row in T)


def warning(rig, cameras):
    """What rigel_rig says of poses that are inverted or x y z w; empty if neither seems so."""
    poses = [(c.Q, c.s) for c in cameras]
    others = {"poses look inverted": [inverse(*p) for p in poses]}
    quaternions = [c["q"] for c in rig["cameras"]]
    others["quaternions look like x y z w"] = [
        (rotation([q[3]] + list(q[:3])), s) for q, (_, s) in zip(quaternions, poses)]
    upright, _ = look(poses)
    good = [(sum(look(p)), what) for what, p in others.items()
            if look(p)[0] >= max(UPRIGHT, upright + MORE_UPRIGHT) and look(p)[1] > 0]
    return max(good)[1] if good else ""


def fan(camera, length, vertical):
    """The outline of what the camera sees in the plane of its axis, a sector of a circle."""
    first, last = camera.views[2:] if vertical else camera.views[:2]
    points = [camera.s]
    steps = max(2, int(math.degrees(first + last) / 3))
    for n in range(steps + 1):
        a = -first + (first + last) * n / steps
        ray = camera.ray(0, math.sin(a), math.cos(a)) if vertical else \
            camera.ray(math.sin(a), 0, math.cos(a))
        points.append(tuple(s + length * r for s, r in zip(camera.s, ray)))
    return points


def spread(boxes, anchors, limits):
    """Moves boxes (x, y, half width, half height; pixels) apart and into the limits; `anchors` hold
    the points that they belong to, and they come to lie beside these."""
    gap = 2.0
    for _ in range(400):
        moved = False
        for i, a in enumerate(boxes):
            for b in boxes[:i]:
                dx, dy = a[0] - b[0], a[1] - b[1]
                over_x = a[2] + b[2] + gap - abs(dx)
                over_y = a[3] + b[3] + gap - abs(dy)
                if over_x <= 0 or over_y <= 0:
                    continue
                moved = True
                # Names are wide: they go apart up and down unless little is missing sideways.
                k, over, d = (0, over_x, dx) if 3 * over_x < over_y else (1, over_y, dy)
                step = math.copysign(over / 2 + 0.1, d if d else 1.0)
                a[k] += step
                b[k] -= step
            for x, y in anchors:
                over_x = a[2] + 5 - abs(a[0] - x)
                over_y = a[3] + 5 - abs(a[1] - y)
                if over_x > 0 and over_y > 0:
                    a[1] += math.copysign(over_y, a[1] - y if a[1] != y else 1.0)
                    moved = True
            for k in range(2):
                low, high = limits[k]
                a[k] = min(max(a[k], low + a[2 + k]), high - a[2 + k])
        if not moved:
            break


def add_names(axis, cameras, points):
    """The cameras' names beside the ends of their axes, without overlaps."""
    figure = axis.figure
    figure.canvas.draw()
    renderer = figure.canvas.get_renderer()
    to_pixels, to_data = axis.transData.transform, axis.transData.inverted().transform
    texts, boxes, ends, starts = [], [], [], []
    for k, (camera, (start, end)) in enumerate(zip(cameras, points)):
        text = axis.text(0, 0, camera.name, color=COLORS[k % len(COLORS)], fontsize=8,
                         ha="center", va="center", zorder=6,
                         bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75,
                               "pad": 0.6})
        extent = text.get_window_extent(renderer)
        half = extent.width / 2, extent.height / 2
        start, end = to_pixels(start), to_pixels(end)
        way = end[0] - start[0], end[1] - start[1]
        size = math.hypot(*way)
        way = (way[0] / size, way[1] / size) if size > 1 else (0.0, 1.0)
        # Beside the end, with a corner there if the way to it is oblique.
        beside = [5 * w + h * max(-1.0, min(1.0, 1.7 * w)) for w, h in zip(way, half)]
        boxes.append([end[0] + beside[0], end[1] + beside[1], *half])
        texts.append(text)
        ends.append(end)
        starts.append(start)
    window = axis.get_window_extent()
    spread(boxes, starts, ((window.x0 + 3, window.x1 - 3), (window.y0 + 3, window.y1 - 3)))
    for k, (text, box, end) in enumerate(zip(texts, boxes, ends)):
        text.set_position(to_data(box[:2]))
        near = (min(max(end[0], box[0] - box[2]), box[0] + box[2]),
                min(max(end[1], box[1] - box[3]), box[1] + box[3]))
        if math.hypot(near[0] - end[0], near[1] - end[1]) > 10:
            ends_of_line = to_data([near, end])
            axis.plot(ends_of_line[:, 0], ends_of_line[:, 1], color=COLORS[k % len(COLORS)],
                      lw=0.6, alpha=0.7, zorder=5)


def add_body(axis, project, towards_viewer, length):
    """The axes of the body at its origin; a dot or a cross where one points at or away from us."""
    start = project((0.0, 0.0, 0.0))
    axis.plot(*start, marker="+", color=BLACK, markersize=9, zorder=4)
    for k, name in enumerate("xyz"):
        unit = tuple(float(k == n) for n in range(3))
        end = project(tuple(length * u for u in unit))
        if math.dist(start, end) > 0.3 * length:
            axis.annotate("", xy=end, xytext=start, zorder=4, arrowprops={
                "arrowstyle": "-|>", "color": BLACK, "lw": 1.1, "shrinkA": 0, "shrinkB": 0})
            tip = [s + 1.22 * (e - s) for s, e in zip(start, end)]
            axis.text(*tip, name, ha="center", va="center", fontsize=8.5, zorder=4,
                      bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.7, "pad": 0.3})
        else:
            out = dot(unit, towards_viewer) > 0
            axis.plot(*start, marker="o", mfc="white", mec=BLACK, markersize=9, zorder=4)
            axis.plot(*start, marker="." if out else "x", color=BLACK, markersize=4, zorder=4)
            axis.annotate(name, start, xytext=(-9, -9), textcoords="offset points", fontsize=8.5,
                          ha="center", va="center", zorder=4)


def draw(axis, cameras, right, up, sizes, vertical, has_origin):
    """One view: `right` and `up` of the page in the body frame."""
    length, body_length = sizes

    def project(point):
        return dot(point, right), dot(point, up)

    points = []
    for k, camera in enumerate(cameras):
        color = COLORS[k % len(COLORS)]
        outline = [project(p) for p in fan(camera, length, vertical)]
        axis.fill(*zip(*outline), facecolor=faded(color, 0.6), edgecolor=color, lw=0.8, alpha=0.28,
                  zorder=1)
        axis.plot(*zip(*(outline + outline[:1])), color=color, lw=0.8, zorder=2)
        end = project(tuple(s + length * a for s, a in zip(camera.s, column(camera.Q, 2))))
        start = project(camera.s)
        axis.plot(*zip(start, end), color=color, lw=1.2, ls=(0, (5, 2)), zorder=3)
        axis.plot(*start, marker="o", color=color, markersize=5, mec="white", mew=0.6, zorder=5)
        points.append((start, end))
    if has_origin:
        add_body(axis, project, cross(right, up), body_length)
    axis.set_aspect("equal", adjustable="datalim")
    axis.margins(0.24, 0.19)
    axis.grid(True, color="#e4e4e4", lw=0.6)
    axis.set_axisbelow(True)
    axis.tick_params(labelsize=8)
    return points


def plot_rig(rig, stem, path):
    """(name, figure) of a rig file."""
    if not rig["cameras"]:
        raise Bad(f"{path}: there is no camera in it")
    cameras = [camera_of(c, str(k)) for k, c in enumerate(rig["cameras"])]
    down, forward = axes_of(rig, cameras)
    right, up = cross(down, forward), tuple(-d for d in down)
    size = max(math.dist(a.s, b.s) for a in cameras for b in cameras) or 1.0
    middle = mean([c.s for c in cameras])
    has_origin = math.hypot(*middle) < FAR_ORIGIN * size + 0.5
    sizes = 0.75 * size, 0.3 * size

    figure, axes = new_figure(1, 2, 12.5, 6.6)
    above, side = axes[0]
    above_points = draw(above, cameras, right, forward, sizes, False, has_origin)
    side_points = draw(side, cameras, forward, up, sizes, True, has_origin)
    if "ground_m" in rig:
        side.axhline(-rig["ground_m"], color=GREY, lw=1.2, zorder=0)
        side.annotate("ground", (0.995, -rig["ground_m"]), xycoords=("axes fraction", "data"),
                      xytext=(0, 3), textcoords="offset points", fontsize=8, color=GREY, ha="right")
    above.set_xlabel(f"right, {direction_text(right)} [m]", fontsize=9)
    above.set_ylabel(f"forward, {direction_text(forward)} [m]  \u2192", fontsize=9)
    side.set_xlabel(f"forward, {direction_text(forward)} [m]  \u2192", fontsize=9)
    side.set_ylabel(f"\u2190  down, {direction_text(down)}          up, {direction_text(up)} [m]  "
                    "\u2192", fontsize=9)
    above.set_title("from above, horizontal fields of view", fontsize=9.5)
    side.set_title("from the right, vertical fields of view", fontsize=9.5)
    count = "1 camera" if len(cameras) == 1 else f"{len(cameras)} cameras"
    figure.suptitle(f"{rig.get('name') or stem}: {count}", fontsize=11.5)
    said = warning(rig, cameras)
    notes = [f"warning: {said}"] if said else []
    if not has_origin:
        notes.append(f"the body's origin is {math.hypot(*middle):.3g} m away")
    figure.tight_layout(rect=(0, 0, 1, 0.965 if notes else 0.99))
    if notes:
        figure.text(0.5, 0.935, "; ".join(notes), ha="center", va="top", fontsize=9.5,
                    color=RED if said else BLACK)
    add_names(above, cameras, above_points)
    add_names(side, cameras, side_points)
    return [(stem, figure)]
