#!/usr/bin/env python3
"""Time from a change of a file to the new picture of `candela watch`, by what changes. Kinds of changes go in turn."""
import argparse
import json
import os
import pathlib
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent


class Watch:
    def __init__(self, program, folder, size, device):
        shutil.copytree(ROOT / "scenes/lamp-paths", folder / "scene")
        shutil.copytree(ROOT / "shaders", folder / "shaders")
        self.scene = folder / "scene"
        self.shaders = folder / "shaders"
        words = [program, "watch", self.scene / "lamp-paths.glb", "-o", folder / "out.png", "--size", size, "--time", "1",
                 "--shader-dir", self.shaders, "--json", "--quiet"] + (["--device", device] if device else [])
        self.process = subprocess.Popen([str(word) for word in words], stdout=subprocess.PIPE, text=True)
        self.first = self.next()

    def next(self):
        line = self.process.stdout.readline()
        if not line:
            sys.exit("watch ended")
        return json.loads(line)

    def change(self, kind, count):
        """Writes a file and waits for the picture; milliseconds as a person sees them, and as the program says."""
        if kind == "look":
            file = self.scene / "lamp-paths.look.json"
            look = json.loads(file.read_text())
            look["exposure"] = {"ev": 0.01 * count}
            text = json.dumps(look)
        elif kind == "path":
            file = self.scene / "camera.txt"
            text = "".join(f"{x + 0.01 * count} {y} {z}\n" for x, y, z in
                           [(5.2, 2.2, 4.6), (4.6, 2.8, 5.4), (3.6, 3.2, 6.0), (2.2, 3.0, 6.6)])
        elif kind == "shader":
            file = self.shaders / "tonemap.comp"
            text = (ROOT / "shaders/tonemap.comp").read_text() + f"\n// {count}\n"
        elif kind == "instances":
            file = self.scene / "stones.txt"
            text = (ROOT / "scenes/lamp-paths/stones.txt").read_text() + f"1 1 1\n0 0 0\n0 {0.01 * count} 0\n"
        else:
            file = self.scene / "lamp-paths.glb"
            text = None
        new = file.with_name(file.name + "~")
        if text is None:
            data = (ROOT / "scenes/lamp-paths/lamp-paths.glb").read_bytes()
            new.write_bytes(data.replace(b'"intensity":12', b'"intensity":%d' % (10 + count % 80)))
        else:
            new.write_text(text)
        begin = time.monotonic()
        os.replace(new, file)
        said = self.next()
        return (time.monotonic() - begin) * 1000, said

    def end(self):
        self.process.send_signal(signal.SIGINT)
        self.process.wait()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default=str(ROOT / "build/release/candela"))
    parser.add_argument("--size", default="640x360")
    parser.add_argument("--runs", type=int, default=7)
    parser.add_argument("--device", default="")
    parser.add_argument("-o", "--output")
    o = parser.parse_args()
    kinds = ["look", "path", "shader", "instances", "scene"]
    seen = {kind: [] for kind in kinds}
    said = {kind: [] for kind in kinds}
    with tempfile.TemporaryDirectory(prefix="candela-watch-") as folder:
        watch = Watch(o.program, pathlib.Path(folder), o.size, o.device)
        for run in range(o.runs):
            for kind in kinds:
                ms, line = watch.change(kind, run + 1)
                seen[kind].append(round(ms, 1))
                said[kind].append(round(line["ms"], 1))
        watch.end()
    version = subprocess.run([o.program, "--version", "--json"], text=True, capture_output=True).stdout
    rows = {"scene": "lamp-paths", "size": o.size, "cores": len(os.sched_getaffinity(0)),
            "load_average": round(os.getloadavg()[0], 1), "first_picture_ms": round(watch.first["ms"], 1),
            "program": json.loads(version).get("version") if version.startswith("{") else version.strip(),
            "changes": [{"of": kind, "median_ms": round(statistics.median(said[kind]), 1), "least_ms": min(said[kind]),
                         "samples_ms": said[kind], "with_metrics_ms": seen[kind]} for kind in kinds]}
    text = json.dumps(rows, indent=1) + "\n"
    if o.output:
        pathlib.Path(o.output).write_text(text)
    print(text, end="")


if __name__ == "__main__":
    main()
