#!/usr/bin/env python3
"""What frames lose of the light of lamps without a range (lights.lost): 12 scenes of 1 to 65,536 lamps.

    bench/dim_lamps.py --json FILE [--program NAME=FILE]... [--size WxH] [--only NAME,...] [--quality NAME,...]

A floor between two walls with columns on it, under lamps as each scene says, without shadows. The truth is the frame
whose lamps have no end (lights.lost=0), which is `candela reference --visibility off` but for rounding (--check says
by how much). Measured at the pixels, none of which chose where lamps end: the share of the mean light that is kept;
and what is off of a pixel's light, as a part of the larger of it and of a hundredth of white under the exposure
(median 0.18): the worst of 1,000 pixels and the worst of all.
"""
import argparse
import json
import math
import pathlib
import random
import struct
import subprocess
import sys
import tempfile

from float_exr import read_exr

# Side of the floor and height of the lamps in metres; candela, or its logarithms' bounds.
SCENES = {
    "one": dict(lamps=1, side=20, candela=100),
    "one-dim": dict(lamps=1, side=20, candela=0.01),
    "sparse": dict(lamps=16, side=20, candela=5),
    "sparse-wide": dict(lamps=64, side=100, candela=20),
    "dim": dict(lamps=1000, side=20, candela=0.05),
    "spots": dict(lamps=1000, side=20, candela=0.05, spot=True),
    "bright-among-many": dict(lamps=2000, side=20, candela=0.01, bright=300),
    "moving": dict(lamps=1000, side=20, candela=0.05, moves=True),
    "mixed": dict(lamps=4096, side=40, candela=(1e-3, 10)),
    "dense": dict(lamps=4096, side=10, candela=0.01),
    "volume": dict(lamps=16384, side=20, candela=0.01, low=0.2, high=8),
    "wide": dict(lamps=65536, side=200, candela=0.05),
}
TIMES = [0.0, 0.5, 1.0]  # of the moving scene, whose lamps turn about its middle


def box(low, high):
    """Corners, normals and triangles of a box's six sides."""
    points, normals, index = [], [], []
    for axis in range(3):
        for end in (0, 1):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            first = len(points)
            for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
                p = [0.0] * 3
                p[axis], p[u], p[v] = (low, high)[end][axis], (low, high)[a][u], (low, high)[b][v]
                points.append(p)
                normals.append([(2 * end - 1) * float(k == axis) for k in range(3)])
            order = (0, 1, 2, 0, 2, 3) if end else (0, 2, 1, 0, 3, 2)
            index += [first + i for i in order]
    return points, normals, index


def scene_file(lamps, side, candela, low=0.5, high=1.5, spot=False, bright=0, moves=False) -> bytes:
    rng = random.Random(31)
    half = side / 2
    solids = [((-half, -0.1, -half), (half, 0, half)), ((-half, 0, -half - 0.1), (half, 0.2 * side, -half)),
              ((-half - 0.1, 0, -half), (-half, 0.2 * side, half))]
    for _ in range(8):
        x, z, wide = rng.uniform(-0.8, 0.8) * half, rng.uniform(-0.8, 0.8) * half, 0.02 * side
        solids.append(((x - wide, 0, z - wide), (x + wide, 0.12 * side, z + wide)))
    points, normals, index = [], [], []
    for solid in solids:
        p, n, i = box(*solid)
        index += [len(points) + k for k in i]
        points += p
        normals += n
    places = [(rng.uniform(-half, half), rng.uniform(low, high), rng.uniform(-half, half)) for _ in range(lamps)]
    strength = [math.exp(rng.uniform(*map(math.log, candela))) if isinstance(candela, tuple) else candela
                for _ in range(lamps)]
    if bright:
        places[0], strength[0] = (0, 2, 0), bright
    tint = [(1, rng.uniform(0.6, 1), rng.uniform(0.4, 1)) for _ in range(lamps)]
    views, accessors, binary = [], [], b""

    def accessor(rows, kind, component=5126, extremes=False):
        nonlocal binary
        flat = [v for row in rows for v in row] if isinstance(rows[0], (tuple, list)) else list(rows)
        data = struct.pack(f"<{len(flat)}{'f' if component == 5126 else 'I'}", *flat)
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)})
        binary += data
        made = {"bufferView": len(views) - 1, "componentType": component, "count": len(rows), "type": kind}
        if extremes:
            columns = list(zip(*[r if isinstance(r, (tuple, list)) else (r,) for r in rows]))
            as_float = lambda v: struct.unpack("<f", struct.pack("<f", v))[0]
            made["min"] = [as_float(min(c)) for c in columns]
            made["max"] = [as_float(max(c)) for c in columns]
        accessors.append(made)
        return len(accessors) - 1

    mesh = {"attributes": {"POSITION": accessor(points, "VEC3", extremes=True), "NORMAL": accessor(normals, "VEC3")},
            "indices": accessor(index, "SCALAR", 5125), "material": 0}
    lights = {"TRANSLATION": accessor(places, "VEC3"), "COLOR": accessor(tint, "VEC3"),
              "INTENSITY": accessor(strength, "SCALAR")}
    light = {"type": "point"}
    if spot:
        light = {"type": "spot", "spot": {"innerConeAngle": 0.5, "outerConeAngle": 1.2}}
        lights["DIRECTION"] = accessor([(rng.uniform(-0.5, 0.5), -1, rng.uniform(-0.5, 0.5)) for _ in places], "VEC3")
    eye, target = (0.45 * side, 0.35 * side, 0.75 * side), (-0.05 * side, 0, 0)
    away = [a - b for a, b in zip(eye, target)]
    turn, tilt = math.atan2(away[0], away[2]), -math.atan2(away[1], math.hypot(away[0], away[2]))
    rotation = [math.cos(turn / 2) * math.sin(tilt / 2), math.sin(turn / 2) * math.cos(tilt / 2),
                -math.sin(turn / 2) * math.sin(tilt / 2), math.cos(turn / 2) * math.cos(tilt / 2)]
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2]}],
        "extensionsUsed": ["KHR_lights_punctual", "CANDELA_light_instances"],
        "extensions": {"KHR_lights_punctual": {"lights": [light]}},
        "nodes": [{"mesh": 0}, {"camera": 0, "translation": eye, "rotation": rotation},
                  {"extensions": {"CANDELA_light_instances": {"light": 0, "attributes": lights}}}],
        "meshes": [{"primitives": [mesh]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.7, 0.7, 0.7, 1], "metallicFactor": 0,
                                                "roughnessFactor": 0.8}}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.01 * side}}],
        "accessors": accessors, "bufferViews": views}
    if moves:
        turns = [(0, math.sin(0.2 * t), 0, math.cos(0.2 * t)) for t in TIMES]
        sampler = {"input": accessor(TIMES, "SCALAR", extremes=True), "output": accessor(turns, "VEC4")}
        document["animations"] = [{"samplers": [sampler], "channels": [{"sampler": 0,
                                                                       "target": {"node": 2, "path": "rotation"}}]}]
    document["buffers"] = [{"byteLength": len(binary)}]
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    return (struct.pack("<3I", 0x46546C67, 2, 28 + len(text) + len(binary)) +
            struct.pack("<2I", len(text), 0x4E4F534A) + text + struct.pack("<2I", len(binary), 0x4E4942) + binary)


