#!/usr/bin/env python3
"""The times of a frame's passes beside what the device could do at best.

    device_rates > rates.json
    candela plan SCENE OPTIONS -o frame.exr --json > plan.json
    candela render SCENE OPTIONS -o frame.exr --timings times.json
    bench/floors.py --rates rates.json --plan plan.json --times times.json [--work PASS=multiply_adds:N]... [--json FILE]

A pass's floor is the largest of what it must move (each image and buffer that it reads or writes, once, at the rate of
copies) and the work that the caller counted for it (--work, of a rate's name: multiply_adds, atomics_64), and the time
of a pass that does nothing. Buffers whose size is a bound, not what a frame fills, and shadow maps that are read in part are
not counted, and are named.
"""
import argparse
import json
import sys

# Made as large as the worst frame needs.
BOUNDS = {"light.entries", "light.unsorted", "light.hits", "rasterize.tiles", "rasterize.large"}
# Of which a frame reads no more than it looks at.
READ_IN_PART = {"local.maps", "sun.maps"}
SHOWN_MS = 0.05


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("rates", "plan", "times"):
        parser.add_argument("--" + name, required=True)
    parser.add_argument("--work", action="append", default=[], metavar="PASS=RATE:N")
    parser.add_argument("--json")
    return parser.parse_args()


def read(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def main():
    options = arguments()
    rates, plan, times = read(options.rates), read(options.plan), read(options.times)
    sizes = {r["name"]: r["bytes"] for r in plan["resources"]}
    work = {}
    for words in options.work:
        name, counted = words.split("=")
        rate, number = counted.split(":")
        work.setdefault(name, []).append((rate, float(number)))
    rows = []
    uses = {plan_pass["name"]: plan_pass["uses"] for plan_pass in plan["passes"]}
    for name, ms in times["gpu_ms"].items():
        if ms < SHOWN_MS:
            continue
        if name not in uses:  # a plan is made without a device
            print(f"floors: {options.plan} has no pass {name}", file=sys.stderr)
            continue
        moved = {(use["resource"], use["writes"]) for use in uses[name]}
        left_out = {(r, writes) for r, writes in moved if r in BOUNDS or (r in READ_IN_PART and not writes)}
        size = sum(sizes[resource] for resource, _ in moved - left_out)
        floors = {"bytes": size / rates["copied_bytes_per_s"] * 1e3}
        for rate, number in work.get(name, []):
            floors[rate] = number / rates[rate + "_per_s"] * 1e3
        by = max(floors, key=floors.get)
        floor = floors[by] + rates["empty_pass_us"] * 1e-3
        rows.append({"pass": name, "ms": ms, "floor_ms": round(floor, 4), "times_floor": round(ms / floor, 2), "by": by,
                     "megabytes": round(size / 1e6, 2),
                     "not_counted": sorted({resource for resource, _ in left_out})})
    rows.sort(key=lambda row: -row["ms"])
    print(f"{'PASS':28} {'MS':>8} {'FLOOR':>8} {'TIMES':>6}  BY")
    for row in rows:
        print(f"{row['pass']:28} {row['ms']:8.3f} {row['floor_ms']:8.4f} {row['times_floor']:6.1f}  {row['by']}"
              f" ({row['megabytes']} MB)" + (f", without {', '.join(row['not_counted'])}" if row["not_counted"] else ""))
    if options.json:
        with open(options.json, "w", encoding="utf-8") as file:
            json.dump({"device": rates["device"], "driver": rates["driver"], "rates": rates, "job": times["job"],
                       "rows": rows}, file, indent=1)
            file.write("\n")


if __name__ == "__main__":
    main()
