#!/usr/bin/env python3
"""What the pages of the films (docs/using/city.md) say of their frames; see README.md beside this file.

  film_quality.py stability SCENE.glb   every tenth frame with all layers: values that are not finite, lights that lists
                                        miss, and what beauty differs from the sum of its terms
  film_quality.py stillness SCENE.glb   how much crops of the film boil: --crop NAME:SECONDS:X,Y,W,H
  film_quality.py error SCENE.glb       frames against `--mode path`, by term: --times S,S,S
"""
import argparse
import json
import math
import pathlib
import subprocess
import sys
import tempfile

from float_exr import read_exr

ROOT = pathlib.Path(__file__).resolve().parent.parent
EDGES = ["depth", "normal", "object_id", "material_id"]
FRACTIONS = ["shadow_sun", "shadow_local", "occlusion"]
TERMS = ["direct_sun", "direct_point", "direct_spot", "ambient_diffuse", "ambient_specular", "emission", "background",
         "reflections", "fog"]


def candela(options, *words):
    command = [options.program, *map(str, words), "--quiet"]
    if options.device:
        command += ["--device", options.device]
    ended = subprocess.run(command, text=True, stderr=subprocess.PIPE)
    if ended.returncode:
        sys.exit(f"{' '.join(command)}\nended with {ended.returncode}: {ended.stderr}")


def exr_options(size, layers):
    return ["--size", size, "--exr-type", "float", "--exr-compression", "none", "--layers", layers]


def luminance(planes, i, layer=""):
    prefix = layer + "." if layer else ""
    return sum(w * planes[prefix + c][i] for w, c in ((0.2126, "R"), (0.7152, "G"), (0.0722, "B")))


def stability(options, folder):
    frames = range(0, round(options.seconds * 24), 10)
    candela(options, "sequence", options.scene, "--frames", ",".join(map(str, frames)), "--quality", options.quality,
            "-o", folder / "%04d.exr", *exr_options(options.size, "all"), "--allow-nonfinite")
    for frame in frames:
        name = folder / f"{frame:04}.exr"
        planes, width, height = read_exr(name)
        name.unlink()
        row = {"frame": frame, "not_finite": 0, "missed": 0, "channels": len(planes)}
        for channel, values in planes.items():
            # A sum is finite unless one of them is not: what is added is far from the largest float.
            if values.typecode == "f" and not math.isfinite(sum(values)):
                row["not_finite"] += sum(not math.isfinite(v) for v in values)
            if channel.startswith("heatmap_missed"):
                row["missed"] = max(row["missed"], *values)
        sums, most = [0.0, 0.0], 0.0
        for c in "RGB":
            terms = [planes[f"{t}.{c}"] for t in options.terms if f"{t}.{c}" in planes]
            for value, *parts in zip(planes[c], *terms):
                sums[0] += value
                sums[1] += sum(parts)
                most = max(most, abs(value - sum(parts)) / max(value, 1e-3))
        row["terms_over_beauty"], row["most_off"] = sums[1] / sums[0], most
        print(json.dumps(row), flush=True)
        yield row


def quiet_pixels(films, width, height):
    """Those that lie off edges in every frame, as in bench/stillness: one object and material with its neighbours, no
    normal turned by more than 30 degrees, no depth that bends."""
    quiet = set(y * width + x for y in range(1, height - 1) for x in range(1, width - 1))
    for planes in films:
        ids = [planes[n] for n in planes if n.startswith(("object_id", "material_id"))]
        normal = [planes[f"normal.{c}"] for c in "XYZ"]
        depth = planes["depth.Z"]
        keep = set()
        for i in quiet:
            beside = (i - 1, i + 1, i - width, i + width)
            if any(p[i] != p[j] for p in ids for j in beside):
                continue
            if any(sum(n[i] * n[j] for n in normal) < math.cos(math.radians(30)) for j in beside):
                continue
            if any(abs(1 / depth[i - d] + 1 / depth[i + d] - 2 / depth[i]) > 0.03 / depth[i] for d in (1, width)):
                continue
            keep.add(i)
        quiet = keep
    return sorted(quiet)


def shown(planes, i, exposure):
    y = min(max(luminance(planes, i) * exposure, 0), 1)
    return 12.92 * y if y <= 0.0031308 else 1.055 * y ** (1 / 2.4) - 0.055


def second(film, pixels):
    """Second differences over frames, a list for each pixel and moment."""
    return [film[t - 1][i] - 2 * film[t][i] + film[t + 1][i] for t in range(1, len(film) - 1) for i in pixels]


