#!/usr/bin/env python3
"""Error and time of metaballs' polygons over the size of their cells (docs/understanding/metaballs.md).

    bench/metaballs.py --json FILE [--program FILE] [--size WxH] [--runs N]

Two scenes: that of `make-scene metaballs` at 1 s, six balls in cells of 0.05 m; and a pair of bodies, one of 48 small
balls in a shell, one of 16 larger ones in a row, in cells of 0.02 m and 0.05 m. By `metaballs.cell`, in units of what
the scene says: the root mean square by which the layer `depth` is off `candela reference`, over pixels both show whose
neighbours lie within 0.1 m; and the times of the pass and of the frame on the device, the median, least and largest
of runs that take turns.
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

from relief import read_depth

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


def depth_rms(depth, truth, width):
    squares = pixels = 0
    for i in range(width + 1, len(truth) - width - 1):
        around = [i, i - 1, i + 1, i - width, i + width]
        if all(truth[k] < 1e9 and depth[k] < 1e9 and abs(truth[k] - truth[i]) < 0.1 for k in around):
            pixels += 1
            squares += (depth[i] - truth[i]) ** 2
    return math.sqrt(squares / max(pixels, 1)), pixels


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", required=True)
    parser.add_argument("--program", default="build/release/candela")
    parser.add_argument("--size", default="320x240")
    parser.add_argument("--runs", type=int, default=7)
    options = parser.parse_args()
    width = int(options.size.split("x")[0])
    scenes, device = [], None
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
            layers = ["--layers", "depth", "--exr-type", "float", "--exr-compression", "none"]
            run("reference", "truth.exr", "--spp", "1", *layers)
            truth = read_depth(folder / "truth.exr")
            rows = {}
            for cell in CELLS:
                run("render", "depth.exr", "--set", f"metaballs.cell={cell}", "--effects", "none", *layers)
                rms, pixels = depth_rms(read_depth(folder / "depth.exr"), truth, width)
                rows[cell] = {"cell": float(cell), "depth_rms_m": rms, "pixels": pixels, "pass": [], "frame": []}
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
            for row in rows.values():
                for part in ("pass", "frame"):
                    times = row.pop(part)
                    row[f"{part}_ms"] = [round(t, 2) for t in (statistics.median(times), min(times), max(times))]
                print(name, row)
            scenes.append({"scene": name, "rows": list(rows.values())})
    version = subprocess.run([options.program, "--version"], capture_output=True, text=True).stdout.strip()
    pathlib.Path(options.json).write_text(json.dumps(
        {"what": "polygons of metaballs over the size of cells (bench/metaballs.py)", "version": version,
         "device": device, "size": options.size, "scenes": scenes}, indent=1) + "\n")


if __name__ == "__main__":
    main()
