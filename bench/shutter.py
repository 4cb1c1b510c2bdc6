#!/usr/bin/env python3
"""Error and time of pictures with a shutter or a lens, by the number of frames that they are the mean of.

    bench/shutter.py --json FILE [--program FILE] [--size WxH] [--scene NAME=FILE]... [--device D] [--spp N]

The truth is `candela reference --mode direct` with as many moments of the shutter as samples of a pixel allow. Error is
relMSE in linear radiance; slope is that of log(relMSE) over log(n) between two counts. gather is one frame blurred along
its motion (subframes.gather); edges compares smooth_edges, samples and supersampling of one still frame with 8 x 8
samples. Times are those of the device's passes, the least of three.
"""
import argparse
import json
import math
import pathlib
import subprocess
import tempfile

COUNTS = (1, 4, 16, 64, 256)


def run(*command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode not in (0, 1):
        raise SystemExit(f"{' '.join(map(str, command))}\n{done.stderr}")
    return done.stdout


class Bench:
    def __init__(self, options, folder):
        self.o, self.folder = options, pathlib.Path(folder)

    def render(self, scene, out, *more):
        best = math.inf
        for _ in range(3):
            command = [self.o.program, "render", scene, "-o", out, "--size", self.o.size, "--quiet",
                       "--timings", self.folder / "t.json", "--exr-type", "float", *more]
            if self.o.device:
                command += ["--device", self.o.device]
            run(*command)
            best = min(best, json.loads((self.folder / "t.json").read_text())["gpu_frame_ms"])
        return best

    def relmse(self, picture, truth):
        for line in run(self.o.program, "compare", picture, truth).splitlines():
            if line.startswith("relmse "):
                return float(line.split()[1])
        raise SystemExit("compare prints no relmse")

    def truth(self, scene, name, *more):
        out = self.folder / f"{name}.exr"
        run(self.o.program, "reference", scene, "-o", out, "--size", self.o.size, "--mode", "direct", "--spp",
            self.o.spp, "--quiet", *more)
        return out

    def ladder(self, scene, label, *more):
        truth = self.truth(scene, label, "--subframes", "1024", *more)
        rows, before = [], None
        for n in COUNTS:
            out = self.folder / "frame.exr"
            ms = self.render(scene, out, "--subframes", n, "--set", "subframes.gather=0", *more)
            row = {"n": n, "relmse": self.relmse(out, truth), "gpu_ms": ms}
            if before:
                row["slope"] = math.log(row["relmse"] / before["relmse"]) / math.log(n / before["n"])
            rows.append(row)
            before = row
            print(label, row, flush=True)
        return rows, truth

    def scene(self, name, file, moment):
        at = ["--time", str(moment)]
        shutter = [*at, "--shutter", "180deg"]
        rows, truth = self.ladder(file, f"{name} shutter", *shutter)
        ms = self.render(file, self.folder / "frame.exr", "--set", "subframes.gather=1", *shutter)
        gather = {"relmse": self.relmse(self.folder / "frame.exr", truth), "gpu_ms": ms}
        ms = self.render(file, self.folder / "frame.exr", *at)
        sharp = {"relmse": self.relmse(self.folder / "frame.exr", truth), "gpu_ms": ms}
        print(name, "gather", gather, "sharp", sharp, flush=True)
        lens = ["--fstop", self.o.fstop, "--focus", self.o.focus]
        blurred, _ = self.ladder(file, f"{name} lens", *at, *lens)
        many = self.folder / "many.exr"
        self.render(file, many, *at, "--set", "supersample.n=8")
        edges = []
        for label, settings in (("one sample", []), ("smooth_edges 8", ["--set", "smooth_edges.reach_px=8"]),
                                ("smooth_edges 32", ["--set", "smooth_edges.reach_px=32"]),
                                ("4 samples", ["--samples", "4"]), ("supersample 2", ["--set", "supersample.n=2"])):
            one = [] if "--samples" in settings else ["--samples", "1"]
            ms = self.render(file, self.folder / "frame.exr", *at, *one, *settings)
            edges.append({"way": label, "relmse": self.relmse(self.folder / "frame.exr", many), "gpu_ms": ms})
            print(name, edges[-1], flush=True)
        return {"scene": name, "time_s": moment, "shutter": rows, "gather": gather, "sharp": sharp, "lens": blurred,
                "edges": edges}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", required=True)
    parser.add_argument("--program", default="candela")
    parser.add_argument("--size", default="320x180")
    parser.add_argument("--scene", action="append", default=[], help="NAME=FILE[@SECONDS]")
    parser.add_argument("--device", default="")
    parser.add_argument("--spp", default="1024")
    parser.add_argument("--fstop", default="0.5")
    parser.add_argument("--focus", default="4")
    options = parser.parse_args()
    results = []
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(options, folder)
        for scene in options.scene:
            name, _, rest = scene.partition("=")
            file, _, moment = rest.partition("@")
            results.append(bench.scene(name, file, float(moment or 0)))
    version = run(options.program, "--version").strip()
    pathlib.Path(options.json).write_text(json.dumps({"version": version, "size": options.size, "scenes": results},
                                                     indent=1) + "\n")


if __name__ == "__main__":
    main()