def stillness(options, folder):
    layers = ",".join(FRACTIONS + EDGES)
    for crop in options.crop:
        name, at_s, region = crop.split(":")
        first = round(float(at_s) * options.rate)
        words = ["--fps", options.rate, "--frames", f"{first}-{first + options.moments - 1}", "--region", region,
                 *exr_options(options.size, layers), "--resume"]
        makers = {q: ["--quality", q] for q in options.quality.split(",")}
        for seed in (1, 2):
            makers[f"truth{seed}"] = ["--technique", "reference", "--mode", "direct", "--spp", options.spp, "--seed", seed]
        films = {}
        for maker, more in makers.items():
            place = folder / name / maker
            device, options.device = options.device, None if maker.startswith("truth") else options.device
            candela(options, "sequence", options.scene, *words, *more, "-o", place / "%05d.exr")
            options.device = device
            read = [read_exr(place / f"{first + k:05}.exr") for k in range(options.moments)]
            films[maker], (width, height) = [planes for planes, _, _ in read], read[0][1:]
        # By frames of one sample a pixel for depth: means over a few random ones bend by themselves.
        pixels = quiet_pixels(films[options.quality.split(",")[-1]], width, height)
        mean = sum(luminance(films["truth1"][0], i) for i in pixels) / len(pixels)
        for layer in ["picture", *FRACTIONS]:
            def values(planes):
                if layer == "picture":
                    return [shown(planes, i, 0.18 / mean) for i in range(width * height)]
                channel = next((planes[c] for c in planes if c.startswith(layer + ".")), None)
                return channel
            if values(films["truth1"][0]) is None:
                continue
            # Two sets of samples: the mean of products of their second differences holds no noise.
            one, two = (second([values(p) for p in films[f"truth{s}"]], pixels) for s in (1, 2))
            truth = math.sqrt(max(sum(a * b for a, b in zip(one, two)) / len(one), 0))
            noise = math.sqrt(sum((a - b) ** 2 for a, b in zip(one, two)) / 2 / len(one))
            for quality in options.quality.split(","):
                if values(films[quality][0]) is None:
                    continue
                of_frames = second([values(p) for p in films[quality]], pixels)
                boil = math.sqrt(sum(d * d for d in of_frames) / len(of_frames))
                row = {"crop": name, "seconds": float(at_s), "region": region, "quality": quality, "layer": layer,
                       "pixels": len(pixels), "second_difference": boil, "truth_second_difference": truth,
                       "truth_noise": noise, "ratio": boil / truth if truth > 0 else None}
                print(json.dumps(row), flush=True)
                yield row


def error(options, folder):
    """Of the difference to paths, by term: what is too much or too little of the picture's light (bias), and the mean of
    squares relative to each pixel's light (relmse). Paths are traced twice: their difference is their noise, which
    bias_noise states (one standard deviation), and products of both differences hold none of it."""
    for at_s in options.times.split(","):
        layers = ",".join(options.terms)
        words = ["--frames", round(float(at_s) * 24), *exr_options(options.size, layers), "--resume"]
        ours, truths = folder / f"{at_s}.exr", [folder / f"{at_s}-path{seed}.exr" for seed in (1, 2)]
        candela(options, "sequence", options.scene, *words, "--quality", options.quality, "-o", ours)
        device, options.device = options.device, None
        for seed, truth in enumerate(truths, 1):
            candela(options, "sequence", options.scene, *words, "--technique", "reference", "--mode", "path", "--spp",
                    options.spp, "--seed", seed, "-o", truth)
        options.device = device
        a, width, height = read_exr(ours)
        (b, _, _), (c, _, _) = map(read_exr, truths)
        count = width * height
        whole = [(luminance(b, i) + luminance(c, i)) / 2 for i in range(count)]
        floor = 0.01 * sum(whole) / count
        for layer in ["", *options.terms]:
            first = (layer + "." if layer else "") + "R"
            if not any(first in planes for planes in (a, b, c)):
                continue
            ours_of, one, two = ([luminance(planes, i, layer) if first in planes else 0 for i in range(count)]
                                 for planes in (a, b, c))
            squares = [(x - y) * (x - z) / (w * w + floor * floor) for x, y, z, w in zip(ours_of, one, two, whole)]
            noise = [((y - z) / 2) ** 2 for y, z in zip(one, two)]
            # Without the hundredth of the pixels whose two traced values differ most: fireflies.
            kept = sorted(range(count), key=lambda i: noise[i] / (whole[i] ** 2 + floor * floor))[:count - count // 100]
            row = {"seconds": float(at_s), "term": layer or "beauty", "share_of_light": (sum(one) + sum(two)) / 2 / sum(whole),
                   "bias": (sum(ours_of) - (sum(one) + sum(two)) / 2) / sum(whole),
                   "bias_noise": math.sqrt(sum(noise)) / sum(whole),
                   "relmse": sum(squares[i] for i in kept) / len(kept)}
            print(json.dumps(row), flush=True)
            yield row


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("what", choices=["stability", "stillness", "error"])
parser.add_argument("scene", help="with its look and skies beside it")
parser.add_argument("--program", default=ROOT / "build/release/candela")
parser.add_argument("--device", help="where frames are made; traced ones on the CPU")
parser.add_argument("--size", default="240x135")
parser.add_argument("--quality", default="high", help="stillness takes several, by commas")
parser.add_argument("--seconds", type=float, default=20, help="of the film, for stability")
parser.add_argument("--crop", action="append", default=[])
parser.add_argument("--rate", type=int, default=96, help="frames a second of a crop: 96, a quarter of the film's steps")
parser.add_argument("--moments", type=int, default=6, help="frames of a crop")
parser.add_argument("--times", default="2,6,16")
parser.add_argument("--spp", type=int, default=16, help="of a truth, which is traced twice")
parser.add_argument("--terms", type=lambda text: text.split(","), default=TERMS)
parser.add_argument("--keep", type=pathlib.Path, help="folder for frames; by default one that goes")
parser.add_argument("--json", type=pathlib.Path)
options = parser.parse_args()
with tempfile.TemporaryDirectory(prefix="candela-film-") as temporary:
    run = {"stability": stability, "stillness": stillness, "error": error}[options.what]
    rows = list(run(options, options.keep or pathlib.Path(temporary)))
if options.json:
    kept = {"what": options.what, "scene": pathlib.Path(options.scene).name, "size": options.size, "quality": options.quality}
    if options.what != "stability":
        kept["reference_spp"] = options.spp
    if options.what == "stillness":
        kept["rate"], kept["moments"] = options.rate, options.moments
    options.json.write_text(json.dumps({**kept, "rows": rows}, indent=1) + "\n")
