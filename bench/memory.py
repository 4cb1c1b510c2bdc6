#!/usr/bin/env python3
"""Most resident memory and time of `candela render` at 8x8: what a frame takes besides its pixels. Programs go in turn;
the first run of each row is not counted, for it fills caches. --scene: any with one material and no lights."""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOG = {"fog": {"extinction": [0.01, 0.01, 0.01], "albedo": 0.9, "falloff": 0.1}}


def run(words):
    begin = time.perf_counter()
    quiet = [(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)]
    pid = os.posix_spawn(words[0], words, os.environ, file_actions=quiet)
    _, status, usage = os.wait4(pid, 0)
    if os.waitstatus_to_exitcode(status) != 0:
        sys.exit(f"{' '.join(words)} failed")
    return usage.ru_maxrss / 1024, time.perf_counter() - begin


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", action="append", metavar="NAME=FILE", help="one or several")
    parser.add_argument("--scene", default=ROOT.parent / "shared/assets/khronos/Triangle/Triangle.gltf")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--sky", metavar="FILE", help="a large sky, as one row more at 1280x720")
    parser.add_argument("-o", "--output", type=pathlib.Path)
    options = parser.parse_args()
    programs = dict(one.split("=", 1) for one in options.program or [f"now={ROOT / 'build/release/candela'}"])
    with tempfile.TemporaryDirectory() as folder:
        look = pathlib.Path(folder) / "look.json"
        look.write_text(json.dumps(FOG))
        render = [str(options.scene), "-o", f"{folder}/frame.png", "--quiet", "--device", "cpu"]
        small = render + ["--size", "8x8"]
        rows = {"list devices": None, "without effects": small + ["--effects", "none"], "plain": small,
                "fog and sun": small + ["--look", str(look), "--sky", "atmosphere"]}
        if options.sky:
            rows["large sky"] = render + ["--size", "1280x720", "--sky", options.sky]
        results = []
        for name, words in rows.items():
            taken = {program: [] for program in programs}
            for i in range(options.runs + 1):
                for program, file in programs.items():
                    measured = run([file, "render"] + words if words else [file, "list", "devices", "--json"])
                    if i > 0:
                        taken[program].append(measured)
            for program, runs in taken.items():
                row = {"row": name, "program": program}
                for unit, values, digits in (("mb", [m for m, _ in runs], 1), ("s", [s for _, s in runs], 3)):
                    row[unit] = round(statistics.median(values), digits)
                    row[f"{unit}_range"] = [round(min(values), digits), round(max(values), digits)]
                results.append(row)
                print(json.dumps(row), file=sys.stderr)
    text = json.dumps({"runs": options.runs, "rows": results}, indent=1) + "\n"
    if options.output:
        options.output.write_text(text)
    else:
        print(text, end="")


main()
