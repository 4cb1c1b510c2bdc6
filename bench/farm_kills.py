#!/usr/bin/env python3
"""Kills workers of `candela farm shell`, make or Slurm at random moments, two at a time, in all ways that occur: the
script alone, the program alone, or the script with all that it started; with Slurm the program, or Slurm takes the task
away and starts it again. Of four films one has a worker whose clock is a day ahead, one a day behind (faketime), and
one a disk that is full until half of the kills are over (as root, on tmpfs). Then the same command is run until the film
is there, and its frames are compared with an undisturbed run. Exit 1 when frames are lost, half or different, when the
command alone does not complete a film, or when temporary files stay."""
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


def clock_library():
    found = sorted(pathlib.Path("/usr/lib").glob("*/faketime/libfaketimeMT.so.1"))
    if not found:
        sys.exit("libfaketimeMT.so.1 is not there (package faketime)")
    return str(found[0])


class Film:
    def __init__(self, options, environment):
        self.base = pathlib.Path(tempfile.mkdtemp(prefix="candela-kills-"))
        self.program, self.engine, self.environment = options.program, options.engine, environment
        self.words = [str(ROOT / "scenes/animated/animated.glb"), "--frames", f"0-{options.frames - 1}",
                      "--size", options.size, "--device", "cpu", "--quiet"]
        self.shards = str(options.shards)
        started = time.monotonic()
        subprocess.run([self.program, "sequence", *self.words, "-o", self.base / "plain/%04d.exr"], check=True)
        self.seconds = time.monotonic() - started
        self.plain = self.contents("plain")

    def contents(self, folder):
        to = self.base / folder
        return {path.name: path.read_bytes() for path in to.iterdir()} if to.exists() else {}

    def prepare(self, name):
        """The command that makes the film, run again to go on."""
        needs = ["--cpus", "1", "--memory-mb", "600"] if self.engine == "slurm" else []
        subprocess.run([self.program, "farm", self.engine, *self.words, "-o", f"{name}/%04d.exr", "--shards", self.shards,
                        "--job", f"{name}.farm", *needs], cwd=self.base, check=True, stdout=subprocess.DEVNULL)
        job = self.base / f"{name}.farm"
        return {"shell": ["sh", str(job / "job.sh")], "slurm": ["bash", str(job / "job.sbatch")],
                "make": ["make", "-j2", "-k", "-C", str(job), "-f", "job.mk"]}[self.engine]

    def start(self, command, clock=""):
        variables = dict(self.environment)
        if clock:  # without the program faketime, whose shared semaphore stays locked when its holder is killed
            variables.update(LD_PRELOAD=clock_library(), FAKETIME=clock, FAKETIME_DISABLE_SHM="1", DONT_FAKE_MONOTONIC="1")
        return subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                env=variables)

    def run(self, command):
        return subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, env=self.environment).returncode


class FullDisk:
    """A folder on a file system that is full until free() is called."""

    def __init__(self, folder, bytes_needed):
        folder.mkdir(exist_ok=True)
        self.folder = folder
        size = bytes_needed + (256 << 10)
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "candela-kills", folder], check=True)
        self.filler = folder / ".filler"
        with open(self.filler, "wb") as file:
            try:
                while True:
                    os.write(file.fileno(), bytes(4096))
            except OSError:
                os.ftruncate(file.fileno(), file.tell() - (64 << 10))  # for a frame or two

    def free(self):
        self.filler.unlink(missing_ok=True)

    def remove(self):
        subprocess.run(["umount", self.folder], check=True)


def slurm_jobs(film):
    shown = subprocess.run(["squeue", "-h", "-r", "-o", "%i"], env=film.environment, text=True, capture_output=True)
    return shown.stdout.split()


def kill_in_slurm(film, name, chance):
    """Kills a run of the program, or has Slurm take a task away and start it again. False where nothing runs."""
    if chance.randrange(3) == 0:
        running = subprocess.run(["squeue", "-h", "-r", "-t", "R", "-o", "%i"], env=film.environment, text=True,
                                 capture_output=True).stdout.split()
        return bool(running) and subprocess.run(["scontrol", "requeue", chance.choice(running)], env=film.environment,
                                                capture_output=True).returncode == 0
    mark, runs = f"{name}/%04d.exr".encode(), []
    for entry in pathlib.Path("/proc").iterdir():
        try:
            words = (entry / "cmdline").read_bytes().split(b"\0") if entry.name.isdigit() else []
        except OSError:
            continue
        if b"sequence" in words and mark in words:
            runs.append(int(entry.name))
    if not runs:
        return False
    try:
        os.kill(chance.choice(runs), signal.SIGKILL)
    except ProcessLookupError:
        return False
    return True


