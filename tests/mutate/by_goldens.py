#!/usr/bin/env python3
"""Draws faults in shaders by seed and tells which of them a golden catches:
by_goldens.py --program build/release/candela --count 150 --json FILE.

Nothing is rebuilt: frames take the changed shaders by --shader-dir. FILE keeps every verdict, so a run that is ended
goes on where it was. A fault in a shader that no golden's plan holds is "unused"; it says nothing of the goldens. A
fault is "caught" by the first golden whose picture is not the one without it, pixel for pixel, or that fails. What no
golden catches, the tests of its area may: mutate.cmake builds these faults in (CANDELA_MUTATE_SHADERS)."""
import argparse
import json
import os
import pathlib
import random
import re
import shutil
import subprocess
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import draw

ROOT = pathlib.Path(__file__).resolve().parents[2]
COMPONENT = re.compile(r"(?<=[\w\])])\.([xyz])\b(?!\()")
SQUARE = re.compile(r"\b(\w+(?:\.\w+)?) \* \1\b")
CHOICE = re.compile(r"\b(min|max)\(")


def places(name, text):
    """(operator, start, end, new text) in a shader: those of draw.py, and what shading gets wrong beside."""
    found, start = draw.candidates(name, text), 0
    for line in text.split("\n"):
        if line.startswith("  ") and not draw.NO_CODE.search(line) and "//" not in line:
            for one in COMPONENT.finditer(line):
                found.append(("component", start + one.start(1), start + one.end(1), "yzx"["xyz".index(one[1])]))
            for one in SQUARE.finditer(line):
                found.append(("square", start + one.start(), start + one.end(), one[1]))
            for one in CHOICE.finditer(line):
                found.append(("choice", start + one.start(1), start + one.end(1), "max" if one[1] == "min" else "min"))
        start += len(line) + 1
    return found


def drawn(count, seed):
    """As many of each operator as there are, of all shaders alike."""
    choose = random.Random(seed)
    by_operator = {}
    for path in sorted((ROOT / "shaders").rglob("*.*")):
        name = path.relative_to(ROOT).as_posix()
        if "/shared/" in name or path.suffix not in (".glsl", ".comp", ".frag", ".vert"):
            continue
        for place in places(name, path.read_text()):
            by_operator.setdefault(place[0], []).append((name, *place))
    for list_ in by_operator.values():
        choose.shuffle(list_)
    faults, taken = [], {}
    while len(faults) < count:
        for operator in sorted(by_operator):
            while by_operator[operator]:
                name, kind, start, end, new = by_operator[operator].pop()
                if any(start < b and a < end for a, b in taken.get(name, [])):
                    continue
                taken.setdefault(name, []).append((start, end))
                text = (ROOT / name).read_text()
                faults.append({"file": name, "line": text[:start].count("\n") + 1, "operator": kind, "at": [start, end],
                               "old": text[start:end], "new": new})
                break
    return faults[:count]


class Goldens:
    def __init__(self, program, pool):
        self.program, self.jobs, self.shaders = program, {}, {}
        self.made = pathlib.Path(tempfile.mkdtemp(prefix="candela-mutate-"))
        for file in sorted((ROOT / "golden").glob("*/golden.json")):
            golden = json.loads(file.read_text())
            if not golden["scene"].startswith("assets:") and not golden.get("sky", "").startswith("assets:"):
                self.jobs[file.parent.name] = self.arguments(golden)
        self.seconds = {}
        list(pool.map(self.draw, self.jobs))
        self.order = sorted(self.jobs, key=self.seconds.get)
        self.ordering = threading.Lock()

    def draw(self, name):
        """The picture without a fault, its time and its shaders."""
        self.shaders[name] = self.shaders_of(name)
        begun = time.monotonic()
        if wrong := self.picture(name, ROOT / "shaders", self.made / f"{name}.png"):
            raise SystemExit(f"by_goldens: without a fault {name} fails: {wrong}")
        self.seconds[name] = time.monotonic() - begun

    def using(self, file):
        """Goldens whose plans hold a shader; first those that caught a fault last."""
        with self.ordering:
            return [name for name in self.order if file in self.shaders[name]]

    def caught(self, name):
        with self.ordering:
            self.order.remove(name)
            self.order.insert(0, name)

    def arguments(self, golden):
        scene = golden["scene"]
        if scene.startswith("made:"):
            scene = self.made / f"{scene[5:]}.glb"
            if not scene.exists():
                subprocess.run([self.program, "make-scene", golden["scene"][5:], "-o", scene], check=True, capture_output=True)
        words = [str(ROOT / scene)]
        for key, value in golden["job"].items():
            if key == "dither":
                words += [] if value else ["--no-dither"]
            elif key == "set":
                words += [word for setting in value for word in ("--set", setting)]
            elif key == "look":
                words += ["--look", str(ROOT / value)]
            elif key not in ("motion_s", "framing") and value != "auto":
                words += [f"--{key}", str(value)]
        return words + (["--frame", str(golden["frame"])] if golden.get("frame") is not None else [])

    def shaders_of(self, name):
        """Files below shaders/ that the plan of a golden holds, with all that they include."""
        plan = subprocess.run([self.program, "plan", *self.jobs[name], "--json", "-o", "plan.png"], capture_output=True, text=True, check=True)
        left = set(re.findall(r"[\w/]+\.(?:comp|frag|vert)\b", plan.stdout))
        held = set()
        while left:
            file = left.pop()
            path = ROOT / "shaders" / file
            if file in held or not path.exists():
                continue
            held.add(file)
            left |= set(re.findall(r'#include "(lib/[^"]+)"', path.read_text()))
        return {f"shaders/{file}" for file in held}

    def picture(self, name, shaders, out):
        """Renders it; what went wrong, or nothing."""
        words = [self.program, "render", *self.jobs[name], "-o", out, "--quiet", "--shader-dir", shaders]
        try:
            ended = subprocess.run(words, capture_output=True, text=True, timeout=120)
        except subprocess.TimeoutExpired:
            return "time limit"
        said = ended.stderr.strip().splitlines() or ["nothing said"]
        return "" if ended.returncode == 0 else f"exit {ended.returncode}: {said[0][:200]}"

    def differs(self, name, out):
        """From the picture that shaders without a fault make."""
        words = [self.program, "compare", self.made / f"{name}.png", out, "--limit", "differing=0", "--hdr-flip", "off"]
        return subprocess.run(words, capture_output=True).returncode != 0


