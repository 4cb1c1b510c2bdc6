#!/usr/bin/env python3
"""candela farm make, shell and opencue, and farm status: names that break quoting, failures, several machines at once."""
import json
import os
import pathlib
import shlex
import shutil
import subprocess
import sys
import unittest

from common import HOSTILE, ROOT, SIZE, FolderTest, candela, contents, need, pattern, program, run, same, scene

# Fails in the first run of each shard that TROUBLE/CODE.SHARD names, with a record as candela leaves one.
WRAPPER = r"""#!/bin/bash
if [[ $1 != sequence ]]; then exec @PROGRAM@ "$@"; fi
for ((i = 1; i <= $#; i++)); do
  if [[ ${!i} == --shard ]]; then at=$((i + 1)) shard=${!at%/*}; fi
done
echo "$shard $*" >>@TROUBLE@/runs
if mv @TROUBLE@/6.$shard @TROUBLE@/had 2>/dev/null; then ulimit -v 150000; fi
if mv @TROUBLE@/9.$shard @TROUBLE@/had 2>/dev/null; then kill -9 $$; fi
exec @PROGRAM@ "$@"
"""

# Stands for OpenCue: what cuebot would get, and its frames run as rqd does, by a shell.
OUTLINE = r"""
import os, subprocess, sys
layers = []
class Outline:
    def __init__(self, name, **more): self.name, self.more = name, more
    def add_layer(self, layer): layers.append(layer)
class Layer:
    def __init__(self, name, command, range, chunk, **more):
        self.name, self.command, self.range, self.chunk, self.more, self.after = name, command, range, chunk, more, []
    def depend_all(self, other): self.after.append(other)
def launch(job, use_pycuerun, maxretries):
    assert not use_pycuerun
    for layer in layers:
        assert all(other in layers[:layers.index(layer)] for other in layer.after)
        first, last = map(int, layer.range.split('-'))
        for frame in range(first, last + 1):
            codes = []
            while len(codes) <= maxretries and 0 not in codes:
                codes.append(subprocess.call(' '.join(layer.command).replace('#IFRAME#', str(frame)), shell=True))
            print(job.name, layer.name, frame, *codes, layer.more)
"""


def check_schema(value, schema, at=""):
    """As much of JSON Schema as docs/schemas/farm-status.schema.json has."""
    kinds = {"object": dict, "array": list, "string": str, "integer": int, "boolean": bool, "null": type(None),
             "number": (int, float)}
    types = schema.get("type", [])
    types = [types] if isinstance(types, str) else types
    if types and not any(isinstance(value, kinds[kind]) and (kind == "boolean") == isinstance(value, bool) for kind in types):
        raise AssertionError(f"{at}: {value!r} is none of {types}")
    if "enum" in schema and value not in schema["enum"]:
        raise AssertionError(f"{at}: {value!r} is none of {schema['enum']}")
    if "minimum" in schema and value < schema["minimum"]:
        raise AssertionError(f"{at}: {value!r} is below {schema['minimum']}")
    for key in schema.get("required", []):
        if key not in value:
            raise AssertionError(f"{at}: {key} is missing")
    if "properties" in schema:
        for key, inner in value.items():
            if key not in schema["properties"]:
                raise AssertionError(f"{at}: {key} is not in the schema")
            check_schema(inner, schema["properties"][key], f"{at}/{key}")
    for i, inner in enumerate(value if "items" in schema else []):
        check_schema(inner, schema["items"], f"{at}/{i}")


