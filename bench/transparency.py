#!/usr/bin/env python3
"""Time and error of every way of drawing see-through surfaces.

    bench/transparency.py --json FILE [--program FILE] [--width N] [--spp N] [--pictures DIR]

Times are those of `candela bench bench/suites/transparency.json`, whose rows are measured in turn. Errors are relMSE at
--width, one sample a pixel against `--transparency layers`, and four against `candela reference --mode path`, over the
picture and over parts of it. Refraction apart: `sorted` is drawn without that effect too (glass is opaque then), and
`phenomenological` without coloured shadows.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

METHODS = ["sorted", "weighted", "moments", "layers", "phenomenological"]
# Parts of a picture by name, in shares of its width and height: left, top, width, height.
SCENES = {
    "sheets": {}, "crossing": {}, "foliage": {}, "smoke": {}, "hair": {}, "windows": {},
    "panes": {"coloured sheets": (0.04, 0.2, 0.36, 0.65), "frosted sheets and slabs": (0.66, 0.15, 0.33, 0.72),
              "ball and lens": (0.42, 0.16, 0.2, 0.68)},
    "glass": {"frosted sheets": (0.1, 0.1, 0.35, 0.75), "ball": (0.6, 0.55, 0.15, 0.32),
              "prism": (0.78, 0.4, 0.12, 0.5)},
    "stained": {"coloured sheets": (0.21, 0.17, 0.47, 0.35), "coloured shadows": (0.33, 0.56, 0.2, 0.09)},
    "caustics": {"ball": (0.18, 0.26, 0.2, 0.4), "lens": (0.4, 0.2, 0.26, 0.48), "slab": (0.66, 0.34, 0.22, 0.3)},
}


def run(command) -> str:
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(str(c) for c in command)}: {done.stderr.strip()}")
    return done.stdout


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/release/candela")
    parser.add_argument("--json", required=True, type=pathlib.Path)
    parser.add_argument("--width", type=int, default=320)
    parser.add_argument("--spp", type=int, default=256)
    parser.add_argument("--pictures", type=pathlib.Path, help="keep what was compared here; traced pictures that are there are taken")
    parser.add_argument("--without-times", action="store_true")
    parser.add_argument("--scenes", default=",".join(SCENES))
    options = parser.parse_args()
    width, height = options.width, options.width * 9 // 16
    suite = pathlib.Path(__file__).resolve().parent / "suites" / "transparency.json"
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.pictures or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        times, device, driver = {}, None, None
        if not options.without_times:
            kept = folder / "rows.json"
            run([options.program, "bench", suite, "--json", kept, "--quiet"])
            for row in json.loads(kept.read_text())["rows"]:
                device, driver = row["device"]["name"], row["device"]["driver"]
                times[row["scene"], row.get("transparency", "sorted")] = {
                    "gpu_ms": row["gpu_ms"]["median"], "gpu_ci95_ms": row["gpu_ms"]["ci95"],
                    "runs": row["gpu_ms"]["count"]}
        rows = []
        for scene in options.scenes.split(","):
            parts = SCENES[scene]
            regions = [x for left, top, w, h in parts.values()
                       for x in ("--region", f"{round(left * width)},{round(top * height)},{round(w * width)},"
                                             f"{round(h * height)}")]
            file = folder / f"{scene}.glb"
            run([options.program, "make-scene", scene, "-o", file])
            frame = [file, "--size", f"{width}x{height}", "--exr-type", "float", "--quiet"]
            outputs = lambda name: ["-o", folder / f"{scene}.{name}.exr", "-o", folder / f"{scene}.{name}.png"]
            if not (folder / f"{scene}.path.exr").exists():
                run([options.program, "reference", *frame, "--mode", "path", "--spp", options.spp, *outputs("path")])
            ways = [(m, m, []) for m in METHODS]
            if parts:
                ways.append(("sorted.bare", "sorted", ["--effects", "none"]))
                ways.append(("phenomenological.uncoloured", "phenomenological",
                             ["--set", "colored_shadows.scale=off"]))
            for samples in (1, 4):
                for name, method, more in ways:
                    run([options.program, "render", *frame, "--transparency", method, "--samples", samples, *more,
                         *outputs(f"{name}.{samples}")])
            for name, method, more in ways:
                errors = {}
                for truth, samples in (("layers.1", 1), ("path", 4)):
                    compared = json.loads(run([
                        options.program, "compare", folder / f"{scene}.{truth}.exr",
                        folder / f"{scene}.{name}.{samples}.exr", "--hdr-flip", "off", "--json", *regions]))
                    key = "against_layers" if samples == 1 else "against_path"
                    errors[key] = {"whole": compared["metrics"]["relmse"]}
                    for part, region in zip(parts, compared.get("regions", [])):
                        errors[key][part] = region["metrics"]["relmse"]
                row = {"scene": scene, "transparency": method, "options": more, **errors}
                if not more:
                    row |= times.get((scene, method), {})
                rows.append(row)
                print(f"{scene:10} {name:27} layers {errors['against_layers']['whole']:.3g}  path "
                      + "  ".join(f"{k} {v:.3g}" for k, v in errors["against_path"].items())
                      + (f"  {row['gpu_ms']:.1f} ms" if "gpu_ms" in row else ""), flush=True)
    options.json.parent.mkdir(parents=True, exist_ok=True)
    options.json.write_text(json.dumps({
        "version": run([options.program, "--version"]).strip(), "device": device, "driver": driver,
        "size": f"{width}x{height}", "timed_size": "640x360", "reference_spp": options.spp, "metric": "relmse",
        "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
