#!/usr/bin/env python3
"""How far `relief.steps` and `relief.refinements` are from the surface (docs/relief.md).

    bench/relief.py --json FILE [--program FILE] [--size WxH]

The scene of `make-scene relief`, and its wall alone at a grazing angle, as the layer `depth` has them at the pixels'
centres. The truth is `candela reference`. Of the pixels that show the wall in it, by the depth in the layer of what both
show: the share that is off by more than a thirty-second of the layer (missed), and the root mean square of what the
others are off by, in the layer's depth. From near no pixel is as large as a texel; from farther off steps read mip levels. Beside it the share of pixels that only one of them
covers, and the time of the frame on the device (median of three runs).
"""
import argparse
import array
import json
import math
import pathlib
import statistics
import struct
import subprocess
import tempfile

DEPTH_M = 0.08
YFOV_DEG = 43
VIEWS = {"near": ((0.35, 1.45, 0.45), (0.0, 1.25, 0.0)), "oblique": ((1.5, 1.25, 1.9), (-0.1, 0.95, 0.1)),
         "grazing": ((1.1, 1.2, 0.25), (-0.6, 0.9, 0.0))}
STEPS, REFINEMENTS = (8, 32, 128, 0), (2, 4, 8)


def unit(v):
    length = math.sqrt(sum(c * c for c in v))
    return [c / length for c in v]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


class Camera:
    def __init__(self, eye, target, width, height):
        self.eye, self.width, self.height = eye, width, height
        self.forward = unit([t - e for e, t in zip(eye, target)])
        self.right = unit(cross(self.forward, (0, 1, 0)))
        self.up = cross(self.right, self.forward)
        self.tan_y = math.tan(math.radians(YFOV_DEG) / 2)

    def place(self, pixel, depth):
        """In the world, of a pixel's centre at a depth along the view axis."""
        x = (2 * (pixel % self.width + 0.5) / self.width - 1) * self.tan_y * self.width / self.height
        y = (1 - 2 * (pixel // self.width + 0.5) / self.height) * self.tan_y
        return [e + depth * (f + x * r + y * u)
                for e, f, r, u in zip(self.eye, self.forward, self.right, self.up)]


def read_depth(path):
    """The channel depth.Z of an EXR of floats without compression."""
    data = pathlib.Path(path).read_bytes()
    at, channels = 8, []
    while data[at]:
        name_end = data.index(0, at)
        kind_end = data.index(0, name_end + 1)
        size = struct.unpack_from("<i", data, kind_end + 1)[0]
        name, value = data[at:name_end].decode(), data[kind_end + 5:kind_end + 5 + size]
        at = kind_end + 5 + size
        if name == "channels":
            k = 0
            while value[k]:
                end = value.index(0, k)
                channels.append((value[k:end].decode(), struct.unpack_from("<i", value, end + 1)[0]))
                k = end + 17
        if name == "dataWindow":
            x0, y0, x1, y1 = struct.unpack("<4i", value)
    width, height = x1 - x0 + 1, y1 - y0 + 1
    offsets = struct.unpack_from(f"<{height}Q", data, at + 1)
    rows, device = [], None
    for offset in offsets:
        here = offset + 8
        for name, kind in channels:
            bytes_each = 2 if kind == 1 else 4
            if name in ("Z", "depth.Z", "depth.V"):
                rows.append(array.array("f", data[here:here + 4 * width]))
            here += bytes_each * width
    return [z for row in rows for z in row]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", required=True)
    parser.add_argument("--program", default="build/release/candela")
    parser.add_argument("--size", default="320x240")
    options = parser.parse_args()
    rows, device = [], None
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        scene = folder / "relief.glb"
        subprocess.run([options.program, "make-scene", "relief", "-o", scene], check=True, capture_output=True)
        for view, camera in VIEWS.items():
            width, height = map(int, options.size.split("x"))
            eye, target = camera
            seen_from = Camera(eye, target, width, height)
            frame = [scene, "--size", options.size, "--exr-type", "float", "--exr-compression", "none", "--layers",
                     "depth", "--yfov", str(YFOV_DEG), "--eye", ",".join(map(str, eye)), "--target",
                     ",".join(map(str, target))]

            def run(command, name, *more):
                subprocess.run([options.program, command, *frame, "-o", folder / name, *more], check=True,
                               capture_output=True)
                return read_depth(folder / name)

            truth = run("reference", f"{view}-truth.exr", "--spp", "1")
            for steps in STEPS:
                for refinements in REFINEMENTS if steps else REFINEMENTS[-1:]:
                    knobs = ["--set", f"relief.steps={steps}", "--set", f"relief.refinements={refinements}"]
                    times = []
                    for i in range(3):
                        name = f"{view}-{steps}-{refinements}-{i}.exr"
                        timings = folder / "timings.json"
                        timings.unlink(missing_ok=True)
                        depth = run("render", name, "--quality", "high", "--effects", "none", *knobs, "--timings", timings)
                        told = json.loads(timings.read_text())
                        times.append(told["gpu_frame_ms"])
                        device = told["device"]
                    both = one = missed = 0
                    squares = 0.0
                    for pixel, (z, t) in enumerate(zip(depth, truth)):
                        seen, true = z < 1e9, t < 1e9
                        one += seen != true
                        if not (seen and true):
                            continue
                        x, y, below = seen_from.place(pixel, t)
                        if not (abs(x) < 1 and -1.01 * DEPTH_M < below < 0.01 * DEPTH_M and 0.01 < y < 2):
                            continue
                        both += 1
                        off = (seen_from.place(pixel, z)[2] - below) / DEPTH_M
                        if abs(off) > 1 / 32:
                            missed += 1
                        else:
                            squares += off * off
                    rows.append({"view": view, "steps": steps, "refinements": refinements, "pixels": both,
                                 "missed": missed / both, "covered_by_one": one / len(truth),
                                 "depth_rms_of_layer": math.sqrt(squares / max(both - missed, 1)),
                                 "ms": round(statistics.median(times), 2)})
                    print(rows[-1])
    version = subprocess.run([options.program, "--version"], capture_output=True, text=True).stdout.strip()
    report = {"what": "depth of reliefs against the reference (bench/relief.py)", "version": version, "device": device,
              "size": options.size, "layer_depth_m": DEPTH_M, "rows": rows}
    pathlib.Path(options.json).write_text(json.dumps(report, indent=1) + "\n")


if __name__ == "__main__":
    main()
