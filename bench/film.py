#!/usr/bin/env python3
"""How fast `candela sequence` makes files where encoding takes most of the time; see README.md beside this file.

Programs and numbers of encoders are run in turn. CPU time stands beside wall time: on a machine with other work the
wall time says little by itself, and the share of the cores that a run had (CPU time / wall time) says how little.
"""
import argparse
import json
import os
import pathlib
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--program", action="append", metavar="NAME=FILE", help="may be given again; its default encoders")
parser.add_argument("--encoders", default="1,0", help="of the first program: numbers, 0 is as many as cores")
parser.add_argument("--scene", default="unlit-box")
parser.add_argument("--size", default="1280x720")
parser.add_argument("--frames", type=int, default=48)
parser.add_argument("--runs", type=int, default=5)
parser.add_argument("--device", default="cpu")
options = parser.parse_args()

root = pathlib.Path(__file__).resolve().parent.parent
programs = [p.split("=", 1) for p in options.program or [f"candela={root / 'build/release/candela'}"]]
variants = {}
for name, program in programs[1:]:
    variants[name] = [program]
for count in options.encoders.split(","):
    said = {'0': 'all encoders', '1': '1 encoder'}.get(count, f'{count} encoders')
    variants[f"{programs[0][0]}, {said}"] = [programs[0][1], count]


def run(program, encoders, scene, folder, ending):
    command = [program, "sequence", scene, "--frames", f"0-{options.frames - 1}", "--size", options.size, "--quiet",
               "--device", options.device, "-o", f"{folder}/%04d.{ending}"]
    if encoders is not None:
        command += ["--encoders", encoders]
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    ended = subprocess.run(command, capture_output=True, text=True)
    wall = time.monotonic() - start
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if ended.returncode != 0:
        sys.exit(f"{' '.join(command)}\n{ended.stderr}")
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


samples = {}
with tempfile.TemporaryDirectory() as work:
    scene = f"{work}/scene.glb"
    subprocess.run([programs[0][1], "make-scene", options.scene, "-o", scene], check=True, capture_output=True)
    for _ in range(options.runs):
        for ending in ("exr", "png"):
            for name, (program, *encoders) in variants.items():
                folder = f"{work}/out"
                shutil.rmtree(folder, ignore_errors=True)
                wall, cpu = run(program, encoders[0] if encoders else None, scene, folder, ending)
                row = samples.setdefault(f"{ending}, {name}", {"wall_ms": [], "cpu_ms": []})
                row["wall_ms"].append(round(1000 * wall / options.frames, 2))
                row["cpu_ms"].append(round(1000 * cpu / options.frames, 2))

rows = {}
for name, row in samples.items():
    rows[name] = {key: {"median": statistics.median(values), "min": min(values), "samples": values}
                  for key, values in row.items()}
    busy = [c / w for c, w in zip(row["cpu_ms"], row["wall_ms"])]
    rows[name]["cores_had"] = round(statistics.median(busy), 3)
print(json.dumps({"scene": options.scene, "size": options.size, "frames": options.frames, "device": options.device,
                  "cpu_cores": os.cpu_count(), "load_average_at_end": os.getloadavg()[0],
                  "a_frame": rows}, indent=1))
