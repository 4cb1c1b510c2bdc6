#!/usr/bin/env python3
"""Error and time of metaballs' polygons over the size of their cells (docs/understanding/metaballs.md).

    bench/metaballs.py --json FILE [--program FILE] [--size WxH] [--runs N]

Two scenes: that of `make-scene metaballs` at 1 s, six balls in cells of 0.05 m; and a pair of bodies, one of 48 small
balls in a shell, one of 16 larger ones in a row, in cells of 0.02 m and 0.05 m. By `metaballs.cell`, in units of what
the scene says: the root mean squares by which the layers `depth` and `normal` are off `candela reference`, over pixels
both show whose neighbours lie within 0.1 m; relMSE of the picture without shadows, of 2 x 2 samples at the same places;
and the times of the pass and of the frame on the device, the median, least and largest of runs that take turns.
Without runs (0) the times of a FILE that is there stay.
"""
import argparse
import json
import math
import pathlib
import random
import statistics
import struct
import subprocess
import tempfile

from float_exr import read_exr

CELLS = ("2", "1", "0.5", "0.25")


def write_pair(path):
    rng = random.Random(7)
    nodes, bodies = [], []

    def body(name, places, radii, cell, material):
        first = len(nodes)
        balls = []
        for place, radius in zip(places, radii):
            balls.append({"node": len(nodes), "radius": radius})
            nodes.append({"translation": place})
        bodies.append(len(nodes))
        nodes.append({"name": name, "children": list(range(first, len(nodes))), "extensions": {"CANDELA_metaballs": {
            "threshold": 0.3, "cell": cell, "material": material, "balls": balls}}})

    shell = []
    for i in range(48):  # a spiral over the sphere
        y = 1 - 2 * (i + 0.5) / 48
        across, turn = 0.5 * math.sqrt(1 - y * y), i * math.pi * (3 - math.sqrt(5))
        shell.append([across * math.cos(turn) - 0.7, 0.5 * y, across * math.sin(turn)])
    body("shell", shell, [0.16 + 0.06 * rng.random() for _ in shell], 0.02, 0)
    row = [[0.35 + 0.08 * i, 0.25 * math.sin(0.8 * i), 0.1 * math.cos(1.7 * i)] for i in range(16)]
    body("row", row, [0.3 + 0.25 * rng.random() for _ in row], 0.05, 1)
    nodes.append({"translation": [1, 2, 2], "extensions": {"KHR_lights_punctual": {"light": 0}}})
    scene = {"asset": {"version": "2.0"}, "extensionsUsed": ["CANDELA_metaballs", "KHR_lights_punctual"],
             "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 30}]}},
             "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.7, 0.3, 0.2, 1], "metallicFactor": 0}},
                           {"pbrMetallicRoughness": {"baseColorFactor": [0.2, 0.4, 0.7, 1], "metallicFactor": 0}}],
             "nodes": nodes, "scenes": [{"nodes": bodies + [len(nodes) - 1]}], "scene": 0}
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    pathlib.Path(path).write_bytes(struct.pack("<4sIIII", b"glTF", 2, 20 + len(text), len(text), 0x4e4f534a) + text)


def surface_rms(planes, truth, width):
    """Of depth and normals, and over how many pixels."""
    depth, true_depth = planes["depth.Z"], truth["depth.Z"]
    normals = [(planes[f"normal.{c}"], truth[f"normal.{c}"]) for c in "XYZ"]
    of_depth = of_normals = pixels = 0
    for i in range(width + 1, len(depth) - width - 1):
        around = [i, i - 1, i + 1, i - width, i + width]
        if all(true_depth[k] < 1e9 and depth[k] < 1e9 and abs(true_depth[k] - true_depth[i]) < 0.1 for k in around):
            pixels += 1
            of_depth += (depth[i] - true_depth[i]) ** 2
            of_normals += sum((a[i] - b[i]) ** 2 for a, b in normals)
    return math.sqrt(of_depth / max(pixels, 1)), math.sqrt(of_normals / max(pixels, 1)), pixels


def relmse(planes, truth):
    terms = [(a - b) ** 2 / (b * b + 0.01) for c in "RGB" for a, b in zip(planes[c], truth[c])]
    return sum(terms) / len(terms)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", required=True)
    parser.add_argument("--program", default="build/release/candela")
    parser.add_argument("--size", default="320x240")
    parser.add_argument("--runs", type=int, default=7)
    options = parser.parse_args()
    width = int(options.size.split("x")[0])
    kept = {}
    if not options.runs and pathlib.Path(options.json).exists():
        kept = json.loads(pathlib.Path(options.json).read_text())
    scenes, device = [], kept.get("device")
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        subprocess.run([options.program, "make-scene", "metaballs", "-o", folder / "metaballs.glb"], check=True,
                       capture_output=True)
        write_pair(folder / "pair.glb")
        eyes = {"metaballs": [], "pair": ["--eye", "0.1,0.4,2.9", "--target", "0.1,0,0", "--yfov", "43"]}
        for name, eye in eyes.items():
            def run(command, out, *more):
                subprocess.run([options.program, command, folder / f"{name}.glb", "--time", "1", "--size", options.size,
                                *eye, "-o", folder / out, *more], check=True, capture_output=True)

            plain = ["--layers", "depth,normal", "--exr-type", "float", "--exr-compression", "none"]

            def traced(*more):
                run("reference", "truth.exr", *plain, *more)
                return read_exr(folder / "truth.exr")[0]

            def drawn(cell, *more):
                run("render", "drawn.exr", "--set", f"metaballs.cell={cell}", "--effects", "none", *plain, *more)
                return read_exr(folder / "drawn.exr")[0]

            truth = traced("--spp", "1")
            picture = traced("--sampler", "uniform", "--spp", "4", "--visibility", "off", "--ambient", "occlusion")
            rows = {}
            for cell in CELLS:
                of_depth, of_normals, pixels = surface_rms(drawn(cell), truth, width)
                lit = drawn(cell, "--set", "supersample.n=2", "--set", "lights.floor_lux=0")
                rows[cell] = {"cell": float(cell), "depth_rms_m": of_depth, "normal_rms": of_normals, "pixels": pixels,
                              "relmse": relmse(lit, picture), "pass": [], "frame": []}
            for _ in range(options.runs):
                for cell in CELLS:
                    timings = folder / "timings.json"
                    timings.unlink(missing_ok=True)
                    run("render", "frame.exr", "--set", f"metaballs.cell={cell}", "--quality", "normal", "--technique",
                        "clustered", "--timings", timings)
                    told = json.loads(timings.read_text())
                    device = told["device"]
                    rows[cell]["pass"].append(told["gpu_ms"]["metaballs"])
                    rows[cell]["frame"].append(told["gpu_frame_ms"])
            before = next((s["rows"] for s in kept.get("scenes", []) if s["scene"] == name), [])
            for row in rows.values():
                for part in ("pass", "frame"):
                    times = row.pop(part)
                    if times:
                        row[f"{part}_ms"] = [round(t, 2) for t in (statistics.median(times), min(times), max(times))]
                    else:
                        row.update({f"{part}_ms": r[f"{part}_ms"] for r in before if r["cell"] == row["cell"]})
                print(name, row)
            scenes.append({"scene": name, "rows": list(rows.values())})
    version = subprocess.run([options.program, "--version"], capture_output=True, text=True).stdout.strip()
    pathlib.Path(options.json).write_text(json.dumps(
        {"what": "polygons of metaballs over the size of cells (bench/metaballs.py)", "version": version,
         "device": device, "size": options.size, "scenes": scenes}, indent=1) + "\n")


if __name__ == "__main__":
    main()
