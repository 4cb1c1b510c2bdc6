#!/usr/bin/env python3
"""candela sequence --devices: several processes over one list of frames. Here each is on the same device."""
import json
import os
import pathlib
import signal
import subprocess
import time
import unittest

from common import SIZE, FolderTest, candela, contents, program, run, same, scene

FRAMES = 24


def workers_of(process):
    """Processes that it started and that are not over."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        try:
            if entry.name.isdigit():
                state, parent = (entry / "stat").read_text().rsplit(")", 1)[1].split()[:2]
                if int(parent) == process and state != "Z":
                    found.append(int(entry.name))
        except OSError:
            pass
    return found


class Devices(FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.words = ["sequence", scene("animated"), "--frames", f"0-{FRAMES - 1}", "--size", SIZE]
        candela(*cls.words, "--device", "cpu", "-o", cls.base / "plain" / "%04d.exr", "-o", cls.base / "plain" / "%04d.png")
        cls.plain = contents(cls.base / "plain")

    def several(self, name, *more):
        return [program(), *map(str, self.words), "-o", str(self.base / name / "%04d.exr"), "-o",
                str(self.base / name / "%04d.png"), *more]

    def start(self, words):
        return subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def until(self, what, process, happened):
        while not happened():
            self.assertIsNone(process.poll(), f"it ended before {what}")
            time.sleep(0.01)

    def frames(self, name):
        folder = self.base / name
        return [path for path in folder.iterdir() if not path.name.startswith(".")] if folder.exists() else []

    def test_the_same_bytes_by_several_processes(self):
        ended = run(self.several("several", "--devices", "0,cpu,0", "--json", "--record", self.base / "records"))
        self.assertEqual(0, ended.returncode, ended.stderr)
        result = json.loads(ended.stdout)
        self.assertEqual((["0", "cpu", "0"], FRAMES, 0), (result["devices"], result["rendered"], result["skipped"]))
        same(self.plain, contents(self.base / "several"), ended.stderr)
        records = [json.loads(path.read_text()) for path in (self.base / "records").iterdir()]
        self.assertEqual((3, FRAMES), (len(records), sum(record["rendered"] for record in records)))
        (self.base / "several" / "0007.png").unlink()
        again = run(self.several("several", "--devices", "all", "--resume", "--json"))
        self.assertEqual((1, FRAMES - 1), tuple(json.loads(again.stdout)[key] for key in ("rendered", "skipped")))
        same(self.plain, contents(self.base / "several"), again.stderr)

    def test_the_frames_of_a_process_that_dies_go_to_the_others(self):
        process = self.start(self.several("killed", "--devices", "0,0,0"))
        self.until("frames were there", process, lambda: len(self.frames("killed")) >= 4)
        os.kill(workers_of(process.pid)[0], signal.SIGKILL)
        errors = process.communicate()[1]
        self.assertEqual(0, process.returncode, errors)
        self.assertIn("ended with 137; its frames go to the others", errors)
        candela(*self.several("killed", "--device", "0", "--resume")[1:])  # removes what the killed one left
        same(self.plain, contents(self.base / "killed"), errors)

    def test_a_device_that_is_not_there(self):
        ended = run(self.several("absent", "--devices", "99,0"))
        self.assertEqual(0, ended.returncode, ended.stderr)
        same(self.plain, contents(self.base / "absent"), ended.stderr)
        ended = run(self.several("none", "--devices", "98,99"))
        self.assertEqual(4, ended.returncode, ended.stderr)
        self.assertIn(f"0 of {FRAMES} frames are there", ended.stderr)

    def test_an_interrupt_ends_all(self):
        process = self.start(self.several("interrupted", "--devices", "0,0"))
        self.until("a frame was there", process, lambda: self.frames("interrupted"))
        workers = workers_of(process.pid)
        process.send_signal(signal.SIGTERM)
        errors = process.communicate()[1]
        self.assertEqual(-signal.SIGTERM, process.returncode, errors)
        self.assertFalse([worker for worker in workers if pathlib.Path(f"/proc/{worker}").exists()])
        there = contents(self.base / "interrupted")
        self.assertFalse([name for name, data in there.items() if data != self.plain.get(name)])
        candela(*self.several("interrupted", "--devices", "0,0", "--resume")[1:])
        same(self.plain, contents(self.base / "interrupted"), errors)

    def test_what_it_does_not_go_with(self):
        for more in (["--device", "0"], ["--timings", "-"], ["--video", self.base / "film.mp4"]):
            ended = run(self.several("refused", "--devices", "0,0", *map(str, more)))
            self.assertEqual(2, ended.returncode, more)
        self.assertEqual(3, run([program(), "sequence", self.base / "no.glb", "--frames", "0-3", "-o",
                                 self.base / "%d.png", "--devices", "0,0"]).returncode)
        self.assertEqual(2, run(self.several("refused", "--worker", "0:0")).returncode)


if __name__ == "__main__":
    unittest.main()
