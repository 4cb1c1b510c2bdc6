"""docs/using/commands is what the parser says, and links inside the repository lead somewhere."""
import pathlib
import re
import subprocess
import tempfile
import unittest

from documents import ROOT, blocks, documents, program


def made_pages(folder):
    subprocess.run([program(), "manual", "--docs", folder], check=True)
    return {path.name: path.read_text() for path in sorted(pathlib.Path(folder).iterdir())}


def anchors(page):
    """As GitHub makes them of headings."""
    names = re.findall(r"^#+ (.*)$", page.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", name.lower()).replace(" ", "-") for name in names}


class Pages(unittest.TestCase):
    def test_pages_of_commands_are_those_of_the_program(self):
        with tempfile.TemporaryDirectory(prefix="candela-docs-") as folder:
            made = made_pages(folder)
        kept = {path.name: path.read_text() for path in sorted((ROOT / "docs/using/commands").iterdir())}
        stale = sorted(name for name in made.keys() | kept.keys() if made.get(name) != kept.get(name))
        self.assertEqual(stale, [], "docs/using/commands is not what the program's options say: ./run docs writes it anew")

    def test_tables_of_curves_follow_from_the_kept_rows(self):
        subprocess.run(["python3", ROOT / "bench/curves.py", "check"], check=True)

    def test_a_page_names_every_option_of_help(self):
        """The pages are made of the same tree as man pages; help is CLI11's own."""
        pages = sorted((ROOT / "docs/using/commands").glob("candela-*.md"))
        self.assertGreaterEqual(len(pages), 20)
        for page in pages:
            words = re.search(r"^# (.*)$", page.read_text(), re.MULTILINE)[1].split()
            shown = subprocess.run([program(), *words[1:], "--help"], text=True, capture_output=True, check=True).stdout
            text = page.read_text()
            for option in re.findall(r"^  (?:-[a-zA-Z],)?(--[a-z-]+)", shown, re.MULTILINE):
                self.assertRegex(text, rf"(?m)^\| `[^`]*{option}[ `,]", f"{page.name} lacks {option}")

    def test_inputs_name_every_extension_that_is_read(self):
        text = (ROOT / "docs/using/inputs.md").read_text()
        table = (ROOT / "src/gltf/extensions.cpp").read_text()
        read = re.findall(r'\{"(\w+)", (?:supported|approximated),', table)
        self.assertGreater(len(read), 25)
        self.assertEqual([name for name in read if not re.search(rf"\b{name}\b", text)], [])

    def test_run_films_makes_every_film(self):
        rows = re.search(r"^films=\(\n(.*?)^\)", (ROOT / "run").read_text(), re.MULTILINE | re.DOTALL)[1]
        given = {name: float(seconds) for name, seconds, _ in re.findall(r'"(\S+) (\S+) (\S+)"', rows)}
        listed = subprocess.run([program(), "list", "scenes"], text=True, capture_output=True, check=True).stdout
        films = {name: float(seconds) for name, seconds in re.findall(r"^ *(\S+) .*?a film of (\d+) s", listed, re.MULTILINE)}
        self.assertEqual(given, films)

    def test_run_films_refuses_what_it_does_not_know(self):
        for words, said in ((["--film", "none"], "there are: city"), (["--seconds", "x"], "no number"),
                            (["--size"], "usage"), (["--sizes", "1x1"], "usage")):
            ended = subprocess.run([ROOT / "run", "films", *words], text=True, capture_output=True)
            self.assertEqual(ended.returncode, 2, words)
            self.assertIn(said, ended.stderr)

    def test_tests_beyond_the_gate_are_tests(self):
        sources = "".join(path.read_text() for path in (ROOT / "tests").rglob("*.cpp"))
        lines = [line for line in (ROOT / "tests/beyond_the_gate.txt").read_text().splitlines() if line[:1] != "#"]
        self.assertGreater(len(lines), 3)
        for line in lines:
            suite, name = line.split()[0].split(".")
            self.assertRegex(sources, rf"TEST(_F|_P)?\({suite}, {name}\)", line)
            self.assertGreaterEqual(len(line.split()), 3, f"{line}: says neither its seconds nor what else holds the same")

    def test_links_lead_to_files_and_headings(self):
        count = 0
        for page in documents():
            code = {line for begun, _, text in blocks(page, "sh") for line in
                    range(begun, begun + text.count("\n") + 1)}
            for number, line in enumerate(page.read_text().splitlines(), 1):
                if number in code:
                    continue
                for target in re.findall(r"\]\(([^)\s]+)\)|^\[\w+\]: (\S+)$", line):
                    target = target[0] or target[1]
                    if re.match(r"[a-z]+:", target):
                        continue
                    path, _, heading = target.partition("#")
                    place = (page.parent / path).resolve() if path else page
                    self.assertTrue(place.exists(), f"{page}:{number}: {target} does not exist")
                    self.assertTrue(place.is_relative_to(ROOT), f"{page}:{number}: {target} leaves the repository")
                    if heading:
                        self.assertIn(heading, anchors(place), f"{page}:{number}: {target}: no such heading")
                    count += 1
        self.assertGreater(count, 50)

    def test_lines_are_at_most_120_columns(self):
        """But rows of tables, which Markdown cannot break, commands, and pages that the program writes."""
        for page in documents():
            if page.parent.name == "commands":
                continue
            fenced = False
            for number, line in enumerate(page.read_text().splitlines(), 1):
                if line.lstrip().startswith("```"):
                    fenced = not fenced
                if not fenced and not line.startswith(("|", "    ")):
                    self.assertLessEqual(len(line), 120, f"{page}:{number}: wider than 120 columns (tests/docs/wrap.py FILE)")

    def test_readme_is_short(self):
        self.assertLessEqual(len((ROOT / "README.md").read_text().splitlines()), 130)

    def test_every_page_is_in_the_index(self):
        index = ROOT / "docs/README.md"
        linked = {(index.parent / target).resolve() for target in re.findall(r"\]\(([^)#\s]+)\)", index.read_text())}
        for page in documents():
            if page.parent.name != "commands" and page not in (ROOT / "README.md", index):
                self.assertIn(page.resolve(), linked, f"{page} is not in docs/README.md")

    def test_commands_in_pages_have_the_options_that_they_name(self):
        count = 0
        for page in documents():
            for number, line in enumerate(page.read_text().splitlines(), 1):
                named = re.match(r"(?:    )?candela ([a-z-]+)(?: ([a-z-]+))?( .*|)$", line)
                if not named or page.parent.name == "commands":
                    continue
                pages = [ROOT / f"docs/using/commands/candela-{name}.md" for name in
                         (f"{named[1]}-{named[2]}", named[1])]
                found = [path.read_text() for path in pages if path.exists()]
                self.assertTrue(found, f"{page}:{number}: no command {named[1]}")
                command = re.split(r"   +| #", line.strip())[0]
                for option in re.findall(r"(?<![\w-])--[a-z][a-z-]*", command):
                    self.assertRegex(found[0], rf"`[^`]*{option}[ `,]", f"{page}:{number}: no option {option}")
                    count += 1
        self.assertGreater(count, 150)

    def test_pages_named_in_text_exist(self):
        for page in documents():
            for number, line in enumerate(page.read_text().splitlines(), 1):
                for name in re.findall(r"\b((?:docs|src|bench|golden|tests)/[\w./-]+\.(?:md|json|py|sh))\b", line):
                    self.assertTrue((ROOT / name).exists() or "NAME" in name, f"{page}:{number}: {name} does not exist")


if __name__ == "__main__":
    unittest.main()
