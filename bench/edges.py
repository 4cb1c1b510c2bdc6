#!/usr/bin/env python3
"""Anti-aliasing after the fact: smooth_edges by its reach, beside a simpler method (docs/understanding/shutter.md).

    bench/edges.py --json FILE [--program FILE] [--size WxH] [--scene NAME=FILE[@SECONDS]]...

The truth is the mean of 8 x 8 pictures of the same frame (supersample.n=8). The simpler method is written here after
Lottes, "FXAA" (2009): where the luminance of a pixel and its four neighbours differs, the edge is taken as horizontal
or vertical, its two ends are looked for along it by what the mean of both sides is there, and the pixel is read once
more, moved across the edge by where it lies between the ends; what stands alone is mixed with its 3 x 3 neighbours. It
sees the same luminance as smooth_edges and mixes linear radiance, as that does.

Errors: root mean square of pictures in sRGB after x / (1 + x), and relMSE of linear radiance. Costs: distinct texels
(of FXAA: filtered reads too) that a pixel reads, counted by doing so, on edges and elsewhere. Of smooth_edges a pixel
is on an edge where one runs along its left or upper side. By direction: the share that each method leaves of one
sample's squared error, over pixels at the truth's edges by the angle between the edge and the nearer axis.
"""
import argparse
import json
import math
import pathlib
import subprocess
import tempfile

from float_exr import read_exr

REACHES = (1, 2, 4, 8, 16, 32, 128)
THRESHOLD = 0.1  # of smooth_edges.threshold
EPSILON = 0.01   # of relMSE, as candela compare has it
ANGLES = (11.25, 22.5, 33.75, 45)


def luminance(r, g, b):
    y = max(0.2126 * r + 0.7152 * g + 0.0722 * b, 0)
    return y / (1 + y)


def display(x):
    x = max(x, 0) / (1 + max(x, 0))
    return 12.92 * x if x <= 0.0031308 else 1.055 * x ** (1 / 2.4) - 0.055


class Picture:
    def __init__(self, path=None, like=None):
        if path:
            planes, self.width, self.height = read_exr(path)
            self.colors = list(zip(planes["R"], planes["G"], planes["B"]))
        else:
            self.width, self.height, self.colors = like.width, like.height, list(like.colors)
        self.shown = [luminance(*c) for c in self.colors]

    def at(self, x, y):
        return min(max(y, 0), self.height - 1) * self.width + min(max(x, 0), self.width - 1)


def told(reads):
    """Of reads, and pixels, on edges and elsewhere."""
    rows = {name: round(total / max(pixels, 1), 2) for name, (pixels, total) in
            (("edge", reads[True]), ("elsewhere", reads[False]))}
    pixels, total = (reads[True][k] + reads[False][k] for k in (0, 1))
    return rows | {"edge_share": round(reads[True][0] / pixels, 4), "mean": round(total / pixels, 2)}


