#!/usr/bin/env python3
"""How fast `candela sequence` makes files where encoding takes most of the time; see README.md beside this file.

Programs and numbers of encoders are run in turn. CPU time stands beside wall time: on a machine with other work the
wall time says little by itself, and the fraction of the cores that a run had (CPU time / wall time) says how little.

--rates says instead how near a film comes to what the machine can do: frames a second that the device renders (the
median of whole frames, with nothing written), that all cores encode (each as one of them does while others are at
work elsewhere), that `sequence` makes, and the last by the lesser of the others. Start-up is left out of the last:
the difference of a long and a short film. Where the device is the CPU, rendering and encoding share the cores: there
the bound is the cores by the CPU seconds of a frame.
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
parser.add_argument("--lights", help="of the scene that is made")
parser.add_argument("--rates", action="store_true", help="of the first program: device, encoding, film, and their ratio")
parser.add_argument("--endings", default="exr,png")
options = parser.parse_args()

root = pathlib.Path(__file__).resolve().parent.parent
programs = [p.split("=", 1) for p in options.program or [f"candela={root / 'build/release/candela'}"]]
variants = {}
for name, program in programs[1:]:
    variants[name] = [program]
for count in options.encoders.split(","):
    said = {'0': 'all encoders', '1': '1 encoder'}.get(count, f'{count} encoders')
    variants[f"{programs[0][0]}, {said}"] = [programs[0][1], count]


def timed(program, scene, folder, ending, frames, encoders, *more):
    """Wall and CPU seconds, and what the program says, of a film of so many frames."""
    command = [program, "sequence", scene, "--frames", f"0-{frames - 1}", "--size", options.size, "--quiet",
               "--device", options.device, "-o", f"{folder}/%04d.{ending}", *more]
    if encoders is not None:
        command += ["--encoders", str(encoders)]
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    ended = subprocess.run(command, capture_output=True, text=True)
    wall = time.monotonic() - start
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if ended.returncode != 0:
        sys.exit(f"{' '.join(command)}\n{ended.stderr}")
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, ended.stdout


def make_scene(work):
    scene = f"{work}/scene.glb"
    lights = ["--lights", options.lights] if options.lights else []
    subprocess.run([programs[0][1], "make-scene", options.scene, *lights, "-o", scene], check=True, capture_output=True)
    return scene


def film(scene, work, ending, frames, encoders):
    folder = f"{work}/out"
    shutil.rmtree(folder, ignore_errors=True)
    wall, cpu, said = timed(programs[0][1], scene, folder, ending, frames, encoders, "--json")
    return wall, cpu, json.loads(said)


def device_ms(scene, work, ending):
    """A whole frame on the device, with what is packed for the file; nothing overlaps another frame."""
    subprocess.run([programs[0][1], "render", scene, "--size", options.size, "--quiet", "--device", options.device,
                    "--timings", f"{work}/t.json", "--overlap", "-o", f"{work}/frame.{ending}"], check=True)
    with open(f"{work}/t.json") as file:
        times = json.load(file)
    return times["overlap"]["all_queues_ms"], times["device"]


def spread(values):
    return {"median": round(statistics.median(values), 3), "min": round(min(values), 3), "max": round(max(values), 3),
            "samples": [round(v, 3) for v in values]}


def rates():
    cores, short = os.cpu_count(), max(2, options.frames // 4)
    result = {}
    with tempfile.TemporaryDirectory() as work:
        scene = make_scene(work)
        device = None
        for ending in options.endings.split(","):
            rows = {name: [] for name in ("device", "encoding", "film", "bound", "ratio", "film_cpu_ms")}
            film(scene, work, ending, 2, 0)  # caches
            for _ in range(options.runs):
                ms, device = device_ms(scene, work, ending)
                # Two side by side, so that a file has no threads of its own; on the host of a GPU each has a core.
                said = film(scene, work, ending, short, min(2, cores))[2]["timings"]["cpu_ms"]
                encode_ms = (said["encode"] + said["read_back"]) / short
                few, many = film(scene, work, ending, short, 0), film(scene, work, ending, options.frames, 0)
                frames = options.frames - short
                cpu_ms = 1000 * (many[1] - few[1]) / frames
                rate = frames / max(many[0] - few[0], 1e-9)
                shared = device["type"] == "cpu"
                bound = 1000 * cores / cpu_ms if shared else min(1000 / ms, 1000 * cores / encode_ms)
                for name, value in (("device", 1000 / ms), ("encoding", 1000 * cores / encode_ms), ("film", rate),
                                    ("bound", bound), ("ratio", rate / bound), ("film_cpu_ms", cpu_ms)):
                    rows[name].append(value)
            result[ending] = {name: spread(values) for name, values in rows.items()}
    print(json.dumps({"scene": options.scene, "lights": options.lights, "size": options.size, "frames": options.frames,
                      "device": device, "cpu_cores": cores, "load_average_at_end": os.getloadavg()[0],
                      "frames_a_second": result}, indent=1))


if options.rates:
    rates()
    sys.exit()

samples = {}
with tempfile.TemporaryDirectory() as work:
    scene = make_scene(work)
    for _ in range(options.runs):
        for ending in ("exr", "png"):
            for name, (program, *encoders) in variants.items():
                folder = f"{work}/out"
                shutil.rmtree(folder, ignore_errors=True)
                wall, cpu, _ = timed(program, scene, folder, ending, options.frames, encoders[0] if encoders else None)
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
