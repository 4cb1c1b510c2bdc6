#!/usr/bin/env python3
"""Error of image-based light against the traced sky, over skies, roughness, metal and the rungs of its knobs.

    bench/image_based_light.py SKY... --json FILE [--program FILE] [--width N] [--spp N] [--quick]

Twenty spheres, roughness 0.1 to 1 in tenths, metal above and dielectric below, seen without perspective. relMSE over
the square about each sphere, divided by the sphere's part of it (the sky behind is the same in both), against
`candela reference --visibility off`.
"""
import argparse
import json
import math
import pathlib
import struct
import subprocess
import sys
import tempfile

COLUMNS, PITCH = 10, 2.2
QUALITIES = [["--quality", q] for q in ("normal", "high")]
SWEEPS = {
    "ibl.method": ["split", "lobe", "sampled"],
    "ibl.lights": [0, 4, 16, 32, 256],
    "ibl.size_px": [64, 128, 256, 512, 1024],
    "ibl.filter_samples": [8, 16, 64, 512],
    "ibl.irradiance_px": [0, 8, 16, 32, 64],
    "ibl.pixel_samples": [16, 64, 256, 1024],
}


def spheres() -> bytes:
    """The scene as GLB."""
    rings, sectors = 96, 192
    positions, indices = [], []
    for j in range(rings + 1):
        for i in range(sectors + 1):
            polar, longitude = math.pi * j / rings, 2 * math.pi * i / sectors
            ring = math.sin(polar)
            positions.append((ring * math.cos(longitude), math.cos(polar), ring * math.sin(longitude)))
    for j in range(rings):
        for i in range(sectors):
            a = j * (sectors + 1) + i
            b = a + sectors + 1
            indices += ([a, a + 1, b] if j > 0 else []) + ([a + 1, b + 1, b] if j < rings - 1 else [])
    vertex_bytes = b"".join(struct.pack("<3f", *p) for p in positions)
    binary = vertex_bytes + struct.pack(f"<{len(indices)}I", *indices)
    materials, meshes, nodes = [], [], []
    for k in range(2 * COLUMNS):
        metal = k >= COLUMNS
        materials.append({"pbrMetallicRoughness": {
            "baseColorFactor": [0.9, 0.6, 0.3, 1] if metal else [0.5, 0.3, 0.2, 1],
            "metallicFactor": int(metal), "roughnessFactor": (k % COLUMNS + 1) / COLUMNS}})
        meshes.append({"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 0}, "indices": 1, "material": k}]})
        x = (k % COLUMNS - (COLUMNS - 1) / 2) * PITCH
        nodes.append({"mesh": k, "translation": [x, PITCH / 2 if metal else -PITCH / 2, 0]})
    nodes.append({"camera": 0, "translation": [0, 0, 30]})
    camera = {"xmag": COLUMNS * PITCH / 2, "ymag": PITCH, "znear": 1, "zfar": 60}
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}],
        "nodes": nodes, "meshes": meshes, "materials": materials,
        "cameras": [{"type": "orthographic", "orthographic": camera}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(positions), "type": "VEC3",
             "min": [-1] * 3, "max": [1] * 3},
            {"bufferView": 1, "componentType": 5125, "count": len(indices), "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": len(vertex_bytes)},
                        {"buffer": 0, "byteOffset": len(vertex_bytes), "byteLength": len(binary) - len(vertex_bytes)}],
        "buffers": [{"byteLength": len(binary)}]}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    return (struct.pack("<3I", 0x46546C67, 2, 28 + len(text) + len(binary)) +
            struct.pack("<2I", len(text), 0x4E4F534A) + text + struct.pack("<2I", len(binary), 0x4E4942) + binary)


def run(command) -> str:
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(str(c) for c in command)}: {done.stderr.strip()}")
    return done.stdout


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("skies", nargs="+", type=pathlib.Path)
    parser.add_argument("--program", default="build/release/candela")
    parser.add_argument("--json", required=True, type=pathlib.Path)
    parser.add_argument("--width", type=int, default=440)
    parser.add_argument("--spp", type=int, default=400)
    parser.add_argument("--quick", action="store_true", help="qualities and methods alone")
    options = parser.parse_args()
    height = options.width // 5
    radius_px = options.width / (COLUMNS * PITCH)
    regions = []
    for row in (1, -1):
        for k in range(COLUMNS):
            x, y = (k + 0.5) * PITCH * radius_px, height / 2 - row * PITCH / 2 * radius_px
            corner, side = f"{round(x - radius_px)},{round(y - radius_px)}", round(2 * radius_px)
            regions += ["--region", f"{corner},{side},{side}"]
    settings = [("quality " + q[1], q) for q in QUALITIES]
    for knob, values in SWEEPS.items():
        if options.quick and knob != "ibl.method":
            continue
        for value in values:
            beside = ["--set", "ibl.method=sampled"] if knob == "ibl.pixel_samples" else []
            settings.append((f"{knob}={value}", ["--set", f"{knob}={value}"] + beside))
    with tempfile.TemporaryDirectory() as folder:
        scene, truth, picture = (pathlib.Path(folder) / name for name in ("spheres.glb", "truth.exr", "picture.exr"))
        scene.write_bytes(spheres())
        frame = ["--size", f"{options.width}x{height}", "--quiet"]
        effects = ["--effects", "ibl"]  # without occlusion, as the reference without visibility
        rows = []
        device = None
        for sky in options.skies:
            run([options.program, "reference", scene, "--sky", sky, *frame, "--visibility", "off", "--spp", options.spp,
                 "--exr-type", "float", "-o", truth])
            for label, more in settings:
                # Edges are not what is measured: 16 places a pixel, as the reference has all.
                result = json.loads(run([options.program, "render", scene, "--sky", sky, *frame, "--exr-type", "float", *effects,
                                         "--set", "supersample.n=4", *more, "-o", picture, "--json"]))
                device = device or result.get("device")
                compared = json.loads(run([options.program, "compare", truth, picture, "--hdr-flip", "off", "--json",
                                           *regions]))
                values = [r["metrics"]["relmse"] * 4 / math.pi for r in compared["regions"]]
                rows.append({"sky": sky.stem, "setting": label, "metal": [round(v, 6) for v in values[:COLUMNS]],
                             "dielectric": [round(v, 6) for v in values[COLUMNS:]]})
                print(f"{sky.stem:28} {label:26} metal {max(values[:COLUMNS]):.4f} {sum(values[:COLUMNS]) / COLUMNS:.4f}"
                      f"  dielectric {max(values[COLUMNS:]):.4f} {sum(values[COLUMNS:]) / COLUMNS:.4f}", flush=True)
    options.json.parent.mkdir(parents=True, exist_ok=True)
    options.json.write_text(json.dumps({
        "version": run([options.program, "--version"]).strip(), "device": device, "size": f"{options.width}x{height}",
        "reference_spp": options.spp, "metric": "relmse of a sphere",
        "roughness": [(k + 1) / COLUMNS for k in range(COLUMNS)],
        "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
