#!/usr/bin/env python3
"""Kills workers of `candela farm shell` at random moments, two at a time, in all ways that occur: the script alone, the
program alone, or the script with all that it started. Then the same command is run until the film is there, and its
frames are compared with an undisturbed run. Exit 1 when frames are lost, half or different, when the command alone does
not complete a film, or when temporary files stay."""
import argparse
import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]


def children(process):
    """Numbers of all processes below that one."""
    try:
        text = pathlib.Path(f"/proc/{process}/task/{process}/children").read_text()
    except OSError:
        return []
    return [one for child in map(int, text.split()) for one in [child, *children(child)]]


def kill(worker, way):
    """way: script, program (whatever the script waits for) or all."""
    below = children(worker.pid)
    for process in {"script": [worker.pid], "program": below[:1], "all": [worker.pid, *below]}[way]:
        try:
            os.kill(process, signal.SIGKILL)
        except ProcessLookupError:
            pass


class Film:
    def __init__(self, program, frames, shards):
        self.base = pathlib.Path(tempfile.mkdtemp(prefix="candela-kills-"))
        self.program = program
        self.words = [str(ROOT / "scenes/animated/animated.glb"), "--frames", f"0-{frames - 1}", "--size", "64x36",
                      "--device", "cpu", "--quiet"]
        self.shards = str(shards)
        started = time.monotonic()
        subprocess.run([program, "sequence", *self.words, "-o", self.base / "plain/%04d.exr"], check=True)
        self.seconds = time.monotonic() - started
        self.plain = self.contents("plain")

    def contents(self, folder):
        to = self.base / folder
        return {path.name: path.read_bytes() for path in to.iterdir()} if to.exists() else {}

    def prepare(self, name):
        subprocess.run([self.program, "farm", "shell", *self.words, "-o", f"{name}/%04d.exr", "--shards", self.shards,
                        "--job", f"{name}.farm"], cwd=self.base, check=True, stdout=subprocess.DEVNULL)
        return ["sh", str(self.base / f"{name}.farm/job.sh")]

    def start(self, command):
        return subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def film_with_kills(film, name, chance, kills):
    """One film; returns how often workers were killed, and what is wrong with it at the end."""
    command = film.prepare(name)
    workers, killed = [film.start(command) for _ in range(2)], 0
    while killed < kills:
        time.sleep(chance.uniform(0.0, 0.6 * film.seconds))
        at = chance.randrange(2)
        if workers[at].poll() is None:
            kill(workers[at], chance.choice(["script", "program", "all"]))
            killed += 1
            time.sleep(0.02)
        for i in range(2):
            if workers[i].poll() is not None:
                workers[i] = film.start(command)
        if len(film.contents(name)) == len(film.plain):
            break
    for worker in workers:
        worker.wait()
    again = 0
    while subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True).returncode != 0:
        again += 1
        if again == 3:
            return killed, {"not_completed": 1}
    there = film.contents(name)
    temporary = [path for path in (film.base / f"{name}.farm").rglob(".*")]
    return killed, {"lost": len(set(film.plain) - set(there)),
                    "different_or_half": sum(there[name] != data for name, data in film.plain.items() if name in there),
                    "temporary_files_left": len(set(there) - set(film.plain)) + len(temporary)}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default=str(ROOT / "build/release/candela"))
    parser.add_argument("--kills", type=int, default=300)
    parser.add_argument("--kills-a-film", type=int, default=12)
    parser.add_argument("--frames", type=int, default=12)
    parser.add_argument("--shards", type=int, default=6)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    chance = random.Random(options.seed)
    film = Film(options.program, options.frames, options.shards)
    total = {"kills": 0, "films": 0, "not_completed": 0, "lost": 0, "different_or_half": 0, "temporary_files_left": 0}
    try:
        while total["kills"] < options.kills:
            name = f"film{total['films']}"
            killed, wrong = film_with_kills(film, name, chance, min(options.kills_a_film, options.kills - total["kills"]))
            total["kills"] += killed
            total["films"] += 1
            for key, count in wrong.items():
                total[key] += count
            print(json.dumps(total), file=sys.stderr, flush=True)
            shutil.rmtree(film.base / name, ignore_errors=True)
            shutil.rmtree(film.base / f"{name}.farm", ignore_errors=True)
    finally:
        shutil.rmtree(film.base, ignore_errors=True)
    print(json.dumps(total))
    sys.exit(any(total[key] for key in ("not_completed", "lost", "different_or_half", "temporary_files_left")))


if __name__ == "__main__":
    main()
