#!/usr/bin/env python3
"""candela farm slurm against a real Slurm: what goes wrong on farms, and all frames with the bytes of one plain sequence."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

import cluster
import common
from common import HOSTILE, SIZE, FolderTest, candela, contents, need, pattern, program, run, same, scene

# Stands for candela where something is to go wrong in the first run of a shard. What goes wrong is real: too little
# memory for the driver, no device, a run that hangs. $TROUBLE is a folder; TROUBLE/NAME.SHARD asks for trouble.
WRAPPER = r"""#!/bin/bash
trouble=@TROUBLE@
program=@PROGRAM@
if [[ ${1:-} != sequence ]]; then exec "$program" "$@"; fi
for ((i = 1; i <= $#; i++)); do
  if [[ ${!i} == --shard ]]; then at=$((i + 1)) shard=${!at%/*}; fi
done
printf '%s %s %s\n' "$shard" "$SLURMD_NODENAME" "$SLURM_MEM_PER_NODE" >>"$trouble/runs"
once() { mv "$trouble/$1.$shard" "$trouble/$1.$shard.had" 2>/dev/null; }
if once memory; then ulimit -v 150000; fi
if once device; then export VK_DRIVER_FILES=/nonexistent VK_ICD_FILENAMES=/nonexistent; fi
if once hang; then
  printf '%s\n' "$SLURMD_NODENAME" >"$trouble/hangs.tmp"
  mv "$trouble/hangs.tmp" "$trouble/hangs"
  until [[ -e $trouble/go ]]; do sleep 0.1; done
  "$program" "$@"
  printf '%s\n' "$?" >"$trouble/late.tmp"
  mv "$trouble/late.tmp" "$trouble/late"
  exit
fi
exec "$program" "$@"
"""


class Slurm(FolderTest):
    """One cluster for all; jobs of different tests run on it at the same time."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        (cls.base / "slurm").mkdir()
        # Longer lists than 4 need several arrays.
        cls.cluster = cluster.Cluster(cls.base / "slurm", ["n1", "n2", "n3"], array_size=4)
        cls.cluster.__enter__()
        cls.addClassCleanup(cls.cluster.__exit__)
        cls.scene = scene("animated")
        cls.plain = cls.base / "plain"
        candela("sequence", cls.scene, "--frames", "0-13", "--size", SIZE, "--device", "cpu", "--quiet",
                "-o", cls.plain / "%04d.exr")

    def wrapper(self, name):
        trouble = self.base / f"trouble-{name}"
        trouble.mkdir()
        program = trouble / "candela"
        program.write_text(WRAPPER.replace("@TROUBLE@", str(trouble)).replace("@PROGRAM@", common.program()))
        program.chmod(0o755)
        return trouble, program

    def submit(self, folder, *words):
        return candela("farm", "slurm", *words, "--size", SIZE, "--device", "cpu", "--cpus", "1", "--memory-mb", "600",
                       "--quiet", "--submit", cwd=folder, env=self.cluster.environment)

    def finish(self, what):
        cluster.wait_for(what, lambda: not self.cluster.jobs(), 240)

    def status(self, folder):
        ended = run([program(), "farm", "status", folder, "--json", "--whole"])
        status = json.loads(ended.stdout)
        self.assertEqual(0 if status["complete"] else 1, ended.returncode, ended.stderr)
        return status

    def logs(self, job):
        return "".join(f"== {path.name}\n{path.read_text(errors='replace')}" for path in sorted((job / "logs").iterdir()))

    def test_names_that_break_quoting_chunks_and_a_film(self):
        folder = self.base / HOSTILE
        folder.mkdir()
        shutil.copy(self.scene, folder / f"{HOSTILE}.glb")
        job, out = folder / f"{HOSTILE} job", f"{pattern(HOSTILE)} out"
        self.submit(folder, f"{HOSTILE}.glb", "--frames", "0-13", "-o", f"{out}/%04d.exr", "--video", f"{HOSTILE}.mp4",
                    "--job", job, "--shards", "7", "--slurm", "comment=it's $(touch pwned)")
        # The name of the scene, and what else a frame is made for, are in its header.
        candela("sequence", f"{HOSTILE}.glb", "--frames", "0-13", "--size", SIZE, "--device", "cpu", "--quiet",
                "-o", "plain/%04d.exr", "--video", "plain/film.mp4", cwd=folder)
        self.finish("a job with a hostile name")
        self.assertEqual([], [str(path) for path in self.base.rglob("pwned")])
        same(contents(folder / "plain", ".exr"), contents(folder / f"{HOSTILE} out"), self.logs(job))
        self.assertEqual((folder / "plain" / "film.mp4").read_bytes(), (folder / f"{HOSTILE}.mp4").read_bytes())
        status = self.status(job)
        self.assertTrue(status["complete"])
        self.assertEqual({"total": 7, "done": 7, "running": 0, "failed": 0, "waiting": 0}, status["shards"])

    def test_a_node_is_killed_memory_ends_and_a_device_is_missing(self):
        folder = self.base / "trouble"
        folder.mkdir()
        trouble, program = self.wrapper("nodes")
        for name in ("memory.2", "device.3", "hang.5", "memory.6", "device.6"):
            (trouble / name).touch()
        job = folder / "job"
        self.submit(folder, self.scene, "--frames", "0-13", "-o", "out/%04d.exr", "--job", job, "--shards", "7",
                    "--program", program)
        cluster.wait_for("the run that hangs", (trouble / "hangs").exists)
        node = (trouble / "hangs").read_text().strip()
        self.cluster.kill_daemon(node)  # its job goes to another node
        cluster.wait_for("the shard on another node", lambda: sum(
            line.startswith("5 ") for line in (trouble / "runs").read_text().splitlines()) > 1)
        (trouble / "go").touch()  # and the run that everybody took for dead writes the same frames
        self.finish("a job that loses a node")
        cluster.wait_for("the run on the lost node", (trouble / "late").exists)
        same(contents(self.plain, ".exr"), contents(folder / "out"), self.logs(job))
        runs = [line.split() for line in (trouble / "runs").read_text().splitlines()]
        of = lambda shard: [(where, int(memory)) for number, where, memory in runs if number == shard]
        self.assertEqual(1, len(of("1")))
        self.assertEqual([600, 1200], [memory for _, memory in of("2")], self.logs(job))
        self.assertEqual(2, len({where for where, _ in of("3")}), "a missing device is tried on another node")
        self.assertEqual([600, 600], [memory for _, memory in of("3")])
        self.assertGreaterEqual(len(of("5")), 2)
        self.assertTrue(self.status(job)["complete"])

    def test_a_full_disk(self):
        if os.geteuid() != 0:
            self.skipTest("only root can make a small file system")
        folder = self.base / "full"
        (folder / "out").mkdir(parents=True)
        if run(["mount", "-t", "tmpfs", "-o", "size=400k", "candela-farm", folder / "out"]).returncode != 0:
            self.skipTest("tmpfs cannot be mounted here")
        self.addCleanup(lambda: run(["umount", folder / "out"]))
        filler = folder / "out" / "filler"
        filler.write_bytes(b"x" * (368 << 10))
        job = folder / "job"
        self.submit(folder, self.scene, "--frames", "0-13", "-o", "out/%04d.exr", "--job", job, "--shards", "2")
        cluster.wait_for("the disk to be full", lambda: any(
            json.loads(path.read_text()).get("code") == 5 for path in (job / "records").glob("[0-9]*.json")))
        filler.unlink()
        self.finish("a job whose disk was full")
        same(contents(self.plain, ".exr"), contents(folder / "out"), self.logs(job))

    def test_paths_are_settings_of_the_job(self):
        """The folder, the program and the scene are elsewhere than where the job was written."""
        here, there = self.base / "here", self.base / "there"
        (here / "film").mkdir(parents=True)
        shutil.copy(self.scene, here / "scene.glb")
        candela("farm", "slurm", here / "scene.glb", "--frames", "0-3", "--size", SIZE, "--device", "cpu", "-o",
                "out/%04d.exr", "--shards", "2", "--job", "job", "--program", "/nowhere/candela", "--quiet",
                "--memory-mb", "600", "--cpus", "1", cwd=here / "film")
        here.rename(there)
        for name in ("by-place", "by-setting"):
            job = there / "film/job" / "job.sbatch"
            own = {"CANDELA_PROGRAM": program(), "CANDELA_SCENE": there / "scene.glb"}
            if name == "by-setting":  # where the host that submits sees another path than the nodes
                shutil.rmtree(there / "film/out")
                shutil.copy(job, self.base / "job.sbatch")
                job, own["CANDELA_FOLDER"] = self.base / "job.sbatch", there / "film/job"
            ended = run(["bash", job], env={**self.cluster.environment, **{key: str(own[key]) for key in own}})
            self.assertEqual(0, ended.returncode, ended.stderr)
            self.finish(name)
            self.assertTrue(self.status(there / "film/job")["complete"], self.logs(there / "film/job"))
            expected = {frame: data for frame, data in contents(self.plain, ".exr").items() if frame < "0004"}
            self.assertEqual(sorted(expected), sorted(contents(there / "film/out")))

    def test_what_ends_alike_everywhere_is_not_tried_again(self):
        folder = self.base / "never"
        folder.mkdir()
        shutil.copy(self.scene, folder / "scene.glb")
        trouble, program = self.wrapper("never")
        candela("farm", "slurm", "scene.glb", "--frames", "0-3", "--size", SIZE, "-o", "%d.exr", "--shards", "2",
                "--job", "job", "--program", program, "--quiet", "--memory-mb", "600", "--cpus", "1", cwd=folder)
        (folder / "scene.glb").write_bytes(b"no scene")
        ended = run(["bash", folder / "job" / "job.sbatch"], env=self.cluster.environment)
        self.assertEqual(0, ended.returncode, ended.stderr)
        self.finish("a job with a broken scene")
        self.assertEqual(["1", "2"], sorted(line.split()[0] for line in (trouble / "runs").read_text().splitlines()))
        status = self.status(folder / "job")
        self.assertEqual({"total": 4, "done": 0, "failed": 4, "missing": 0, "damaged": 0}, status["frames"])
        self.assertEqual([("never", 3)] * 2, [(one["remedy"], one["code"]) for one in status["failures"]])


if __name__ == "__main__":
    need([*cluster.PROGRAMS, "ffmpeg"])
    unittest.main()