def simple(picture, steps, subpixel):
    """Lottes' method with up to `steps` reads each way; pictures, and reads a pixel on edges and elsewhere."""
    out = Picture(like=picture)
    reads = {True: [0, 0], False: [0, 0]}
    shown, at = picture.shown, picture.at

    def between(values, i, j, share):
        return values[i] * (1 - share) + values[j] * share

    for y in range(picture.height):
        for x in range(picture.width):
            i = at(x, y)
            m, n, s, w, e = (shown[at(x + dx, y + dy)] for dx, dy in ((0, 0), (0, -1), (0, 1), (-1, 0), (1, 0)))
            contrast = max(m, n, s, w, e) - min(m, n, s, w, e)
            if contrast < THRESHOLD:
                reads[False][0] += 1
                reads[False][1] += 5
                continue
            count = 9
            nw, ne, sw, se = (shown[at(x + dx, y + dy)] for dx, dy in ((-1, -1), (1, -1), (-1, 1), (1, 1)))
            alone = min(max(abs((n + s + w + e) / 4 - m) / contrast - 0.25, 0) / 0.75, 0.75) * subpixel
            vertical = abs(nw - 2 * n + ne) + 2 * abs(w - 2 * m + e) + abs(sw - 2 * s + se)
            horizontal = abs(nw - 2 * w + sw) + 2 * abs(n - 2 * m + s) + abs(ne - 2 * e + se)
            along, across = ((1, 0), (0, 1)) if horizontal >= vertical else ((0, 1), (1, 0))
            before, behind = (n, s) if horizontal >= vertical else (w, e)
            sign = -1 if abs(before - m) >= abs(behind - m) else 1
            other = before if sign < 0 else behind
            gradient, mean = abs(other - m) / 4, (m + other) / 2
            ends = []
            for way in (-1, 1):
                for k in range(1, steps + 1):  # one filtered read between both sides
                    count += 1
                    px, py = x + way * k * along[0], y + way * k * along[1]
                    value = (shown[at(px, py)] + shown[at(px + sign * across[0], py + sign * across[1])]) / 2 - mean
                    if abs(value) >= gradient:
                        break
                ends.append((k, value))
            (back, low), (front, high) = ends
            nearer = low if back < front else high
            # Beyond the nearer end the line lies on the other side: the pixel is not one that it covers.
            moved = 0.5 - min(back, front) / (back + front) if (m - mean < 0) != (nearer < 0) else 0
            j = at(x + sign * across[0], y + sign * across[1])
            count += 1
            color = [between([picture.colors[i][c], picture.colors[j][c]], 0, 1, moved) for c in range(3)]
            if alone > 0:
                box = [sum(picture.colors[at(x + dx, y + dy)][c] for dx in (-1, 0, 1) for dy in (-1, 0, 1)) / 9
                       for c in range(3)]
                color = [a + (b - a) * alone for a, b in zip(color, box)]
            out.colors[i] = tuple(color)
            reads[True][0] += 1
            reads[True][1] += count
    return out, told(reads)


def shape_reads(picture, reach):
    """Distinct texels that shaders/smooth_edges.comp reads, by its own rules."""
    width, height, shown, at = picture.width, picture.height, picture.shown, picture.at

    def contrast(a, b):
        return abs(shown[at(*a)] - shown[at(*b)])

    edges, first = {}, {}
    for y in range(height):
        for x in range(width):
            own = (contrast((x, y), (x - 1, y)), contrast((x, y), (x, y - 1)))
            first[x, y] = 3
            if max(own) < THRESHOLD:
                continue
            first[x, y] = 7
            most = max(*own, contrast((x, y), (x + 1, y)), contrast((x, y), (x, y + 1)),
                       contrast((x - 1, y), (x - 2, y)), contrast((x, y - 1), (x, y - 2)))
            edge = [x > 0 and own[0] >= THRESHOLD and 2 * own[0] >= most,
                    y > 0 and own[1] >= THRESHOLD and 2 * own[1] >= most]
            if any(edge):
                edges[x, y] = edge
    none = (False, False)
    reads = {True: [0, 0], False: [0, 0]}
    for y in range(height):
        for x in range(width):
            read = {(x, y)}

            def edge(px, py, c):
                read.add((px, py))
                return edges.get((px, py), none)[c]

            def walk(along, across, c, o):
                def crosses(px, py):
                    return edge(px, py, o) or edge(px + across[0], py + across[1], o)

                def place(k):
                    return x + k * along[0], y + k * along[1]

                back = front = 0
                while back < reach and not crosses(*place(-back)) and edge(*place(-back - 1), c):
                    back += 1
                while front < reach and not crosses(*place(front + 1)) and edge(*place(front + 1), c):
                    front += 1
                for k in (-back, front + 1):
                    edge(*place(k), o), edge(place(k)[0] + across[0], place(k)[1] + across[1], o)

            own = edges.get((x, y), none)
            if own[0]:
                walk((0, 1), (-1, 0), 0, 1)
            if own[1]:
                walk((1, 0), (0, -1), 1, 0)
            mixed = any(own) or edges.get((x + 1, y), none)[0] or edges.get((x, y + 1), none)[1]
            reads[any(own)][0] += 1
            reads[any(own)][1] += first[x, y] + len(read) + 3 + (5 if mixed else 1)
    return told(reads)


