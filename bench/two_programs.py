#!/usr/bin/env python3
"""Frame times of two builds of candela in turn: what a change of the program costs, as paired ratios with their intervals.

In every round each program measures the row in a process of its own, and the order changes from round to round; a row's ratio is
the geometric mean over rounds of B's median frame time over A's, with the 95 % interval of Student's t over the logarithms.
With --cpu the figure is the processor time of the whole process, start included, which other work on the machine disturbs less;
there it is the time of frames only on a CPU device, and of many of them. Each program has shader caches of its own, warm.
"""
import argparse
import itertools
import json
import math
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

# Two-sided 95 % points of Student's t, by degrees of freedom; above 30 the normal distribution's is near enough.
T95 = [12.71, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160, 2.145, 2.131, 2.120, 2.110,
       2.101, 2.093, 2.086, 2.080, 2.074, 2.069, 2.064, 2.060, 2.056, 2.052, 2.048, 2.045, 2.042]


def cpu_s():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def measured(program, caches, suite, scene, technique, lights, runs, words):
    command = [program, "bench", scene, *([] if lights is None else ["--lights", str(lights)]), "--techniques", technique,
               "--size", suite["sizes"][0], "--samples", str(suite["samples"][0]), "--times", str(suite.get("times", [0])[0]),
               "--seed", str(suite.get("seed", 1)), "--min-runs", str(runs), "--max-runs", str(runs), "--json", "-", "--quiet", *words]
    environment = os.environ | {"CANDELA_CACHE_DIR": caches, "MESA_SHADER_CACHE_DIR": caches}
    before = cpu_s()
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    used_ms = 1e3 * (cpu_s() - before)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)} ends with {done.returncode}: {done.stderr.strip()}")
    row = json.loads(done.stdout)["rows"][0]
    return row, {"frame_ms": row["frame_ms"]["median"], "cpu_ms": used_ms}


def interval(logarithms):
    mean = statistics.fmean(logarithms)
    n = len(logarithms)
    half = T95[min(n - 2, len(T95) - 1)] * statistics.stdev(logarithms) / math.sqrt(n)
    return [math.exp(mean - half), math.exp(mean), math.exp(mean + half)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("a", help="program A, the one before")
    parser.add_argument("b", help="program B")
    parser.add_argument("suite", type=Path, help="a suite of generated scenes, as bench/suites/lights.json")
    parser.add_argument("--rounds", type=int, default=8)
    parser.add_argument("--runs", type=int, default=12, help="frames of a row in a round")
    parser.add_argument("--cpu", action="store_true", help="processor time of the process in place of frame times")
    parser.add_argument("--lights", help="numbers of lights, instead of the suite's")
    parser.add_argument("--json", type=Path, required=True)
    parser.add_argument("words", nargs="*", help="after --: more options of both programs")
    options = parser.parse_args()
    if options.rounds < 2:
        parser.error("an interval needs two rounds")
    suite = json.loads(options.suite.read_text())
    lights = [int(n) for n in options.lights.split(",")] if options.lights else suite.get("lights", [None])
    figure = "cpu_ms" if options.cpu else "frame_ms"
    programs = {"a": options.a, "b": options.b}
    result = {"suite": suite["name"], "scenes": suite["scenes"], "size": suite["sizes"][0], "rounds": options.rounds,
              "runs": options.runs, "figure": figure, "rows": []}
    with tempfile.TemporaryDirectory() as folder:
        for scene, technique, count in itertools.product(suite["scenes"], suite["techniques"], lights):
            if count is not None and count > suite.get("max_lights", {}).get(technique, count):
                continue
            samples = {"a": [], "b": []}
            for turn in range(-1, options.rounds):  # the first fills the caches
                for name in ("ab" if turn % 2 == 0 else "ba"):
                    row, figures = measured(programs[name], f"{folder}/{name}", suite, scene, technique, count,
                                            options.runs if turn >= 0 else 1, options.words)
                    if turn >= 0:
                        samples[name].append(figures[figure])
                    result.setdefault("device", row["device"])
                    result.setdefault("version", {}).setdefault(name, row.get("version", ""))
            low, ratio, high = interval([math.log(b / a) for a, b in zip(samples["a"], samples["b"])])
            result["rows"].append({"scene": scene, "technique": technique, "lights": count,
                                   "a_ms": round(statistics.median(samples["a"]), 4),
                                   "b_ms": round(statistics.median(samples["b"]), 4), "ratio": round(ratio, 4),
                                   "interval_95": [round(low, 4), round(high, 4)], figure: samples})
            print(f"{scene} {technique:14} {count} lights  {samples['a'][0]:9.3f} {samples['b'][0]:9.3f} ms  "
                  f"{ratio:.3f} [{low:.3f}, {high:.3f}]", flush=True)
    options.json.parent.mkdir(parents=True, exist_ok=True)
    options.json.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
