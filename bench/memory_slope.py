#!/usr/bin/env python3
"""Does a long film grow? Resident memory of `candela sequence` over its frames.

Renders N frames of each scene as one process, reads the process's resident memory while it runs, and fits a line through what
was read after the first quarter (when pools and caches have filled): bytes a frame, with the interval of 95 % of block means
(readings of one process follow each other, so single ones say little). No growth: the interval holds 0.
"""
import argparse
import json
import math
import subprocess
import tempfile
import time
from pathlib import Path

BLOCKS = 12
T95 = 2.228  # Student's t of BLOCKS - 2 degrees of freedom


def fit(points):
    """Least squares through (x, y): slope and its half interval."""
    n = len(points)
    mean_x, mean_y = sum(x for x, _ in points) / n, sum(y for _, y in points) / n
    squares = sum((x - mean_x) ** 2 for x, _ in points)
    slope = sum((x - mean_x) * (y - mean_y) for x, y in points) / squares
    residual = sum((y - mean_y - slope * (x - mean_x)) ** 2 for x, y in points)
    return slope, T95 * math.sqrt(residual / (n - 2) / squares)


def measure(options, scene):
    with tempfile.TemporaryDirectory() as folder:
        command = [options.program, "sequence", *scene.split(), "--size", options.size, "--frames", f"0-{options.frames - 1}",
                   "-o", str(Path(folder) / "f####.png"), "--quiet", *(["--device", options.device] if options.device else [])]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        read, frames = [], 0
        while process.poll() is None:
            status = Path(f"/proc/{process.pid}/statm")
            try:
                pages = int(status.read_text().split()[1])
            except (OSError, IndexError):
                break
            if pages == 0:  # it ends
                break
            while frames < options.frames and (Path(folder) / f"f{frames:04d}.png").exists():
                frames += 1
            if frames:
                read.append((frames, pages * 4096))
            time.sleep(0.02)
        if process.wait() != 0:
            raise SystemExit(f"{scene}: exit {process.returncode}: {process.stderr.read()}")
    late = [p for p in read if p[0] > options.frames // 4]
    blocks = []
    for i in range(BLOCKS):
        block = late[i * len(late) // BLOCKS:(i + 1) * len(late) // BLOCKS]
        blocks.append((sum(x for x, _ in block) / len(block), sum(y for _, y in block) / len(block)))
    slope, half = fit(blocks)
    return {"scene": scene, "frames": options.frames, "readings": len(read), "least_mb": round(min(y for _, y in late) / 1e6, 1),
            "most_mb": round(max(y for _, y in late) / 1e6, 1), "bytes_a_frame": round(slope), "interval_95": [round(slope - half), round(slope + half)]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/release/candela")
    parser.add_argument("--scene", action="append", required=True, help="a scene, with options after it; may be given again")
    parser.add_argument("--frames", type=int, default=1000)
    parser.add_argument("--size", default="96x54")
    parser.add_argument("--device")
    parser.add_argument("--json", help="file for the figures")
    options = parser.parse_args()
    rows = []
    for scene in options.scene:
        rows.append(measure(options, scene))
        print(json.dumps(rows[-1]), flush=True)
    if options.json:
        Path(options.json).write_text(json.dumps({"size": options.size, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
