"""Runs every command of the tutorials: the ```sh blocks of a page in order, in one scratch folder. "```sh exit=1" says
that a block ends so."""
import pathlib
import tempfile
import unittest

from documents import TUTORIALS, blocks, link_program, shell


def expected_exit(words):
    for word in words:
        if word.startswith("exit="):
            return int(word[5:])
    return 0


class Tutorials(unittest.TestCase):
    def run_page(self, name, results):
        page = TUTORIALS / f"{name}.md"
        found = blocks(page, "sh")
        self.assertGreater(len(found), 3, f"{page} has no commands")
        with tempfile.TemporaryDirectory(prefix="candela-docs-") as scratch:
            programs = link_program(pathlib.Path(scratch) / "programs")
            folder = pathlib.Path(scratch) / "work"
            folder.mkdir()
            for line, words, text in found:
                ended = shell(text, folder, programs)
                self.assertEqual(ended.returncode, expected_exit(words),
                                 f"{page}:{line}:\n{text}\n{ended.stdout}\n{ended.stderr}")
            for result in results:
                self.assertGreater((folder / result).stat().st_size, 100, result)

    def test_frame_to_exr(self):
        self.run_page("frame-to-exr", ["frame.exr", "frame.png", "layers.exr"])

    def test_video(self):
        self.run_page("video", ["film.mp4", "frames/0011.png", "turn.mp4"])

    def test_many_lights(self):
        self.run_page("many-lights", ["lights/index.html", "lights/figures/02-time-of-a-frame.svg", "first.json",
                                      "second.json", "lists.png"])

    def test_image_diff_ci(self):
        self.run_page("image-diff-ci", ["out/junit.xml", "golden/CHANGES.md", "diff.html"])

    def test_time_gate_ci(self):
        self.run_page("time-gate-ci", ["baselines/here.json", "now.json"])

    def test_every_page_is_run(self):
        run = {name.removeprefix("test_").replace("_", "-") for name in dir(self) if name.startswith("test_")}
        self.assertEqual({page.stem for page in TUTORIALS.glob("*.md")}, run - {"every-page-is-run"})


if __name__ == "__main__":
    unittest.main()