def direction(truth, x, y):
    """Of an edge through a pixel: the angle to the nearer axis in degrees; None where there is none."""
    def v(dx, dy):
        return truth.shown[truth.at(x + dx, y + dy)]
    gx = v(1, -1) + 2 * v(1, 0) + v(1, 1) - v(-1, -1) - 2 * v(-1, 0) - v(-1, 1)
    gy = v(-1, 1) + 2 * v(0, 1) + v(1, 1) - v(-1, -1) - 2 * v(0, -1) - v(1, -1)
    if math.hypot(gx, gy) < 4 * THRESHOLD:
        return None
    return math.degrees(math.atan2(min(abs(gx), abs(gy)), max(abs(gx), abs(gy))))


def squares(picture, truth):
    return [sum((display(a) - display(b)) ** 2 for a, b in zip(p, t)) / 3 for p, t in zip(picture.colors, truth.colors)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", required=True)
    parser.add_argument("--program", default="build/release/candela")
    parser.add_argument("--size", default="320x180")
    parser.add_argument("--scene", action="append", default=[], help="NAME=FILE[@SECONDS]")
    options = parser.parse_args()
    results = []
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for scene in options.scene:
            name, _, rest = scene.partition("=")
            file, _, moment = rest.partition("@")

            def rendered(*more):
                subprocess.run([options.program, "render", file, "-o", folder / "frame.exr", "--size", options.size,
                                "--time", moment or "0", "--exr-type", "float", "--exr-compression", "none", "--quiet",
                                *more], check=True)
                return Picture(folder / "frame.exr")

            truth = rendered("--set", "supersample.n=8")
            one = rendered("--samples", "1")
            angles = [direction(truth, x, y) for y in range(truth.height) for x in range(truth.width)]
            of_one = squares(one, truth)
            rows = []

            def add(way, picture, reads):
                off = squares(picture, truth)
                row = {"way": way, "rmse_shown": round(math.sqrt(sum(off) / len(off)), 5)}
                row["relmse"] = round(sum(sum((a - b) ** 2 / (b * b + EPSILON) for a, b in zip(p, t)) / 3 for p, t in
                                          zip(picture.colors, truth.colors)) / len(off), 6)
                row["reads"] = reads
                row["left_by_angle"] = []
                for low, high in zip((0,) + ANGLES, ANGLES):
                    these = [i for i, a in enumerate(angles) if a is not None and low <= a <= high]
                    was = sum(of_one[i] for i in these)
                    row["left_by_angle"].append({"to_deg": high, "pixels": len(these),
                                                 "left": round(sum(off[i] for i in these) / max(was, 1e-30), 3),
                                                 "of_all": round(sum(off[i] for i in these) / max(sum(off), 1e-30), 3)})
                rows.append(row)
                print(name, row, flush=True)

            add("one sample", one, {})
            for reach in REACHES:
                add(f"smooth_edges {reach}", rendered("--samples", "1", "--set", f"smooth_edges.reach_px={reach}"),
                    shape_reads(one, reach))
            for steps in (4, 8):
                add(f"smooth_edges contrast {steps}",
                    rendered("--samples", "1", "--set", f"smooth_edges.reach_px={steps}", "--set",
                             "smooth_edges.method=contrast"), simple(one, steps, 1)[1])
            for steps in (2, 4, 16, 64):
                for subpixel in (0, 1):
                    add(f"simple, {steps} steps" + (", lone pixels mixed" if subpixel else ""),
                        *simple(one, steps, subpixel))
            add("4 samples", rendered("--samples", "4"), {})
            results.append({"scene": name, "rows": rows})
    version = subprocess.run([options.program, "--version"], capture_output=True, text=True).stdout.strip()
    pathlib.Path(options.json).write_text(json.dumps(
        {"what": "anti-aliasing after the fact (bench/edges.py)", "version": version, "size": options.size,
         "scenes": results}, indent=1) + "\n")


if __name__ == "__main__":
    main()
