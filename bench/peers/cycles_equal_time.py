#!/usr/bin/python3
"""candela reference --mode path against Blender's Cycles at equal time: which is nearer to its own mean?

usage: bench/peers/cycles_equal_time.py [--build DIR] [--scenes NAME,...] [--runs K] [--seconds S] [-o FILE.json]

Needs what cycles_compare.py needs. Scenes are the cities of cycles_scenes.py. Time is processor time of rendering alone: what a run with
twice the samples takes more, of either program, so that loading, trees and a busy machine do not count. Samples a pixel are then set
so that each renders for S seconds of it. K runs of each with different seeds; the error of a run is its relMSE against the mean of
all runs of the same program, times K / (K - 1), which is what it is against its converged mean. See bench/README.md.
"""
import argparse
import json
import math
import pathlib
import resource
import subprocess
import tempfile

import numpy

import cycles_scenes
import plain_exr

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = pathlib.Path(__file__).resolve().parent
NOTES = [
    "relmse: mean over runs of mean (x-m)^2 / (m^2 + 0.01) over pixels and channels, m the mean of all runs, times K/(K-1). interval: 95 %"
    " of Student's t over the runs.",
    "trimmed: the same without the 0.1 % of the pixels whose error over all runs is largest; largest_share: of relmse, what these have.",
    "error_ratio: candela's relmse over Cycles'; error_ratio_interval: of both intervals, as independent relative errors.",
    "means_apart: relMSE between the two programs' means; noise_of_means: what the spread of the runs says it should be. Where means_apart is"
    " much larger, the runs of one of them have not met light that is rare and strong: its error is larger than relmse says.",
]
# A sample of Cycles takes about a twentieth of one of candela's, and its start takes seconds: less than these samples tell nothing.
PILOT = {"candela": 1, "cycles": 16}
T95 = {4: 3.182, 8: 2.365, 16: 2.131, 32: 2.04}


def run(*command):
    """The child's processor seconds."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode or "Error" in done.stdout + done.stderr:
        raise SystemExit(f"{' '.join(command)}\n{done.stdout[-2000:]}{done.stderr}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def errors(runs):
    mean, k = runs.mean(axis=0), len(runs)
    relative = (runs - mean) ** 2 / (mean**2 + 0.01) * (k / (k - 1))
    each = relative.mean(axis=(1, 2, 3))
    pixels = numpy.sort(relative.mean(axis=(0, 3)).ravel())
    kept = pixels[:-max(len(pixels) // 1000, 1)]
    row = {"relmse": float(f"{each.mean():.4g}"),
           "interval": float(f"{T95.get(k, 2) * each.std(ddof=1) / math.sqrt(k):.3g}"),
           "trimmed": float(f"{kept.sum() / len(pixels):.4g}"),
           "largest_share": round(float(1 - kept.sum() / pixels.sum()), 4)}
    return row, mean, runs.var(axis=0, ddof=1) / k


def measure(name, scene, o, folder):
    candela = str(pathlib.Path(o.build) / "candela")

    def render_candela(seed, spp):
        file = f"{folder}/{name}-candela-{seed}.exr"
        return file, run(candela, "reference", scene["file"], "--mode", "path", "--spp", str(spp), "--size", scene["size"], "--seed",
                         str(seed), "--background", "0,0,0", "--exr-type", "float", "--exr-compression", "none", "-o", file, "--quiet")

    def render_cycles(seed, spp):
        seconds = run(o.blender, "-b", "--factory-startup", "-P", str(HERE / "cycles.py"), "--", scene["file"], "--size", scene["size"],
                      "--spp", str(spp), "--seeds", str(seed), "--output", f"{folder}/{name}-cycles")
        return f"{folder}/{name}-cycles-{seed}.exr", seconds

    programs = {"candela": render_candela, "cycles": render_cycles}
    result, means = {"text": scene["text"], "size": scene["size"], "runs": o.runs, "seconds": o.seconds}, {}
    for program in o.only.split(","):
        render = programs[program]
        # The least of three of each: others on the machine only add.
        pilot = o.pilot * PILOT[program]
        few, many = (min(render(99, spp)[1] for _ in range(3)) for spp in (pilot, 3 * pilot))
        a_sample = (many - few) / (2 * pilot)
        if a_sample <= 0:
            raise SystemExit(f"{program}: {3 * pilot} samples took no longer than {pilot}; give a larger --pilot")
        spp = max(round(o.seconds / a_sample), 1)
        row, mean, variance = errors(numpy.stack([plain_exr.read_rgb(render(seed, spp)[0]) for seed in range(1, o.runs + 1)]))
        result[program] = {"spp": spp, "seconds_a_sample": float(f"{a_sample:.4g}"), **row}
        means[program] = mean, variance
        print(f"{name} {program}: {result[program]}", flush=True)
    if len(means) == 2:
        (a, var_a), (b, var_b) = means["candela"], means["cycles"]
        scale = b**2 + 0.01
        result["error_ratio"] = round(result["candela"]["relmse"] / result["cycles"]["relmse"], 4)
        spread = math.hypot(*(result[p]["interval"] / result[p]["relmse"] for p in programs))
        result["error_ratio_interval"] = float(f"{result['error_ratio'] * spread:.2g}")
        result["means_apart"] = float(f"{((a - b) ** 2 / scale).mean():.4g}")
        result["noise_of_means"] = float(f"{((var_a + var_b) / scale).mean():.4g}")
    return result


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", default=str(ROOT / "build/release"))
    parser.add_argument("--blender", default="blender")
    parser.add_argument("--scenes", default="city-64,city-1024")
    parser.add_argument("--runs", type=int, default=16)
    parser.add_argument("--seconds", type=float, default=8)
    parser.add_argument("--pilot", type=int, default=8, help="samples of the shorter of two runs that tell a sample's time, of candela; of Cycles 16 times as many")
    parser.add_argument("--only", default="candela,cycles")
    parser.add_argument("-o", "--output", default=str(ROOT / "bench/results/cpu/cycles-equal-time.json"))
    o = parser.parse_args()
    output = pathlib.Path(o.output)
    result = json.loads(output.read_text()) if output.exists() else {"scenes": {}}
    result = {"notes": NOTES, "scenes": result["scenes"]}
    with tempfile.TemporaryDirectory() as work:
        scenes = cycles_scenes.write_scenes(pathlib.Path(work), "none", str(pathlib.Path(o.build) / "candela"))
        for name in o.scenes.split(","):
            result["scenes"].setdefault(name, {}).update(measure(name, scenes[name], o, work))
            output.write_text(json.dumps(result, indent=1) + "\n")


main()
