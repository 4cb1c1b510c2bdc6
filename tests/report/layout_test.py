"""Every kind of page that the program writes, looked at in a browser at the width of a desk and of a telephone: no text overlaps
another, nothing is cut or wider than the page, every picture is there. Screenshots lie in report-pages/ of the build folder."""
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import time
import unittest

from browser import Browser

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
RESULTS = ROOT / "bench/results"
LAYOUT = (HERE / "layout.js").read_text()
WIDTHS = (1280, 390)
SHOTS = pathlib.Path("report-pages").absolute()
OPEN_ALL = "for (const d of document.querySelectorAll('details')) d.open = true; void 0"


class Pages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="candela-pages-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)
        SHOTS.mkdir(exist_ok=True)

    def run_program(self, *words, code=0):
        ended = subprocess.run([os.environ["TESTED_CANDELA"], *map(str, words)], cwd=self.folder, text=True, capture_output=True)
        self.assertEqual(ended.returncode, code, f"candela {words}\n{ended.stderr}")

    def look(self, page, name):
        """Without faults, folded and unfolded."""
        for width in WIDTHS:
            self.browser.open(self.folder / page, width)
            self.assertEqual(self.browser.evaluate(LAYOUT), [], f"{name} at {width}")
            self.browser.screenshot(SHOTS / f"{name}-{width}.png")
            self.browser.evaluate(OPEN_ALL)
            self.assertEqual(self.browser.evaluate(LAYOUT), [], f"{name} at {width}, all unfolded")

    def figures(self, report):
        """Those of a page are files beside it."""
        files = sorted(file.name for file in (self.folder / report / "figures").iterdir())
        self.browser.open(self.folder / report / "index.html", WIDTHS[0])
        shown = self.browser.evaluate("document.querySelectorAll('figure.plot img, figure.picture img').length")
        self.assertEqual(shown, len(files), files)
        return files

    def test_a_broken_page_has_faults(self):
        page = self.folder / "broken.html"
        svg = ("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 50' width='100' height='50'><text x='60' y='20'>"
               "outside of it</text><text x='5' y='40'>one</text><text x='8' y='42'>two</text></svg>")
        shown = subprocess.run(["base64", "-w0"], input=svg, text=True, capture_output=True, check=True).stdout
        broken = {
            '"above it" overlaps "below"': "<p>below</p><p style='margin-top:-2.2em'>above it</p>",
            "is cut": "<p style='overflow:hidden;white-space:nowrap;width:4em'>far too long for it</p>",
            "is beyond the page": "<p style='position:relative;left:-3em'>beyond</p>",
            "wide in a window": "<p style='width:3000px'>wide</p>",
            "is not there": "<img src='no-such.png' alt='absent'>",
            "has no words": f"<img src='data:image/svg+xml;base64,{shown}'>",
            '"outside of it" is cut': f"<img src='data:image/svg+xml;base64,{shown}' alt='figure'>",
            '"one" overlaps "two"': f"<img src='data:image/svg+xml;base64,{shown}' alt='figure'>",
        }
        for fault, body in broken.items():
            page.write_text(f"<!DOCTYPE html><body><p>A page.</p>{body}</body>")
            self.browser.open(page, WIDTHS[0])
            found = self.browser.evaluate(LAYOUT)
            self.assertTrue(any(fault in text for text in found), f"{fault}: {found}")
        page.write_text("<!DOCTYPE html><body><p>A page.</p><p style='overflow-x:auto;white-space:nowrap;width:4em'>it scrolls</p>")
        self.browser.open(page, WIDTHS[0])
        self.assertEqual(self.browser.evaluate(LAYOUT), [])

    def test_measurements(self):
        for name, files in {"lights": ["lavapipe/lights.json", "nvidia/lights.json"], "passes": ["nvidia/full-frame.json"],
                            "long-names": ["lavapipe/light-tests.json"]}.items():
            self.run_program("bench", "--from", *(RESULTS / file for file in files), "--report", name, "--quiet")
            self.look(f"{name}/index.html", name)
            self.figures(name)

    def test_fresh_measurements_have_pictures(self):
        self.run_program("bench", "light-field", "--lights", "4,16", "--size", "96x54", "--samples", "1", "--techniques",
                         "clustered,forward-plus,brute-force,deferred-tiled", "--min-runs", "6", "--max-runs", "6",
                         "--warm-up-s", "0.001", "--report", "bench", "--quiet")
        self.look("bench/index.html", "bench")
        files = self.figures("bench")
        self.assertEqual(files[0], "01-light-field.png")
        # Again from its rows: the picture was kept with them.
        self.run_program("bench", "--from", "bench/rows.json", "--report", "again", "--quiet")
        self.assertEqual((self.folder / "again/figures/01-light-field.png").read_bytes(),
                         (self.folder / "bench/figures/01-light-field.png").read_bytes())

    def test_errors_against_time(self):
        for name, file in {"errors": "lavapipe/error.json", "errors-cave": "nvidia/error-cave.json"}.items():
            self.run_program("bench", "--from", RESULTS / file, "--report", name, "--quiet")
            self.look(f"{name}/index.html", name)
            self.figures(name)
        self.run_program("bench", "unlit-box", "--size", "96x64", "--error", "--techniques", "brute-force", "--views", "2",
                         "--max-runs", "2", "--min-runs", "2", "--warm-up-s", "0.001", "--reference-spp", "1",
                         "--report", "errors-fresh", "--quiet")
        self.look("errors-fresh/index.html", "errors-fresh")
        self.assertIn("01-unlit-box.png", self.figures("errors-fresh"))

    def test_tune(self):
        self.run_program("make-scene", "animated", "--seed", "7", "--lights", "8", "-o", "plaza.glb")
        self.run_program("tune", "plaza.glb", "--size", "160x90", "--seconds", "10", "--report", "tune", "--quiet")
        self.look("tune/index.html", "tune")
        self.assertEqual(self.figures("tune"), ["01-plaza-glb.png", "02-error-against-time.svg"])
        self.assertIn("trials", json.loads((self.folder / "tune/tune.json").read_text()))

    def test_stability(self):
        self.run_program("bench", "--suite", "stability", "--only", "images/1x1,albedo above,fog/slab,NaN",
                         "--techniques", "clustered,visibility", "--report", "stability", "--quiet")
        self.look("stability/index.html", "stability")
        self.assertEqual(self.figures("stability"), ["01-pictures-of-extreme-scenes.svg"])
        self.assertEqual(json.loads((self.folder / "stability/stability.json").read_text())["faulty_rows"], 0)

    def test_goldens_and_their_viewer(self):
        (self.folder / "goldens/scenes").mkdir(parents=True)
        self.run_program("make-scene", "animated", "--seed", "7", "--lights", "8", "-o", "goldens/scenes/plaza.glb")
        root = ["--root", "goldens/golden"]
        for name in ("same", "changed"):
            self.run_program("golden", "add", "goldens/scenes/plaza.glb", "--size", "320x180", *root, "--name", name)
        manifest = self.folder / "goldens/golden/changed/golden.json"
        changed = json.loads(manifest.read_text())
        changed["job"]["exposure"] = 1
        manifest.write_text(json.dumps(changed))
        self.run_program("golden", "check", *root, "--report", "checked", "--quiet", code=1)
        self.look("checked/index.html", "golden")
        self.check_viewer("checked/index.html", "golden")

    def test_compare(self):
        self.run_program("make-scene", "unlit-box", "-o", "box.glb")
        for name, more in (("a", []), ("b", ["--exposure", "1"])):
            self.run_program("render", "box.glb", "--size", "320x180", *more, "-o", f"{name}.png", "--quiet")
        self.run_program("compare", "a.png", "b.png", "--limit", "flip=0.001", "--html", "compare.html", "--quiet", code=1)
        self.look("compare.html", "compare")
        self.check_viewer("compare.html", "compare")

    def check_viewer(self, page, name):
        browser = self.browser
        browser.open(self.folder / page, WIDTHS[0])
        self.assertTrue(browser.evaluate("/fails above|allowed/.test(document.body.innerText)"), "no limits")
        ramp = browser.evaluate("(e => [e.getBoundingClientRect().width, getComputedStyle(e).backgroundImage])"
                                "(document.querySelector('.bar .ramp'))")
        self.assertGreater(ramp[0], 100)
        self.assertIn("linear-gradient(to right, rgb(0, 0, 4)", ramp[1])

        browser.click("button[data-mode=slide]")
        place = browser.evaluate("(r => [r.left, r.top, r.width, r.height])"
                                 "(document.querySelector('.second img').getBoundingClientRect())")
        self.assertEqual(browser.evaluate("document.querySelector('.first img').getBoundingClientRect().left"), place[0])
        for part in (0.25, 0.75):  # pulled over the picture
            x, y = place[0] + part * place[2], place[1] + place[3] / 2
            browser.mouse("mousePressed", place[0] + 1, y, True)
            browser.mouse("mouseMoved", x, y, True)
            browser.mouse("mouseReleased", x, y, True)
            cut = browser.evaluate("getComputedStyle(document.querySelector('.second img')).clipPath")
            self.assertAlmostEqual(float(cut.split()[-1].rstrip("%)")), 100 * part, delta=1.5)
        self.assertEqual(browser.evaluate(LAYOUT), [])
        browser.screenshot(SHOTS / f"{name}-slider.png")

        browser.click("button[data-mode=blink]")
        seen = set()
        until = time.monotonic() + 10
        while len(seen) < 2 and time.monotonic() < until:
            seen.add(tuple(browser.evaluate("[getComputedStyle(document.querySelector('.second')).visibility,"
                                            " document.querySelector('.state').textContent]")))
        names = browser.evaluate("[...document.querySelectorAll('.first img, .second img')].map(i => i.alt).slice(0, 2)")
        self.assertEqual(seen, {("hidden", names[0]), ("visible", names[1])})

        for mode, only in [("heat", [False, False, True, False]), ("scaled", [False, False, False, True])]:
            browser.click(f"button[data-mode={mode}]")
            shown = browser.evaluate("[...document.querySelectorAll('.viewer figure')].map(f => f.checkVisibility())")
            self.assertEqual(shown, only)
            bars = browser.evaluate("[...document.querySelectorAll('.viewer .bar')].map(b => b.checkVisibility())")
            self.assertEqual(bars, only[2:])
        self.assertEqual(browser.evaluate("document.querySelectorAll('.worst img').length"), 3)
        browser.screenshot(SHOTS / f"{name}-difference.png")

        browser.click("button[data-mode=beside]")
        browser.click("button[data-zoom='4']")
        wide = browser.evaluate("[...document.querySelectorAll('.viewer img')].filter(i => i.checkVisibility())"
                                ".map(i => i.clientWidth / i.naturalWidth)")
        self.assertEqual(wide, [4, 4, 4])
        browser.evaluate("document.querySelector('.first .box').scrollLeft = 123; void 0")
        browser.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
        self.assertEqual(browser.evaluate("document.querySelector('.second .box').scrollLeft"), 123)
        self.assertEqual(browser.evaluate(LAYOUT), [])
        browser.screenshot(SHOTS / f"{name}-zoom.png")


if __name__ == "__main__":
    unittest.main()