def run(command) -> str:
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(str(c) for c in command)}: {done.stderr.strip()}")
    return done.stdout + done.stderr


def measured(truth, picture, white):
    """Over pixels and channels: share kept; the worst of 1,000 pixels and of all."""
    rng = random.Random(1)
    pixels = len(truth["R"])
    off = [0.0] * pixels
    kept = whole = 0.0
    for c in "RGB":
        for i, (a, b) in enumerate(zip(truth[c], picture[c])):
            kept, whole = kept + b, whole + a
    for i in range(pixels):
        light = max(truth[c][i] for c in "RGB")
        off[i] = max(abs(truth[c][i] - picture[c][i]) for c in "RGB") / max(light, 0.01 * white)
    return {"kept": kept / whole, "worst_of_1000": max(off[i] for i in rng.sample(range(pixels), 1000)),
            "worst": max(off)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", action="append", help="NAME=FILE; several are measured in turn")
    parser.add_argument("--json", required=True, type=pathlib.Path)
    parser.add_argument("--size", default="240x160")
    parser.add_argument("--only", default=",".join(SCENES))
    parser.add_argument("--quality", default="draft,normal,high")
    parser.add_argument("--check", action="store_true", help="the truth against the reference, of scenes up to 4,096")
    options = parser.parse_args()
    programs = dict(p.split("=", 1) for p in options.program or ["now=build/release/candela"])
    rows, device = [], None
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for scene in options.only.split(","):
            file, truth_file, picture = folder / "scene.glb", folder / "truth.exr", folder / "picture.exr"
            file.write_bytes(scene_file(**SCENES[scene]))
            for time in TIMES if SCENES[scene].get("moves") else [0]:
                frame = [file, "--size", options.size, "--exr-type", "float", "--exr-compression", "none",
                         "--time", time]
                plain = ["--effects", "none", "--samples", "1"]
                program = list(programs.values())[-1]
                run([program, "render", *frame, *plain, "--set", "lights.lost=0", "-o", truth_file, "--quiet"])
                truth = read_exr(truth_file)[0]
                luminance = sorted(max(truth[c][i] for c in "RGB") for i in range(len(truth["R"])))
                white = luminance[len(luminance) // 2] / 0.18
                row = {"scene": scene, "lamps": SCENES[scene]["lamps"], "time_s": time}
                if options.check and SCENES[scene]["lamps"] <= 4096:
                    run([program, "reference", *frame, "--visibility", "off", "--spp", 1, "--sampler", "uniform",
                         "-o", picture, "--quiet"])
                    row["truth_off_reference"] = measured(read_exr(picture)[0], truth, white)
                for quality in options.quality.split(","):
                    for label, program in programs.items():
                        said = run([program, "render", *frame, *plain, "--quality", quality, "--exposure",
                                    -math.log2(white), "--verbose", "-o", picture])
                        notes = [line for line in said.splitlines() if "without range" in line]
                        made = {"program": label, "quality": quality, **row,
                                **measured(truth, read_exr(picture)[0], white), "note": notes[0] if notes else ""}
                        rows.append(made)
                        print(f"{scene:18} {time} {quality:7} {label:7} kept {made['kept']:.4f}  "
                              f"worst of 1000 {made['worst_of_1000']:.4f}  worst {made['worst']:.4f}  {made['note'][:150]}",
                              flush=True)
    options.json.write_text(json.dumps({"size": options.size, "scenes": SCENES, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