def judge(fault, goldens):
    using = goldens.using(fault["file"])
    if not using:
        return "unused", ""
    with tempfile.TemporaryDirectory(prefix="candela-mutate-") as folder:
        shaders, out = pathlib.Path(folder) / "shaders", pathlib.Path(folder) / "out.png"
        shutil.copytree(ROOT / "shaders", shaders)
        changed = pathlib.Path(folder) / fault["file"]
        text, (start, end) = changed.read_text(), fault["at"]
        changed.write_text(text[:start] + fault["new"] + text[end:])
        for name in using:
            wrong = goldens.picture(name, shaders, out)
            if "error" in wrong and ("glslang" in wrong or fault["file"].rsplit("/")[-1] in wrong):
                return "invalid", wrong
            if wrong or goldens.differs(name, out):
                goldens.caught(name)
                return "caught", f"{name}{': ' + wrong if wrong else ''}"
    return "survived", f"{len(using)} goldens hold it"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/release/candela")
    parser.add_argument("--count", type=int, default=150)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--json", type=pathlib.Path, required=True)
    parser.add_argument("--seconds", type=float, default=1e9, help="ends behind the fault in which this time is over")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    options = parser.parse_args()
    options.program = options.program.resolve()
    faults = drawn(options.count, options.seed)
    kept = json.loads(options.json.read_text())["faults"] if options.json.exists() else []
    known = {(f["file"], f["operator"], tuple(f["at"]), f["old"], f["new"]): f for f in kept}
    writing, begun = threading.Lock(), time.monotonic()
    # Frames side by side, each on one thread, take less than one after another on all.
    os.environ |= {"LP_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}

    def write():
        done = [f for f in faults if "verdict" in f]
        tally = {verdict: sum(f["verdict"] == verdict for f in done) for verdict in ("caught", "survived", "unused", "invalid")}
        options.json.write_text(json.dumps({"seed": options.seed, "count": options.count, **tally, "faults": done}, indent=1) + "\n")
        return tally

    def one(fault):
        before = known.get((fault["file"], fault["operator"], tuple(fault["at"]), fault["old"], fault["new"]))
        if before:
            verdict = before["verdict"], before["by"]
        elif time.monotonic() - begun < options.seconds:
            verdict = judge(fault, goldens)
            print(f"{verdict[0]:9} {fault['file']}:{fault['line']} {fault['operator']}: {fault['old']} -> {fault['new']}  {verdict[1]}", flush=True)
        else:
            return
        with writing:
            fault["verdict"], fault["by"] = verdict
            write()

    with ThreadPoolExecutor(options.jobs) as pool:
        goldens = Goldens(options.program, pool)
        print(f"mutate: {len(goldens.jobs)} goldens drawn in {time.monotonic() - begun:.0f} s", flush=True)
        list(pool.map(one, faults))
    tally = write()
    shutil.rmtree(goldens.made)
    print(f"mutate: {tally['caught']} caught, {tally['survived']} survived, {tally['unused']} in shaders that no golden holds, {tally['invalid']} that do not compile")


if __name__ == "__main__":
    main()
