#!/usr/bin/env python3
"""How far `relief.steps` and `relief.refinements` are from the surface (docs/understanding/relief.md).

    bench/relief.py --json FILE [--program FILE] [--size WxH] [--scene wall|column]

The scene of `make-scene relief`, and its wall alone at a grazing angle, as the layer `depth` has them at the pixels'
centres; or a column of 24 facets with the same bricks, stretched to nearly twice their width, whose outlines are those
of the relief. The truth is `candela reference`. Of the pixels that show the relief in it, by the depth in the layer of
what both show: the share that is off by more than a thirty-second of the layer (missed), and the root mean square of
what the others are off by, in the layer's depth. From near no pixel is as large as a texel; from farther off steps read
mip levels. Beside it the share of pixels that only one of them covers, and the time of the frame on the device (median
of three runs). Of the column also how far coarser ones are from one of 256 facets, both by the reference: what a curved
surface loses for its relief being each facet's own.
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

from float_exr import read_exr

DEPTH_M = 0.08
YFOV_DEG = 43
VIEWS = {"near": ((0.35, 1.45, 0.45), (0.0, 1.25, 0.0)), "oblique": ((1.5, 1.25, 1.9), (-0.1, 0.95, 0.1)),
         "grazing": ((1.1, 1.2, 0.25), (-0.6, 0.9, 0.0))}
COLUMN_VIEWS = {"column": ((0.9, 1.3, 1.1), (0.0, 1.1, -0.3)), "column, far": ((3.0, 1.8, 3.5), (0.0, 1.0, 0.0))}
RADIUS_M, FACETS, SMOOTH_FACETS, COARSER = 0.6, 24, 256, (8, 16, 32, 64)
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


def column(wall, path, facets):
    """The walls of a GLB of one chunk of JSON and one of bytes become a column of flat facets, two metres high."""
    data = pathlib.Path(wall).read_bytes()
    json_size = struct.unpack_from("<I", data, 12)[0]
    scene, binary = json.loads(data[20:20 + json_size]), bytearray(data[28 + json_size:])
    positions, normals, uvs, indices = [], [], [], []
    for i in range(facets + 1):
        angle = 2 * math.pi * i / facets
        for y in (0, 2):
            positions += [RADIUS_M * math.sin(angle), y, RADIUS_M * math.cos(angle)]
            normals += [math.sin(angle), 0, math.cos(angle)]
            uvs += [i / facets, 1 - y / 2]
        if i < facets:
            indices += [2 * i, 2 * i + 2, 2 * i + 3, 2 * i, 2 * i + 3, 2 * i + 1]

    def accessor(kind, values, size, target):
        while len(binary) % 4:
            binary.append(0)
        packed = array.array("I" if target == 34963 else "f", values).tobytes()
        scene["bufferViews"].append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(packed), "target": target})
        binary.extend(packed)
        added = {"bufferView": len(scene["bufferViews"]) - 1, "componentType": 5125 if target == 34963 else 5126,
                 "count": len(values) // size, "type": kind}
        if kind == "VEC3":
            added["min"] = [min(values[k::3]) for k in range(3)]
            added["max"] = [max(values[k::3]) for k in range(3)]
        scene["accessors"].append(added)
        return len(scene["accessors"]) - 1

    primitive = next(m for m in scene["meshes"] if m["name"] == "wall")["primitives"][0]
    primitive["attributes"] = {"POSITION": accessor("VEC3", positions, 3, 34962),
                               "NORMAL": accessor("VEC3", normals, 3, 34962),
                               "TEXCOORD_0": accessor("VEC2", uvs, 2, 34962)}
    primitive["indices"] = accessor("SCALAR", indices, 1, 34963)
    scene["materials"][primitive["material"]]["extensions"]["CANDELA_relief"]["silhouettes"] = False
    gone = [i for i, n in enumerate(scene["nodes"]) if n.get("name") in ("side", "ball")]
    for i in gone:
        scene["nodes"][i].pop("mesh")
    for n in scene["nodes"]:
        if n.get("name") == "wall":
            n.pop("translation")
    while len(binary) % 4:
        binary.append(0)
    scene["buffers"][0]["byteLength"] = len(binary)
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    size = 12 + 8 + len(text) + 8 + len(binary)
    pathlib.Path(path).write_bytes(struct.pack("<4sII", b"glTF", 2, size) + struct.pack("<II", len(text), 0x4e4f534a) +
                                   text + struct.pack("<II", len(binary), 0x004e4942) + bytes(binary))


def below_wall(place):
    """How deep a place of the layer lies, in metres, negative; None: it is not of the relief."""
    x, y, below = place
    return below if abs(x) < 1 and -1.01 * DEPTH_M < below < 0.01 * DEPTH_M and 0.01 < y < 2 else None


def below_column(place):
    x, y, z = place
    below = math.hypot(x, z) - RADIUS_M
    sagitta = RADIUS_M * (1 - math.cos(math.pi / 8))  # of the coarsest
    return below if -1.01 * DEPTH_M - sagitta < below < 0.01 * DEPTH_M and 0.01 < y < 1.99 else None


def read_depth(path):
    return read_exr(pathlib.Path(path))[0]["depth.Z"]


def compare(seen_from, below, depth, truth):
    """The share of the relief's pixels that is missed, that of all which only one covers, and the rms of the others."""
    both = one = missed = 0
    squares = 0.0
    for pixel, (z, t) in enumerate(zip(depth, truth)):
        one += (z < 1e9) != (t < 1e9)
        if not (z < 1e9 and t < 1e9):
            continue
        true = below(seen_from.place(pixel, t))
        if true is None:
            continue
        both += 1
        found = seen_from.place(pixel, z)
        off = ((found[2] if below is below_wall else math.hypot(found[0], found[2]) - RADIUS_M) - true) / DEPTH_M
        if abs(off) > 1 / 32:
            missed += 1
        else:
            squares += off * off
    return {"pixels": both, "missed": missed / both, "covered_by_one": one / len(truth),
            "depth_rms_of_layer": math.sqrt(squares / max(both - missed, 1))}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", required=True)
    parser.add_argument("--program", default="build/release/candela")
    parser.add_argument("--size", default="320x240")
    parser.add_argument("--scene", choices=("wall", "column"), default="wall")
    options = parser.parse_args()
    is_wall = options.scene == "wall"
    below = below_wall if is_wall else below_column
    width, height = map(int, options.size.split("x"))
    rows, facets, device = [], [], None
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        wall, scene = folder / "relief.glb", folder / "relief.glb"
        subprocess.run([options.program, "make-scene", "relief", "-o", wall], check=True, capture_output=True)
        if not is_wall:
            scene = folder / "column.glb"
            column(wall, scene, FACETS)

        def run(command, scene, camera, name, *more):
            eye, target = camera
            subprocess.run([options.program, command, scene, "--size", options.size, "--exr-type", "float",
                            "--exr-compression", "none", "--layers", "depth", "--yfov", str(YFOV_DEG), "--eye",
                            ",".join(map(str, eye)), "--target", ",".join(map(str, target)), "-o", folder / name,
                            *more], check=True, capture_output=True)
            return read_depth(folder / name)

        for view, camera in (VIEWS if is_wall else COLUMN_VIEWS).items():
            seen_from = Camera(*camera, width, height)
            truth = run("reference", scene, camera, f"{view}-truth.exr", "--spp", "1")
            for steps in STEPS:
                for refinements in REFINEMENTS if steps else REFINEMENTS[-1:]:
                    knobs = ["--set", f"relief.steps={steps}", "--set", f"relief.refinements={refinements}"]
                    times = []
                    for i in range(3):
                        timings = folder / "timings.json"
                        timings.unlink(missing_ok=True)
                        depth = run("render", scene, camera, f"{view}-{steps}-{refinements}-{i}.exr", "--quality",
                                    "high", "--effects", "none", *knobs, "--timings", timings)
                        told = json.loads(timings.read_text())
                        times.append(told["gpu_frame_ms"])
                        device = told["device"]
                    rows.append({"view": view, "steps": steps, "refinements": refinements,
                                 **compare(seen_from, below, depth, truth), "ms": round(statistics.median(times), 2)})
                    print(rows[-1])
            if is_wall:
                continue
            smooth = folder / "smooth.glb"
            column(wall, smooth, SMOOTH_FACETS)
            truth = run("reference", smooth, camera, "smooth.exr", "--spp", "1")
            for count in COARSER:
                coarse = folder / "coarse.glb"
                column(wall, coarse, count)
                depth = run("reference", coarse, camera, "coarse.exr", "--spp", "1")
                facets.append({"view": view, "facets": count, **compare(seen_from, below, depth, truth)})
                print(facets[-1])
    version = subprocess.run([options.program, "--version"], capture_output=True, text=True).stdout.strip()
    report = {"what": "depth of reliefs against the reference (bench/relief.py)", "version": version, "device": device,
              "size": options.size, "layer_depth_m": DEPTH_M, "rows": rows}
    if facets:
        report["facets"] = facets
    pathlib.Path(options.json).write_text(json.dumps(report, indent=1) + "\n")


if __name__ == "__main__":
    main()
