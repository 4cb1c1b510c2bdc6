#!/usr/bin/env python3
"""Does `candela bench --error --budget-s` keep its time, and what does it find in it?

For each scene and budget: seconds until the first line, seconds in all over the budget, rows that were measured, and the noise of
the traced reference beside the smallest difference of errors that is called sure (from the rows' own fronts).
"""
import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path


def run(options, scene, budget_s):
    with tempfile.TemporaryDirectory() as folder:
        rows = Path(folder) / "rows.json"
        command = [options.program, "bench", "--error", *scene.split(), "--size", options.size, "--budget-s", str(budget_s), "--json",
                   str(rows), "--assets", options.assets, *(["--device", options.device] if options.device else [])]
        start = time.monotonic()
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        first_s, last = None, ""
        for line in process.stderr:
            first_s, last = first_s or time.monotonic() - start, line
        code, wall_s = process.wait(), time.monotonic() - start
        if not rows.exists():
            return {"scene": scene, "budget_s": budget_s, "code": code, "first_line_s": first_s, "wall_s": wall_s, "rows": 0, "said": last}
        kept = json.loads(rows.read_text())
        frames = [row["frame_ms"]["max"] if "max" in row["frame_ms"] else row["frame_ms"]["median"] or 0 for row in kept["rows"]]
        place = kept["error_findings"][0]
        noise = [n["relmse"] for n in place["noise"] if n["reference"] == place["truth"]]
        return {"scene": scene, "budget_s": budget_s, "code": code, "first_line_s": round(first_s, 3), "wall_s": round(wall_s, 2),
                "over": round(wall_s / budget_s, 3), "rows": len(kept["rows"]), "names": sum(1 + len(r.get("same_work", [])) for r in kept["rows"]),
                "views": kept["rows"][0].get("views", 1), "slowest_frame_ms": max(frames), "truth": place["truth"],
                "noise_relmse": noise[0] if noise else None, "device": kept["rows"][0]["device"]["name"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", help="as bench takes them, with options: 'street --lights 256'")
    parser.add_argument("--program", default="build/release/candela")
    parser.add_argument("--size", default="320x180")
    parser.add_argument("--budgets", default="30,60")
    parser.add_argument("--assets", default="../shared/assets")
    parser.add_argument("--device", default="")
    parser.add_argument("--json", help="file for what was measured")
    options = parser.parse_args()
    rows, late = [], 0
    for budget_s in [float(b) for b in options.budgets.split(",")]:
        for scene in options.scenes:
            rows.append(run(options, scene, budget_s))
            print(json.dumps(rows[-1]), flush=True)
            late += rows[-1]["wall_s"] > 1.1 * budget_s + rows[-1].get("slowest_frame_ms", 0) / 1000
    for row in rows:  # the file's name, not where it lies on this machine
        row["scene"] = " ".join(Path(word).name if word.endswith((".gltf", ".glb")) else word for word in row["scene"].split())
    if options.json:
        Path(options.json).write_text("[\n" + ",\n".join(" " + json.dumps(r) for r in rows) + "\n]\n")
    print(f"{late} of {len(rows)} runs took longer than 1.1 times their budget and a frame")
    return 1 if late else 0


if __name__ == "__main__":
    sys.exit(main())
