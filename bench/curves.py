#!/usr/bin/env python3
"""The curves of error against time that the pages quote: measured, kept and drawn by one command.

    bench/curves.py measure [--device D] [--budget-s S] [--suites error,error-effects]
        runs each suite by `candela bench --error` within its time and keeps the rows in results/<device class>/curves-<suite>.json;
        with --report DIR also the pages with their figures
    bench/curves.py tables
        puts the tables that follow from the kept files into bench/results/README.md
    bench/curves.py check
        ends with 1 where that page says something else
"""
import argparse
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent
PAGE, BEGIN, END = ROOT / "results/README.md", "<!-- curves: bench/curves.py tables -->\n", "<!-- end of curves -->\n"
BOUNDS = (0.1, 0.01, 0.001)


def measure(options):
    for suite in options.suites.split(","):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "rows.json"
            command = [options.program, "bench", "--error", str(ROOT / "suites" / f"{suite}.json"), "--assets", options.assets, "--budget-s",
                       str(options.budget_s), "--json", str(file)]
            command += ["--device", options.device] if options.device else []
            command += ["--report", f"{options.report}/{suite}"] if options.report else []
            done = subprocess.run(command, stdout=subprocess.DEVNULL)
            if not file.exists():
                raise RuntimeError(f"{suite}: nothing was measured (exit {done.returncode})")
            if done.returncode != 0:  # a scene that is not there, or a row that failed: the others are kept
                print(f"{suite}: exit {done.returncode}", file=sys.stderr)
            run = json.loads(file.read_text())
        for row in run["rows"]:  # pictures and what no table asks for stay in the report
            for key in ("thumbnail", "passes_ms", "cpu_ms", "memory", "opening_ms", "frame_ms"):
                row.pop(key, None)
        for place in run["error_findings"]:
            place.pop("knobs", None)
        kept = {key: run[key] for key in ("notes", "wall_s", "opening_s", "rows", "error_findings") if key in run}
        kept["rows"] = [row for row in kept["rows"] if row["gpu_ms"]["count"] > 0]
        name = Path(options.results) / kept["rows"][0]["device"]["class"] / f"curves-{suite}.json"
        name.parent.mkdir(parents=True, exist_ok=True)
        name.write_text(json.dumps(kept, separators=(",", ":")) + "\n")
        print(f"{name}: {len(run['rows'])} rows in {run['wall_s']:.0f} s")


def cell(place, bound):
    """The quickest point of the front with at most that error."""
    front = next(f["points"] for f in place["fronts"] if f["reference"] == place["truth"])
    fine = [p for p in front if p["relmse"] <= bound]
    if not fine:
        least = min(front, key=lambda p: p["relmse"])
        return f"none; least {least['relmse']:.3g} in {least['gpu_ms']:.3g} ms"
    best = min(fine, key=lambda p: p["gpu_ms"])
    # Rows of before name the table of knobs as it was called then.
    return f"{best['gpu_ms']:.3g} ms: {best['setting'].replace('shadows.', 'local.')}"


def tables():
    text = ""
    for folder in sorted((ROOT / "results").iterdir()):
        for file in sorted(folder.glob("curves-*.json")):
            run = json.loads(file.read_text())
            text += f"\n`results/{folder.name}/{file.name}`: {run['rows'][0]['device']['name']}, {len(run['rows'])} rows in {run['wall_s']:.0f} s.\n\n"
            text += "| place | judged by (noise) | " + " | ".join(f"relMSE at most {b}" for b in BOUNDS) + " |\n"
            text += "| --- | --- |" + " --- |" * len(BOUNDS) + "\n"
            for place in run["error_findings"]:
                noise = [n["relmse"] for n in place["noise"] if n["reference"] == place["truth"]]
                name = re.sub(r"\S*/", "", place["place"].removesuffix(", " + run["rows"][0]["device"]["name"]))
                text += f"| {name} | {place['truth']} ({noise[0]:.1g}) | " + " | ".join(cell(place, b) for b in BOUNDS) + " |\n"
    return text + "\n"


def page_with(text):
    page = PAGE.read_text()
    before, rest = page.split(BEGIN)
    return page, before + BEGIN + text + END + rest.split(END)[1]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["measure", "tables", "check"])
    parser.add_argument("--program", default="build/release/candela")
    parser.add_argument("--device", default="")
    parser.add_argument("--budget-s", type=float, default=300)
    parser.add_argument("--suites", default="error,error-effects")
    parser.add_argument("--assets", default="../shared/assets")
    parser.add_argument("--results", default=str(ROOT / "results"), help="folder for the kept rows")
    parser.add_argument("--report", default="")
    options = parser.parse_args()
    if options.what == "measure":
        measure(options)
        return 0
    old, new = page_with(tables())
    if options.what == "tables":
        PAGE.write_text(new)
    elif old != new:
        print("bench/results/README.md is not what the kept files say: run bench/curves.py tables")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
