#!/usr/bin/env python3
"""Is what `candela tune` advises any good? A random search of settings of the same scenes, by the same yardstick.

For each scene: `candela tune` within its time; a traced reference; then settings drawn at random (a technique, a quality and up to
four knobs at values of their sweeps), each rendered by itself. The settings that tune advises are rendered in the same way. An
advised setting is good where its error is at most FACTOR times that of the best one found at the same time, or its time at most
FACTOR times that of the quickest one found with the same error. Errors are relMSE against the reference, whose noise is taken off.
"""
import argparse
import json
import random
import subprocess
import sys
import tempfile
from pathlib import Path


class Candela:
    def __init__(self, options, scene, folder):
        self.o, self.scene, self.folder = options, scene, Path(folder)
        self.frame = ["--size", options.size] + options.frame.split()

    def run(self, *arguments):
        quiet = [] if arguments[0] == "list" else ["--quiet"]
        done = subprocess.run([self.o.program, *arguments, *quiet], capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(f"{' '.join(arguments)}: {done.stderr.strip()}")
        return done.stdout

    def tune(self):
        return json.loads(self.run("tune", self.scene, *self.frame, "--seconds", str(self.o.seconds), "--json"))

    def trace(self, name):
        self.run("reference", self.scene, *self.frame, "--mode", "path" if name == "path" else "direct", "--spp", str(self.o.spp),
                 "--layers", "variance", "-o", str(self.folder / "truth.exr"))

    def measure(self, settings, renders):
        """Milliseconds on the device and relMSE of settings, as options of render."""
        file, timings, ms = self.folder / "picture.exr", self.folder / "timings.json", []
        for _ in range(renders):
            self.run("render", self.scene, *self.frame, *settings, "--exr-type", "float", "-o", str(file), "--timings", str(timings))
            ms.append(json.loads(timings.read_text())["gpu_frame_ms"])
        compared = json.loads(self.run("compare", str(self.folder / "truth.exr"), str(file), "--json"))
        noise = compared["noise_floor"]["relmse"]
        return min(ms), max(compared["metrics"]["relmse"] - noise, 1e-7)


def random_settings(knobs, techniques, rng):
    options = ["--technique", rng.choice(techniques), "--quality", rng.choice(["draft", "normal", "high", "high"])]
    for knob in rng.sample(knobs, rng.randint(0, 4)):
        options += ["--set", f"{knob['pass']}.{knob['knob']}={rng.choice(knob['swept'])}"]
    return options


def judge(advised, found, factor):
    """Each advised setting beside the best of those found."""
    rows = []
    for text, (ms, error) in advised.items():
        in_time = [e for m, e in found if m <= ms]
        as_exact = [m for m, e in found if e <= error]
        by_error = error / min(in_time) if in_time else 0
        by_time = ms / min(as_exact) if as_exact else 0
        rows.append({"options": text, "ms": ms, "relmse": error, "error_over_best": by_error, "time_over_best": by_time,
                     "good": by_error <= factor or by_time <= factor})
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", help="glTF files")
    parser.add_argument("--program", default="build/release/candela")
    parser.add_argument("--size", default="320x180")
    parser.add_argument("--frame", default="", help="more options of the frame: '--camera NAME --look FILE'")
    parser.add_argument("--seconds", type=float, default=60, help="of tune")
    parser.add_argument("--count", type=int, default=60, help="settings drawn at random")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--spp", type=int, default=512, help="samples a pixel of the reference")
    parser.add_argument("--factor", type=float, default=1.5)
    parser.add_argument("--json", help="file for what was measured")
    options = parser.parse_args()
    kept, bad = [], 0
    for scene in options.scenes:
        with tempfile.TemporaryDirectory() as folder:
            candela = Candela(options, scene, folder)
            report = candela.tune()
            candela.trace(report["reference"]["name"])
            texts = {c["options"] for c in report["errors"] + report["times"] if c["options"]}
            advised = {text: candela.measure(text.split(), 3) for text in sorted(texts)}
            knobs = [k for k in json.loads(candela.run("list", "knobs", "--json")) if k["kind"] == "error" and len(k["swept"]) > 1]
            listed = json.loads(candela.run("list", "techniques", "--json"))
            techniques = [name for name in listed if name != "auto"]
            rng, found, drawn = random.Random(options.seed), [], []
            for _ in range(options.count):
                settings = random_settings(knobs, techniques, rng)
                try:
                    found.append(candela.measure(settings, 1))
                    drawn.append({"options": " ".join(settings), "ms": found[-1][0], "relmse": found[-1][1]})
                except RuntimeError:
                    continue  # settings that do not go together
            rows = judge(advised, found, options.factor)
            print(f"{scene}: {len(report['trials'])} settings tried by tune in {report['wall_s']:.0f} s, {len(found)} at random")
            for row in rows:
                print(f"  {'good' if row['good'] else 'BAD '} {row['ms']:8.3g} ms, relmse {row['relmse']:.3g}: error "
                      f"{row['error_over_best']:.2f} of the best in that time, time {row['time_over_best']:.2f} of the quickest with "
                      f"that error: {row['options']}")
            bad += sum(not row["good"] for row in rows)
            kept.append({"scene": Path(scene).name, "size": options.size, "seconds": options.seconds, "tune": report, "advised": rows,
                         "random": drawn})
    if options.json:
        Path(options.json).write_text(json.dumps(kept, indent=1) + "\n")
    print(f"{bad} advised settings are more than {options.factor} times worse than what was found at random")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
