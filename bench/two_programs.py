#!/usr/bin/env python3
"""Frame times of two builds of candela in turn: what a change of the program costs, as paired ratios with their intervals.

In every round each program measures the row in a process of its own, and the order changes from round to round; a row's ratio is
the geometric mean over rounds of B's median frame time over A's, with the 95 % interval of Student's t over the logarithms.
"""
import argparse
import json
import math
import statistics
import subprocess
import sys
from pathlib import Path

# Two-sided 95 % points of Student's t, by degrees of freedom; above 30 the normal distribution's is near enough.
T95 = [12.71, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160, 2.145, 2.131, 2.120, 2.110,
       2.101, 2.093, 2.086, 2.080, 2.074, 2.069, 2.064, 2.060, 2.056, 2.052, 2.048, 2.045, 2.042]


def rows_of(program, suite, technique, lights, runs, words):
    command = [program, "bench", *suite["scenes"], "--lights", str(lights), "--techniques", technique,
               "--size", suite["sizes"][0], "--samples", str(suite["samples"][0]), "--times", str(suite["times"][0]),
               "--seed", str(suite["seed"]), "--min-runs", str(runs), "--max-runs", str(runs), "--json", "-", "--quiet", *words]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)} ends with {done.returncode}: {done.stderr.strip()}")
    return json.loads(done.stdout)["rows"]


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
    parser.add_argument("--lights", help="numbers of lights, instead of the suite's")
    parser.add_argument("--json", type=Path, required=True)
    parser.add_argument("words", nargs="*", help="after --: more options of both programs")
    options = parser.parse_args()
    if options.rounds < 2:
        parser.error("an interval needs two rounds")
    suite = json.loads(options.suite.read_text())
    lights = [int(n) for n in options.lights.split(",")] if options.lights else suite["lights"]
    programs = {"a": options.a, "b": options.b}
    result = {"suite": suite["name"], "scenes": suite["scenes"], "size": suite["sizes"][0], "rounds": options.rounds,
              "runs": options.runs, "rows": []}
    for technique in suite["techniques"]:
        for count in lights:
            if count > suite.get("max_lights", {}).get(technique, count):
                continue
            medians = {"a": [], "b": []}
            for turn in range(options.rounds):
                for name in ("ab" if turn % 2 == 0 else "ba"):
                    row = rows_of(programs[name], suite, technique, count, options.runs, options.words)[0]
                    medians[name].append(row["frame_ms"]["median"])
                    result.setdefault("device", row["device"])
                    result.setdefault("version", {}).setdefault(name, row.get("version", ""))
            low, ratio, high = interval([math.log(b / a) for a, b in zip(medians["a"], medians["b"])])
            result["rows"].append({"technique": technique, "lights": count, "a_ms": round(statistics.median(medians["a"]), 4),
                                   "b_ms": round(statistics.median(medians["b"]), 4), "ratio": round(ratio, 4),
                                   "interval_95": [round(low, 4), round(high, 4)], "frame_ms": medians})
            print(f"{technique:14} {count:6} lights  {medians['a'][0]:9.3f} {medians['b'][0]:9.3f} ms  "
                  f"{ratio:.3f} [{low:.3f}, {high:.3f}]", flush=True)
    options.json.parent.mkdir(parents=True, exist_ok=True)
    options.json.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
