#!/usr/bin/python3
"""Sample models of Khronos extensions beside the pictures of other engines: do silhouettes agree, and where do colours differ?

usage: bench/peers/khronos_pictures.py [--build DIR] [--shared DIR] [--spp N] [--pictures DIR]

Draws each model by `candela render` and `candela reference --mode path` with the camera of the golden pictures (shared/goldens/MANIFEST.md),
and prints the intersection over union of its silhouette with every golden's: both scaled to 256 pixels across by their means, where alpha is
above a half. The silhouette is drawn without a sky.
--pictures: sheets of the goldens and candela's pictures under studio_small_03_1k.hdr side by side; the goldens' own sky is not there.
Needs Debian's python3-numpy and python3-pil. Prints a JSON object.
"""
import argparse
import json
import pathlib
import subprocess
import tempfile

import numpy
from PIL import Image

import plain_exr

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Size, eye, target; yfov is 45 degrees.
MODELS = {
    "AttenuationTest": ("1024x768", "0,0,22", "0,0,0"),
    "ClearCoatTest": ("768x768", "0,0,20", "0,0,0"),
    "TransmissionRoughnessTest": ("768x300", "0,-0.09,1.1", "0,-0.09,0"),
}
SHOWN = ("gltf-sample-viewer", "blender-cycles")


def draw(o, model, output, how, size, *more):
    _, eye, target = MODELS[model]
    file = next((o.shared / "assets/khronos" / model).glob("*.gl*"))
    command = [str(o.build / "candela"), *how, str(file), "--size", size, f"--eye={eye}", f"--target={target}", "--yfov", "45",
               "-o", output, "--quiet", *more]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(" ".join(command) + "\n" + done.stderr)


def halved(size):
    return "x".join(str(int(x) // 2) for x in size.split("x"))


def overlap(a, b):
    return round(float((a & b).sum() / max((a | b).sum(), 1)), 4)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--shared", type=pathlib.Path, default=ROOT.parent / "shared")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--pictures", type=pathlib.Path)
    o = parser.parse_args()
    render, path = ["render"], ["reference", "--mode", "path", "--spp", str(o.spp)]
    found = {}
    with tempfile.TemporaryDirectory() as work:
        for model, (size, _, _) in MODELS.items():
            goldens = {f.stem: Image.open(f).convert("RGBA") for f in sorted((o.shared / "goldens" / model).glob("*.webp"))}
            outlines = {}
            for name, how in (("render", render), ("reference", ["reference", "--spp", "4"])):
                file = f"{work}/{model}-{name}.exr"
                draw(o, model, file, how, size, "--background", "transparent", "--exr-type", "float", "--exr-compression", "none")
                alpha = Image.fromarray(plain_exr.read_exr(file)["A"].astype(numpy.float32))
                outlines[name] = numpy.asarray(alpha.resize((256, round(256 * alpha.height / alpha.width)), Image.BOX)) > 0.5
            shape = tuple(int(x) for x in halved(size).split("x"))
            found[model] = {}
            for engine, picture in goldens.items():
                alpha = numpy.asarray(picture.resize(outlines["render"].shape[::-1], Image.BOX))[..., 3] > 127
                found[model][engine] = {name: overlap(alpha, own) for name, own in outlines.items()}
            if not o.pictures:
                continue
            o.pictures.mkdir(parents=True, exist_ok=True)
            row = [goldens[e] for e in SHOWN]
            sky = ["--sky", str(o.shared / "assets/env/studio_small_03_1k.hdr")]
            for name, how in (("render", render), ("path", path)):
                file = f"{work}/{model}-{name}.png"
                draw(o, model, file, how, halved(size), *sky)
                row.append(Image.open(file).convert("RGBA"))
            sheet = Image.new("RGB", (shape[0] * len(row), shape[1]), "white")
            for i, picture in enumerate(row):
                fitted = picture.resize(shape, Image.BOX)
                sheet.paste(fitted, (i * shape[0], 0), fitted)
            sheet.save(o.pictures / f"{model}.png")
    print(json.dumps(found, indent=1))


main()
