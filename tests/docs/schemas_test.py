"""Everything that the program writes as JSON fits its schema in docs/schemas, and each schema is used by a test here."""
import json
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import jsonschema

from documents import ROOT, program

SCHEMAS = ROOT / "docs/schemas"
SIZE = ["--size", "32x18"]
used = set()


def schema(name):
    used.add(name)
    return json.loads((SCHEMAS / f"{name}.schema.json").read_text())


def tightest(errors):
    """Of alternatives the one that nearly fits says what is wrong."""
    return jsonschema.exceptions.best_match(errors)


class Schemas(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="candela-schemas-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.run_program("make-scene", "animated", "--seed", "7", "--lights", "8", "-o", "plaza.glb")

    @classmethod
    def run_program(cls, *words, code=0):
        ended = subprocess.run([program(), *words], cwd=cls.folder, text=True, capture_output=True)
        assert ended.returncode == code, f"candela {' '.join(words)}: exit {ended.returncode}\n{ended.stderr}"
        return ended.stdout

    def read(self, name):
        return json.loads((self.folder / name).read_text())

    def fits(self, value, name):
        if isinstance(value, str):
            value = json.loads(value)
        error = tightest(jsonschema.Draft202012Validator(schema(name)).iter_errors(value))
        self.assertIsNone(error, error and f"{name}: /{'/'.join(map(str, error.absolute_path))}: {error.message[:400]}")
        return value

    def test_render(self):
        one = ["render", "plaza.glb", *SIZE, "--json"]
        self.fits(self.run_program(*one, "-o", "a.exr", "-o", "a.png", "--timings", "times.json", "--trace", "trace.json",
                                   "--dump", "resolve.resolved"), "render")
        self.fits(self.read("times.json"), "timings")
        self.fits(self.read("trace.json"), "trace")
        several = self.fits(self.run_program(*one, "--camera", "all", "-o", "{camera}.png"), "render")
        self.assertIn("pictures", several)
        same = self.fits(self.run_program("render", "plaza.glb", *SIZE, "--check-determinism", "2", "--json"), "render")
        self.assertTrue(same["deterministic"])

    def test_sequence(self):
        film = ["sequence", "plaza.glb", *SIZE, "--frames", "0-1"]
        self.fits(self.run_program(*film, "-o", "a/%04d.png", "--json", "--timings", "film.json", "--trace", "trace.json"),
                  "sequence")
        self.fits(self.read("film.json"), "timings")
        self.fits(self.read("trace.json"), "trace")
        self.fits(self.run_program(*film, "-o", "b/%04d.png", "--json", "--devices", "0"), "sequence")

    def log_of(self, *words, code=0):
        """Each line of stderr, which has nothing else."""
        ended = subprocess.run([program(), *words, "--log", "json"], cwd=self.folder, text=True, capture_output=True)
        self.assertEqual(ended.returncode, code, ended.stderr)
        self.assertTrue(ended.stderr.endswith("\n"))
        return [self.fits(line, "log") for line in ended.stderr.splitlines()]

    def test_log(self):
        lines = self.log_of("sequence", "plaza.glb", *SIZE, "--frames", "4-6", "-o", "log/%04d.png")
        progress = [line for line in lines if line["event"] == "progress"]
        self.assertEqual((progress[-1]["done"], progress[-1]["total"], progress[-1]["frame"]), (3, 3, 6))
        traced = self.log_of("reference", "plaza.glb", "--size", "64x36", "--spp", "64", "-o", "log.exr")
        self.assertEqual(traced[-1]["text"], "wrote log.exr")
        missing = self.log_of("render", "no-such.glb", "-o", "a.png", code=3)
        self.assertEqual([line["level"] for line in missing], ["error"])
        self.assertIn("no-such.glb", missing[0]["text"])
        usage = self.log_of("render", "plaza.glb", "--no-such", code=2)
        self.assertEqual({line["level"] for line in usage}, {"error"})

    def test_reference(self):
        self.fits(self.run_program("reference", "plaza.glb", *SIZE, "--spp", "2", "-o", "truth.exr", "--json"), "reference")
        self.fits(self.run_program("reference", "plaza.glb", *SIZE, "--spp", "1", "-o", "one.exr", "--json"), "reference")

    def test_watch(self):
        """One picture, and a second one after a look came beside the scene."""
        self.run_program("make-scene", "unlit-box", "-o", "watched.glb")
        words = ["watch", "watched.glb", *SIZE, "-o", "watched.png", "--json", "--quiet", "--pass-times", "--stop-after", "2"]
        with subprocess.Popen([program(), *words], cwd=self.folder, text=True, stdout=subprocess.PIPE) as watch:
            first = self.fits(watch.stdout.readline(), "watch")
            (self.folder / "watched.look.json").write_text('{"exposure": {"ev": 1}}')
            second = self.fits(watch.stdout.readline(), "watch")
            self.assertEqual(watch.wait(60), 0)
        self.assertEqual((first["picture"], first["why"], second["picture"]), (1, "opened", 2))
        self.assertIn("watched.look.json", second["why"])
        self.assertGreater(second["rmse"], 0)
        self.assertNotIn("rmse", first)

    def test_compare(self):
        for name, more in (("a", []), ("b", ["--exposure", "1"])):
            self.run_program("render", "plaza.glb", *SIZE, *more, "-o", f"{name}.png", "-o", f"{name}.exr", "--layers",
                             "depth,object_id")
        self.run_program("render", "plaza.glb", "--size", "16x9", "-o", "small.png")
        both = ["compare", "a.png", "b.png", "--json"]
        self.fits(self.run_program(*both), "compare")
        self.fits(self.run_program(*both, "--limit", "flip=0", "--region", "0,0,8,8", code=1), "compare")
        self.fits(self.run_program("compare", "a.exr", "b.exr", "--json", "--hdr-flip", "-1,1,3"), "compare")
        refused = self.fits(self.run_program("compare", "a.png", "small.png", "--json", code=1), "compare")
        self.assertIn("refusal", refused)

    def test_plan_and_facts(self):
        for more in ([], ["--quality", "draft", "--technique", "forward-plus"], ["--quality", "exact"],
                     ["--samples", "1", "--layers", "direct_point,depth"]):
            self.fits(self.run_program("plan", "plaza.glb", *SIZE, *more, "--json"), "plan")
        self.fits(self.run_program("facts", "plaza.glb", "--json"), "facts")

    def test_list(self):
        for what in ("devices", "techniques", "passes", "knobs", "layers", "scenes", "views"):
            self.fits(self.run_program("list", what, "--json"), "list")

    def test_bench(self):
        small = ["--size", "32x18", "--samples", "1", "--min-runs", "2", "--max-runs", "2"]
        for name in ("old", "new"):
            self.run_program("bench", "light-field", "--lights", "4,16", "--techniques", "clustered,brute-force",
                             *small, "--json", f"{name}.json")
            self.fits(self.read(f"{name}.json"), "bench")
        ended = subprocess.run([program(), "bench", "--compare", "old.json", "new.json", "--json", "change.json"],
                               cwd=self.folder, capture_output=True)
        self.assertIn(ended.returncode, (0, 1))  # times of two runs: either may be
        self.fits(self.read("change.json"), "bench-compare")

    def test_bench_error(self):
        self.run_program("bench", "unlit-box", "--size", "24x16", "--error", "--techniques", "brute-force", "--views", "2",
                         "--max-runs", "2", "--min-runs", "2", "--warm-up-s", "0.001", "--reference-spp", "1",
                         "--json", "error.json")
        rows = self.fits(self.read("error.json"), "bench")
        self.assertIn("error_findings", rows)

    def test_bench_suites(self):
        self.run_program("bench", "--suite", "exactness", "--count", "1", "--techniques", "clustered,brute-force", "--json",
                         "exact.json")
        self.fits(self.read("exact.json"), "bench-exactness")
        self.run_program("bench", "--suite", "stillness", "--only", "near-world", "--size", "16x9", "--quality", "draft",
                         "--reference-spp", "1", "--json", "still.json")
        self.fits(self.read("still.json"), "bench-stillness")
        self.run_program("bench", "--suite", "stability", "--only", "images/1x1,albedo above", "--techniques",
                         "clustered,visibility", "--quiet", "--json", "stable.json")
        self.fits(self.read("stable.json"), "bench-stability")

    def test_tune(self):
        self.fits(self.run_program("tune", "plaza.glb", *SIZE, "--seconds", "2", "--json"), "tune")

    def test_golden(self):
        goldens = self.folder / "goldens"
        (goldens / "scenes").mkdir(parents=True)
        shutil.copy(self.folder / "plaza.glb", goldens / "scenes/plaza.glb")
        root = ["--root", "goldens/golden"]
        self.run_program("golden", "add", "goldens/scenes/plaza.glb", *SIZE, *root, "--name", "plaza")
        manifest = self.read("goldens/golden/plaza/golden.json")
        self.fits(manifest, "golden")
        self.fits(self.run_program("golden", "check", *root, "--json"), "golden-check")
        manifest["job"]["exposure"] = 2
        manifest["gate"]["warn"] = {"flip_mean": 0.001}
        self.fits(manifest, "golden")
        (goldens / "golden/plaza/golden.json").write_text(json.dumps(manifest))
        self.fits(self.run_program("golden", "check", *root, "--json", code=1), "golden-check")
        for kept in sorted((ROOT / "golden").glob("*/golden.json")):
            self.fits(kept.read_text(), "golden")

    def test_farm(self):
        self.run_program("farm", "shell", "plaza.glb", *SIZE, "--frames", "0-1", "-o", "farm/%04d.png", "--shards", "2",
                         "--job", "film.farm")
        self.fits(self.run_program("farm", "status", "film.farm", "--json", code=1), "farm-status")

    def test_version(self):
        self.fits(self.run_program("--version", "--json"), "version")

    def test_look(self):
        for look in (ROOT / "bench/suites").glob("*.look.json"):
            self.fits(look.read_text(), "look")

    def test_zz_each_schema_is_used_and_is_a_schema(self):
        there = {path.name.removesuffix(".schema.json") for path in SCHEMAS.glob("*.schema.json")}
        for name in there:
            jsonschema.Draft202012Validator.check_schema(json.loads((SCHEMAS / f"{name}.schema.json").read_text()))
        if len(used) > 1:  # all tests ran
            self.assertEqual(there - used, set())


if __name__ == "__main__":
    unittest.main()
