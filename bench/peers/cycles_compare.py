#!/usr/bin/python3
"""candela reference --mode path against Blender's Cycles: do they differ by more than their noise?

usage: bench/peers/cycles_compare.py [--build DIR] [--assets DIR] [--scenes NAME,...] [--runs K] [--spp N] [--pictures DIR] [-o FILE.json]

Needs Debian's packages blender (3.4) and python3-numpy. Every scene is one glTF file that both read (cycles_scenes.py says how it was
made, cycles.py how Blender is set). Each renders it K times with different seeds; the spread of the runs is the noise, whatever the
samplers are. Rows of scenes that are not asked for stay in FILE. See bench/README.md.
"""
import argparse
import json
import math
import pathlib
import subprocess
import tempfile
import time

import numpy

import cycles_scenes
import plain_exr

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = pathlib.Path(__file__).resolve().parent
NOTES = [
    "chi2: over squares of block_px pixels and the channels, the mean of (a-b)^2 / (var_a + var_b), a and b the squares' means over all"
    " runs, the variances from the spread of the runs. 1 is noise alone; chi2_se is its standard error for independent squares and"
    " wholly dependent channels. beyond_3_sigma: share of values, 0.0027 for Gaussian noise.",
    "energy: mean of candela's pixels over that of Cycles', with the standard error of the ratio, by channel.",
    "relmse: mean (a-b)^2 / (b^2 + 0.01) over pixels and channels; relmse_of_noise: what the two variances say it should be.",
    "candela_compare: relmse of the first run of each by `candela compare`, and its floor, which holds the noise of candela's run alone.",
]


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True)
    # Blender ends with 0 whatever its script did.
    if done.returncode or "Error" in done.stdout + done.stderr:
        raise SystemExit(f"{' '.join(command)}\n{done.stdout[-2000:]}{done.stderr}")
    return done.stdout


