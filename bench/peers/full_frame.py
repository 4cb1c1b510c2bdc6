#!/usr/bin/env python3
"""Candela against Filament with effects: shadows, ambient occlusion, image-based light and bloom, without fog.

usage: bench/peers/full_frame.py [--build DIR] [--scenes NAME,...] [--sky FILE] [--size WxH] [--qualities NAME,...] [--runs N]
                                 [--truth-size WxH] [--truth-seconds S] [--pictures DIR] [-o FILE.json]

Needs a build with -DCANDELA_BENCH_PEERS=ON. Both draw a frame in turn, as in lights.py; their errors are those of a smaller picture
against candela's path tracer. See bench/README.md.
"""
import argparse
import json
import os
import pathlib
import tempfile

from lights import ROOT, Bench, Case, FIRST_TIME_S, ratio, say, summary

LOOK = ROOT / "bench/suites/peers.look.json"
SHADOWED = 8
SETTINGS = {
    "candela": f"{LOOK.name}: occlusion within 2 m, bloom 0.1; shadow maps of {SHADOWED} lamps by importance (local.lights)",
    "filament": f"ambient occlusion within 2 m, bloom 0.1 interpolated without a threshold, shadow maps (PCF) of the {SHADOWED} nearest spots;"
                " 1.9 has none of points; image-based light of 256 texels a face, 64 samples; its defaults otherwise",
    "both": "4 samples a pixel, linear tone mapping, sRGB, no fog, no dither; the sky as background and light where there is one",
    "truth": "candela reference --mode path under the same look, whose noise is in both errors",
}
SCENES = {  # lights of generated scenes, and whether they lie under the sky
    "street": (256, True),
    "street-dense": (256, True),
    "cave": (None, False),
}


class FullFrames(Bench):
    def measure(self, name):
        lights, outdoors = SCENES[name]
        case, options = Case(name, 4), self.options
        sky = ["--sky", options.sky] if outdoors else []
        mine = ["--look", str(LOOK), "--set", f"local.lights={SHADOWED}", *sky]
        peer = ["--shadowed-spots", str(SHADOWED), "--occlusion", "2", "--bloom", "0.1", *sky]

        def servers():
            made = {f"candela {q}": self.candela(case, lights, "clustered", *mine, "--quality", q)
                    for q in options.qualities.split(",")}
            return {**made, "filament": self.filament(case, lights, *peer)}

        truth = self.picture_file(name, "truth")
        self.run(self.program("candela"), "reference", self.scene(name, lights), "--mode", "path", "--time", str(FIRST_TIME_S),
                 "--size", options.truth_size, "--seconds", str(options.truth_seconds), "--tonemap", "none", "--look", str(LOOK),
                 *(sky or ["--background", "0,0,0"]), "-o", truth)
        row = {"scene": name, "lights": lights, "sky": outdoors}
        size, options.size = options.size, options.truth_size
        small = servers()
        row["to_truth"] = {n: self.apart(self.picture(s, name, n), truth) for n, s in small.items()}
        row["programs"] = {n: s.about for n, s in small.items()}
        options.size = size
        timed = servers()
        samples, _, _ = self.in_turn(timed)
        for server in [*small.values(), *timed.values()]:
            server.close()
        row["ms"] = {n: summary(values) for n, values in samples.items()}
        row["candela_to_filament"] = {n: ratio(values, samples["filament"]) for n, values in samples.items() if n != "filament"}
        say(f"{name}: ratio {row['candela_to_filament']}, to the truth {row['to_truth']}")
        return row


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--build", default=str(ROOT / "build/release"))
    parser.add_argument("--scenes", default=",".join(SCENES))
    parser.add_argument("--sky", default=str(ROOT / "../shared/assets/env/narrow_moonlit_road_1k.hdr"))
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--qualities", default="high,normal", help="of candela")
    parser.add_argument("--truth-size", default="480x270")
    parser.add_argument("--truth-seconds", type=float, default=60)
    parser.add_argument("--runs", type=int, default=11)
    parser.add_argument("--pictures", help="keep the pictures in this folder")
    parser.add_argument("-o", "--output", default=str(ROOT / "bench/results/lavapipe/peers-full-frame.json"))
    options = parser.parse_args()
    for name in options.scenes.split(","):
        if name not in SCENES:
            parser.error(f"--scenes: '{name}' is none of {', '.join(SCENES)}")
    with tempfile.TemporaryDirectory() as folder:
        bench = FullFrames(options, pathlib.Path(folder))
        result = {"what": "candela against Filament with effects", "settings": SETTINGS, "size": options.size,
                  "truth_size": options.truth_size, "sky": pathlib.Path(options.sky).name,
                  "cpu_cores": len(os.sched_getaffinity(0)), "rows": [bench.measure(name) for name in options.scenes.split(",")],
                  "load_average_at_end": round(os.getloadavg()[0], 2)}
    pathlib.Path(options.output).write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