def film_with_kills(film, name, chance, kills, trouble):
    """One film; returns how often workers were killed, and what is wrong with it at the end."""
    command = film.prepare(name)
    disk = FullDisk(film.base / name, sum(map(len, film.plain.values()))) if trouble == "disk" else None
    clocks = ["", {"ahead": "+1d", "behind": "-1d"}.get(trouble, "")]
    try:
        killed = kill_workers(film, name, chance, kills, command, clocks, disk)
        if disk:
            disk.free()
        again = 0
        while film.run(command) != 0 or wait_for_slurm(film):
            again += 1
            if again == 3:
                return killed, {"not_completed": 1}
        there = film.contents(name)
    finally:
        if disk:
            disk.remove()
    if film.engine == "slurm" and film.run([film.program, "farm", "check", film.base / f"{name}.farm"]) != 0:
        return killed, {"not_completed": 1}
    temporary = [path for path in (film.base / f"{name}.farm").rglob(".*")]
    return killed, {"lost": len(set(film.plain) - set(there)),
                    "different_or_half": sum(there[name] != data for name, data in film.plain.items() if name in there),
                    "temporary_files_left": len(set(there) - set(film.plain)) + len(temporary)}


def wait_for_slurm(film):
    """Until its jobs have ended; False."""
    while film.engine == "slurm" and slurm_jobs(film):
        time.sleep(0.2)
    return False


def kill_workers(film, name, chance, kills, command, clocks, disk):
    clocks = clocks if film.engine == "shell" else clocks[1:]  # make and Slurm hold both workers
    workers, killed = [film.start(command, clock) for clock in clocks], 0
    last_kill = time.monotonic()
    while killed < kills:
        time.sleep(chance.uniform(0.0, 0.6 * film.seconds))
        at = chance.randrange(len(workers))
        if film.engine == "slurm":
            if workers[0].poll() is not None and not slurm_jobs(film):
                break
            hit = kill_in_slurm(film, name, chance)
        elif hit := workers[at].poll() is None:
            kill(workers[at], chance.choice(["script", "program", "all"]))
        if hit:
            killed, last_kill = killed + 1, time.monotonic()
            time.sleep(0.02)
        if disk and (killed > kills / 2 or time.monotonic() - last_kill > 10 * film.seconds):
            disk.free()
        for i, worker in enumerate(workers):
            if worker.poll() is not None and film.engine != "slurm":
                workers[i] = film.start(command, clocks[i])
        if set(film.plain) <= set(film.contents(name)):
            break
    if disk:
        disk.free()
    for worker in workers:
        worker.wait()
    wait_for_slurm(film)
    return killed


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default=str(ROOT / "build/release/candela"))
    parser.add_argument("--engine", choices=["shell", "make", "slurm"], default="shell")
    parser.add_argument("--kills", type=int, default=300)
    parser.add_argument("--kills-a-film", type=int, default=12)
    parser.add_argument("--frames", type=int, default=12)
    parser.add_argument("--shards", type=int, default=6)
    parser.add_argument("--size", default="64x36")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--troubles", default="none,ahead,behind,disk", help="what the films have in turn")
    options = parser.parse_args()
    if options.engine != "slurm":
        return run(options, dict(os.environ))
    sys.path.insert(0, str(ROOT / "tests/farm"))
    import cluster
    with tempfile.TemporaryDirectory(prefix="candela-slurm-") as folder, \
            cluster.Cluster(folder, ["n1", "n2"], array_size=100) as started:
        return run(options, started.environment)


def run(options, environment):
    chance = random.Random(options.seed)
    film = Film(options, environment)
    total = {"kills": 0, "films": 0, "not_completed": 0, "lost": 0, "different_or_half": 0, "temporary_files_left": 0}
    troubles = options.troubles.split(",")
    try:
        while total["kills"] < options.kills:
            name = f"film{total['films']}"
            trouble = troubles[total["films"] % len(troubles)]
            killed, wrong = film_with_kills(film, name, chance, min(options.kills_a_film, options.kills - total["kills"]),
                                            trouble)
            total["kills"] += killed
            total["films"] += 1
            for key, count in wrong.items():
                total[key] += count
            print(json.dumps({**total, "trouble": trouble}), file=sys.stderr, flush=True)
            if any(wrong.values()):
                shutil.move(film.base / f"{name}.farm", tempfile.mkdtemp(prefix="candela-kills-failed-"))
            shutil.rmtree(film.base / name, ignore_errors=True)
            shutil.rmtree(film.base / f"{name}.farm", ignore_errors=True)
    finally:
        shutil.rmtree(film.base, ignore_errors=True)
    print(json.dumps({"engine": options.engine, **total}))
    return any(total[key] for key in ("not_completed", "lost", "different_or_half", "temporary_files_left"))


if __name__ == "__main__":
    sys.exit(main())