def squares(image, side):
    """Means of side x side pixels; what does not fill a square is left out."""
    h, w = image.shape[0] // side * side, image.shape[1] // side * side
    return image[:h, :w].reshape(h // side, side, w // side, side, -1).mean(axis=(1, 3))


def chi_square(a, b, variance, side):
    difference, v = squares(a - b, side), squares(variance, side) / side**2
    alive = v > 0
    if numpy.any(difference[~alive] != 0):
        raise SystemExit("a difference where no run has any noise")
    z2 = difference[alive] ** 2 / v[alive]
    count = int(numpy.any(alive, axis=-1).sum())
    return {"block_px": side, "blocks": count, "chi2": round(float(z2.mean()), 4), "chi2_se": round(math.sqrt(2 / count), 4),
            "beyond_3_sigma": round(float((z2 > 9).mean()), 5), "largest_sigma": round(float(math.sqrt(z2.max())), 2)}


def statistics(a, b):
    """a, b: runs, rows, columns, channels."""
    mean_a, mean_b = a.mean(axis=0), b.mean(axis=0)
    var_a, var_b = a.var(axis=0, ddof=1) / len(a), b.var(axis=0, ddof=1) / len(b)
    total_a, total_b = mean_a.sum(axis=(0, 1)), mean_b.sum(axis=(0, 1))
    ratio = total_a / total_b
    error = numpy.sqrt(var_a.sum(axis=(0, 1)) + ratio**2 * var_b.sum(axis=(0, 1))) / total_b
    scale = mean_b**2 + 0.01
    row = {
        "blocks": [chi_square(mean_a, mean_b, var_a + var_b, side) for side in (8, 32)],
        "energy": {"ratio": [round(float(x), 6) for x in ratio], "standard_error": [round(float(x), 6) for x in error]},
        "relmse": float(f"{((mean_a - mean_b) ** 2 / scale).mean():.4g}"),
        "relmse_of_noise": float(f"{((var_a + var_b) / scale).mean():.4g}"),
    }
    return row, mean_a, mean_b, var_a + var_b


def strip(path, a, b, variance):
    """candela, Cycles, and the difference of 4 x 4 pixels in standard errors: red where candela is brighter, blue where darker; 4 is full."""
    difference, v = squares((a - b).mean(axis=2, keepdims=True), 4), squares(variance.sum(axis=2, keepdims=True) / 9, 4) / 16
    # Channels of one run are correlated: between no and full correlation this is too small by up to the root of 3.
    sigma = numpy.where(v > 0, difference / numpy.sqrt(numpy.where(v > 0, v, 1)), 0)[..., 0] / 4
    heat = numpy.ones((*sigma.shape, 3))
    heat[..., 0] += numpy.minimum(sigma, 0)
    heat[..., 1] -= numpy.abs(sigma)
    heat[..., 2] -= numpy.maximum(sigma, 0)
    whole = numpy.ones_like(a)
    big = numpy.kron(heat, numpy.ones((4, 4, 1)))
    whole[:big.shape[0], :big.shape[1]] = big
    row = numpy.concatenate([plain_exr.display(a), plain_exr.display(b), whole], axis=1)
    plain_exr.write_png(path, numpy.kron(row, numpy.ones((2, 2, 1))))


def measure(name, scene, o, folder):
    candela = str(pathlib.Path(o.build) / "candela")
    seeds = list(range(1, o.runs + 1))
    sky = ["--sky", scene["sky"]] if "sky" in scene else ["--background", "0,0,0"]
    files = {"candela": [f"{folder}/{name}-candela-{s}.exr" for s in seeds], "cycles": [f"{folder}/{name}-cycles-{s}.exr" for s in seeds]}
    seconds, start = {}, time.monotonic()
    for seed, file in zip(seeds, files["candela"]):
        run(candela, "reference", scene["file"], "--mode", "path", "--spp", str(o.spp), "--size", scene["size"], "--seed", str(seed), *sky,
            "--exr-type", "float", "--exr-compression", "none", "-o", file, "--quiet")
    seconds["candela"], start = round(time.monotonic() - start, 1), time.monotonic()
    run(o.blender, "-b", "--factory-startup", "-P", str(HERE / "cycles.py"), "--", scene["file"], "--size", scene["size"], "--spp", str(o.spp),
        "--seeds", ",".join(map(str, seeds)), "--output", f"{folder}/{name}-cycles", *sky[:2 if "sky" in scene else 0])
    seconds["cycles"] = round(time.monotonic() - start, 1)
    row, a, b, variance = statistics(*(numpy.stack([plain_exr.read_rgb(f) for f in files[k]]) for k in ("candela", "cycles")))
    pictures = pathlib.Path(o.pictures or folder)
    pictures.mkdir(parents=True, exist_ok=True)
    strip(pictures / f"{name}.png", a, b, variance)
    compared = json.loads(run(candela, "compare", files["candela"][0], files["cycles"][0], "--json"))
    row["candela_compare"] = {"relmse": compared["metrics"]["relmse"], "noise_floor": compared["noise_floor"]["relmse"]}
    about = {"text": scene["text"], "size": scene["size"], "runs": o.runs, "spp_a_run": o.spp}
    return {**about, **row, "seconds": seconds}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", default=str(ROOT / "build/release"))
    parser.add_argument("--assets", default=str(ROOT.parent / "shared/assets"))
    parser.add_argument("--blender", default="blender")
    parser.add_argument("--scenes")
    parser.add_argument("--runs", type=int, default=8)
    parser.add_argument("--spp", type=int, default=128)
    parser.add_argument("--pictures")
    parser.add_argument("-o", "--output", default=str(ROOT / "bench/results/cpu/cycles.json"))
    o = parser.parse_args()
    output = pathlib.Path(o.output)
    result = json.loads(output.read_text()) if output.exists() else {"scenes": {}}
    version = run(o.blender, "--version").splitlines()[0]
    candela = run(str(pathlib.Path(o.build) / "candela"), "--version").split("\n")[0]
    result = {"programs": {"candela": candela, "cycles": version}, "notes": NOTES, "scenes": result["scenes"]}
    with tempfile.TemporaryDirectory() as work:
        scenes = cycles_scenes.write_scenes(pathlib.Path(work), o.assets)
        for name in o.scenes.split(",") if o.scenes else scenes:
            row = result["scenes"][name] = measure(name, scenes[name], o, work)
            first = row["blocks"][0]
            print(f"{name}: chi2 {first['chi2']} +- {first['chi2_se']}, energy {row['energy']['ratio']} +- {row['energy']['standard_error']}, "
                  f"relMSE {row['relmse']} of noise {row['relmse_of_noise']}", flush=True)
            output.write_text(json.dumps(result, indent=1) + "\n")


main()
