"""What the tests of documents share: where they lie, the program, fenced blocks of Markdown."""
import os
import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
TUTORIALS = ROOT / "docs/using/tutorials"


def program():
    return pathlib.Path(os.environ.get("TESTED_CANDELA", str(ROOT / "build/release/candela"))).resolve()


def documents():
    """Every page that people read, beside those of folders that are built."""
    return [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")), *sorted((ROOT / "src").glob("*.md")),
            *sorted((ROOT / "bench").glob("*.md")), *sorted((ROOT / "bench/results").glob("*.md"))]


def blocks(page, language):
    """(line, words after the language, text) of each fenced block of a language, in order."""
    found, begun, words, lines = [], 0, [], []
    for number, line in enumerate(page.read_text().splitlines(), 1):
        if begun and line.strip() == "```":
            if words[:1] == [language]:
                found.append((begun, words[1:], "\n".join(lines) + "\n"))
            begun = 0
        elif begun:
            lines.append(line)
        elif match := re.match(r"```(.*)$", line):
            begun, words, lines = number, match[1].split(), []
    assert not begun, f"{page}:{begun}: the block does not end"
    return found


def shell(text, folder, first_in_path):
    """Runs lines as bash -e does in `folder`, with the programs of a folder before others."""
    env = {name: value for name, value in os.environ.items() if not name.startswith("CANDELA_")}
    env["PATH"] = f"{first_in_path}:{env['PATH']}"
    if "CANDELA_CACHE_DIR" in os.environ:
        env["CANDELA_CACHE_DIR"] = os.environ["CANDELA_CACHE_DIR"]
    return subprocess.run(["bash", "-euo", "pipefail", "-c", text], cwd=folder, env=env, text=True, capture_output=True)


def link_program(folder):
    """A folder with `candela` in it, for PATH."""
    folder.mkdir()
    (folder / "candela").symlink_to(program())
    return folder