class Engines(FolderTest):
    def prepare(self, engine, name, *words, trouble=()):
        """A scene in a folder of that name, the frames of a plain sequence, and the job."""
        folder = self.base / engine / name
        folder.mkdir(parents=True)
        shutil.copy(scene("animated"), folder / f"{name}.glb")
        film = ["--frames", "0-9", "--size", SIZE, "--device", "cpu", "--quiet"]
        candela("sequence", f"{name}.glb", *film, "-o", "plain/%04d.exr", "--video", "plain/film.mp4", cwd=folder)
        troubles = self.base / f"trouble-{engine}"
        troubles.mkdir()
        wrapper = troubles / "candela"
        wrapper.write_text(WRAPPER.replace("@PROGRAM@", shlex.quote(program())).replace("@TROUBLE@", str(troubles)))
        wrapper.chmod(0o755)
        for one in trouble:
            (troubles / one).touch()
        made = candela("farm", engine, f"{name}.glb", *film, "-o", f"{pattern(name)} out/%04d.exr",
                       "--video", "film.mp4", "--shards", "5", "--job", "job", "--program", wrapper, *words, cwd=folder)
        self.assertEqual(f"{folder}/job", os.path.dirname(made.rstrip("\n")))
        return folder, troubles

    def compare(self, folder, name):
        same(contents(folder / "plain", ".exr"), contents(folder / f"{name} out"), str(folder))
        self.assertEqual((folder / "plain/film.mp4").read_bytes(), (folder / "film.mp4").read_bytes())
        self.assertEqual([], [str(path) for path in self.base.rglob("pwned")])
        self.assertTrue(self.status(folder / "job")["complete"])

    def status(self, job):
        ended = run([program(), "farm", "status", job, "--json"])
        status = json.loads(ended.stdout)
        self.assertEqual(0 if status["complete"] else 1, ended.returncode, ended.stderr)
        check_schema(status, json.loads((ROOT / "docs/schemas/farm-status.schema.json").read_text()))
        return status

    def test_make(self):
        folder, troubles = self.prepare("make", HOSTILE, trouble=["6.2", "9.4"])
        make = ["make", "-j2", "-k", "-C", folder / "job", "-f", "job.mk"]
        self.assertNotEqual(0, run(make).returncode)
        status = self.status(folder / "job")
        self.assertEqual({"total": 10, "done": 6, "failed": 2, "missing": 2, "damaged": 0}, status["frames"])
        self.assertEqual([(2, 6, "again")], [(one["shard"], one["code"], one["remedy"]) for one in status["failures"]])
        ended = run(make)
        self.assertEqual(0, ended.returncode, ended.stderr)
        self.compare(folder, HOSTILE)
        self.assertEqual(7, len((troubles / "runs").read_text().splitlines()))

    def test_shell_on_several_machines(self):
        folder, troubles = self.prepare("shell", HOSTILE + "\nlines", trouble=["6.2"])
        words = ["sh", folder / "job" / "job.sh"]
        several = [subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) for _ in range(3)]
        errors = [one.communicate()[1] for one in several]
        self.assertIn(0, [one.returncode for one in several], errors)
        self.compare(folder, HOSTILE + "\nlines")
        runs = [line.split()[0] for line in (troubles / "runs").read_text().splitlines() if " sequence " in line]
        self.assertEqual(["1", "2", "2", "3", "4", "5"], sorted(runs), errors)
        self.assertEqual(0, run(words).returncode)  # nothing is left to do

    def small_job(self, name, *words):
        folder = self.base / name
        folder.mkdir()
        candela("farm", "shell", scene("animated"), "--frames", "0-5", "--size", SIZE, "--device", "cpu", "--quiet",
                "-o", "out/%d.exr", "--shards", "3", "--job", "job", *words, cwd=folder)
        return folder, ["sh", folder / "job" / "job.sh"]

    def test_shell_where_the_program_does_not_start(self):
        """Claims are given back, failures are on record, and the same command goes on once the program is there."""
        program_file = self.base / "later" / "candela"
        folder, words = self.small_job("absent", "--program", program_file)
        for _ in range(4):  # more than --rounds
            self.assertEqual(127, run(words).returncode)
        self.assertEqual([127], sorted({one["code"] for one in self.status(folder / "job")["failures"]}))
        program_file.parent.mkdir()
        program_file.write_text(f"#!/bin/sh\nexec {shlex.quote(program())} \"$@\"\n")
        program_file.chmod(0o755)
        bad = run(words, env={**os.environ, "CANDELA_SIZE": "no", "CANDELA_QUEUES": "many"})
        self.assertNotEqual(0, bad.returncode)
        ended = run(words)
        self.assertEqual(0, ended.returncode, ended.stderr)
        self.assertTrue(self.status(folder / "job")["complete"])

    def test_shell_takes_claims_of_the_dead(self):
        """At once where the process was of this machine, and of another machine when its claim stays as it is."""
        folder, words = self.small_job("dead")
        script = folder / "job" / "job.sh"
        script.write_text(script.read_text().replace("lost_s=120", "lost_s=1"))
        claims = folder / "job" / "claims"
        claims.mkdir()
        boot = pathlib.Path("/proc/sys/kernel/random/boot_id").read_text().strip() + "/" + os.readlink("/proc/self/ns/pid")
        (claims / "1.1").write_text(f"{os.uname().nodename}\n{boot}\n{os.getpid()}\n1\n.\n")  # another start
        (claims / "2.10").write_text("elsewhere\nboot/pid:[1]\n1\n1\n.\n")
        ended = run(words)
        self.assertEqual(0, ended.returncode, ended.stderr)
        self.assertIn("waiting 1 s", ended.stderr)
        self.assertEqual({"1.1", "1.2", "2.10", "2.11", "3.1"}, {path.name for path in claims.iterdir()})

    def test_farms_stay_on_the_gpu(self):
        """--strict and --device gpu: exit 4 without a GPU; --allow-cpu: not a word; else a warning, once."""
        devices = json.loads(candela("list", "devices", "--json"))
        if any(device["type"] != "cpu" for device in devices):
            self.skipTest("there is a GPU")
        folder = self.base / "stay"
        folder.mkdir()
        for i, (words, code, lines) in enumerate([((), None, 1), (("--strict",), 4, 0), (("--device", "gpu"), 4, 0),
                                                  (("--allow-cpu",), None, 0), (("--strict", "--allow-cpu"), None, 0)]):
            candela("farm", "shell", scene("animated"), "--frames", "0", "--size", SIZE, "--quiet", "-o", f"{i}/%d.png",
                    "--job", f"job{i}", *words, cwd=folder)
            ended = run(["sh", folder / f"job{i}/job.sh"])
            self.assertEqual(code is None, ended.returncode == 0, words)
            failures = self.status(folder / f"job{i}")["failures"]
            self.assertEqual([code] if code else [], [one["code"] for one in failures], words)
            log = (folder / f"job{i}/logs/shard-1.log").read_text()
            self.assertEqual(lines, log.count("no GPU that can be used was found"), words)

    def test_shell_survives_kills(self):
        ended = run([sys.executable, ROOT / "bench/farm_kills.py", "--program", program(), "--kills", "4", "--frames", "6",
                     "--shards", "3", "--troubles", "none"])
        self.assertEqual(0, ended.returncode, ended.stdout + ended.stderr)

    def test_opencue(self):
        name = HOSTILE.replace("#", "")
        folder, troubles = self.prepare("opencue", name, "--memory-mb", "700", "--cpus", "3", trouble=["6.2"])
        package = self.base / "python" / "outline"
        (package / "modules").mkdir(parents=True)
        (package / "__init__.py").write_text(OUTLINE)
        (package / "cuerun.py").write_text("from outline import launch\n")
        (package / "modules" / "__init__.py").write_text("")
        (package / "modules" / "shell.py").write_text("from outline import Layer as Shell\n")
        ended = run([sys.executable, folder / "job" / "job.py"], env={**os.environ, "PYTHONPATH": package.parent})
        self.assertEqual(0, ended.returncode, ended.stderr)
        self.assertNotIn(str(folder), (folder / "job/job.py").read_text().split("import getpass")[1])
        self.assertNotIn(str(folder), (folder / "job/task.sh").read_text())
        lines = [line.split(" ", 1)[1] for line in ended.stdout.splitlines()]
        needs = "{'threads': 3, 'memory': '700m'}"
        self.assertEqual([f"frames {i} {'33 0' if i == 2 else '0'} {needs}" for i in range(1, 6)] + ["check 1 0 {}"], lines)
        self.compare(folder, name)

    def mounted_elsewhere(self, engine, command):
        """No path of the machine that wrote the job is needed, and all frames and the film are there."""
        here, there = self.base / f"here-{engine}", self.base / f"there-{engine} $x"
        (here / "film").mkdir(parents=True)
        shutil.copy(scene("unlit-box"), here / "box.glb")
        film = ["--frames", "0-2", "--size", SIZE, "--device", "cpu", "--quiet"]
        candela("farm", engine, here / "box.glb", *film, "-o", "out/%d.exr", "--video", "film.mkv", "--video-codec",
                "ffv1", "--shards", "2", "--job", "job", "--program", "/nowhere/candela", cwd=here / "film")
        here.rename(there)
        own = {"CANDELA_PROGRAM": program(), "CANDELA_SCENE": str(there / "box.glb")}
        for left_out in own:
            self.assertNotEqual(0, run([*command, there / "film/job"], env={**os.environ, **own, left_out: ""}).returncode)
        ended = run([*command, there / "film/job"], env={**os.environ, **own})
        self.assertEqual(0, ended.returncode, ended.stderr)
        self.assertTrue(self.status(there / "film/job")["complete"])
        self.assertEqual(3, len(contents(there / "film/out", ".exr")))
        self.assertTrue((there / "film/film.mkv").is_file())
        return there / "film"

    def test_make_where_the_folder_is_mounted_elsewhere(self):
        self.mounted_elsewhere("make", ["make", "-k", "-f", "job.mk", "-C"])

    def test_shell_where_the_folder_is_mounted_elsewhere(self):
        there = self.mounted_elsewhere("shell", ["sh", "-c", 'exec sh "$0"/job.sh'])
        (there / "out/1.exr").write_bytes((there / "out/0.exr").read_bytes())  # a whole file, of another frame
        (there / "out/2.exr").unlink()
        ended = run([program(), "farm", "check", there / "job"])
        self.assertEqual(1, ended.returncode)
        self.assertIn("missing  2\n", ended.stderr)
        self.assertIn("damaged  1\n", ended.stderr)

    def test_a_folder_holds_one_job(self):
        folder = self.base / "one"
        folder.mkdir()
        words = ["farm", "make", scene("animated"), "--size", SIZE, "-o", "%d.png", "--job", "job", "--quiet"]
        candela(*words, "--frames", "0-3", cwd=folder)
        candela(*words, "--frames", "0-3", cwd=folder)
        other = run([program(), *words, "--frames", "0-4"], cwd=folder)
        self.assertEqual(2, other.returncode)
        self.assertIn("holds another job", other.stderr)
        self.assertEqual(2, run([program(), "farm", "status", folder]).returncode)
        for wrong in (["--shards", "5"], ["--frames", "5-2"], ["--metadata-timings"], ["--timings", "x.json"], ["--json"]):
            self.assertEqual(2, run([program(), *words, "--frames", "0-3", *wrong], cwd=folder).returncode, wrong)
        missing = run([program(), "farm", "check", "job"], cwd=folder)
        self.assertEqual((1, "again - 1 1\n"), (missing.returncode, missing.stdout))


if __name__ == "__main__":
    need(["make", "ffmpeg"])
    unittest.main()
