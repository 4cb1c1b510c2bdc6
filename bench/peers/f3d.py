#!/usr/bin/env python3
"""Candela against f3d: from the process to a PNG of the same file with one light, in turn, without anti-aliasing in both.

usage: xvfb-run bench/peers/f3d.py [--build DIR] [--scene NAME] [--lights N] [--sizes WxH,...] [--runs N] [--pictures DIR] [-o FILE.json]

`apt install f3d xvfb`; f3d draws by Mesa's llvmpipe. Instances are nodes in the file (plain_glb.py), and the camera is the file's. See bench/README.md.
"""
import argparse
import json
import os
import pathlib
import tempfile
import time

import lights
import plain_glb


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--build", default=str(lights.ROOT / "build/release"))
    parser.add_argument("--scene", default="street")
    parser.add_argument("--lights", type=int, default=1)
    parser.add_argument("--sizes", default="1280x720,2560x1440")
    parser.add_argument("--runs", type=int, default=9)
    parser.add_argument("--pictures")
    parser.add_argument("-o", "--output", default=str(lights.ROOT / "bench/results/lavapipe/peers-f3d.json"))
    options = parser.parse_args()
    result = {"what": "candela against f3d, from process to PNG with warm caches", "lights": options.lights, "cases": []}
    with tempfile.TemporaryDirectory() as folder:
        bench = lights.Bench(options, pathlib.Path(folder))
        result["f3d"] = bench.run("f3d", "--version").splitlines()[3].strip()
        scene = plain_glb.plain(bench, options.scene, options.lights)
        for size in options.sizes.split(","):
            files = {name: bench.picture_file(options.scene, size, name) for name in ("candela", "f3d")}
            commands = {"candela": [bench.program("candela"), "render", scene, "--size", size, "--device", "cpu", "--effects", "none",
                                    "--set", "resolve.samples=1", "-o", files["candela"]],
                        "f3d": ["f3d", scene, "--output", files["f3d"], "--resolution", size.replace("x", ","), "--camera-index", "0", "--quiet"]}
            walls, processors = ({name: [] for name in commands} for _ in range(2))
            for i in range(1 + options.runs):
                for name, command in commands.items():
                    start, busy = time.monotonic(), lights.processor_ms()
                    bench.run(*command)
                    if i > 0:
                        walls[name].append((time.monotonic() - start) * 1000)
                        processors[name].append(lights.processor_ms() - busy)
            row = {"scene": options.scene, "size": size, "wall_ms": {name: lights.summary(values) for name, values in walls.items()},
                   "processor_ms": {name: lights.summary(values) for name, values in processors.items()},
                   "candela_to_f3d": lights.ratio_of_pairs(walls["candela"], walls["f3d"]),
                   "candela_to_f3d_processor": lights.ratio_of_pairs(processors["candela"], processors["f3d"])}
            result["cases"].append(row)
            lights.say(f"{size}: {row['candela_to_f3d']} of f3d's time, {row['candela_to_f3d_processor']} of its processor time")
        result["load_average_at_end"] = round(os.getloadavg()[0], 2)
    pathlib.Path(options.output).write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
