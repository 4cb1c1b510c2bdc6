"""What the farm's tests share: the program, a folder with a name that breaks careless quoting, bytes of frames."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SIZE = "64x36"
# A blank, both quotes, what a shell, make and Slurm's names of files would replace, and a line that is not ASCII.
HOSTILE = """it's "a" $(touch pwned) `touch pwned` $HOME %A_%a \\n ü;&|<>*?!~{}[]"""


def pattern(name):
    """A name in -o, in which places for frame numbers begin with these signs."""
    return name.replace("%", "%%").replace("{", "{{").replace("}", "}}")


def program():
    return os.environ.get("TESTED_CANDELA", str(ROOT / "build/release/candela"))


def scene(name):
    return ROOT / "scenes" / name / f"{name}.glb"


def run(words, **more):
    """Runs to the end; the output as text."""
    return subprocess.run([str(word) for word in words], text=True, capture_output=True, **more)


def candela(*words, **more):
    ended = run([program(), *words], **more)
    if ended.returncode != 0:
        raise AssertionError(f"candela {' '.join(map(str, words))}: exit {ended.returncode}\n{ended.stdout}{ended.stderr}")
    return ended.stdout


def contents(folder, ending=""):
    """Bytes by name, of files alone."""
    return {path.name: path.read_bytes() for path in sorted(pathlib.Path(folder).iterdir())
            if path.is_file() and path.name.endswith(ending)}


def same(expected, found, what):
    """Names the first difference; the bytes would fill a screen."""
    if sorted(expected) != sorted(found):
        raise AssertionError(f"{what}: {sorted(expected)} expected, {sorted(found)} there")
    for name, data in expected.items():
        if data != found[name]:
            raise AssertionError(f"{what}: {name} differs from that of a plain sequence")


class FolderTest(unittest.TestCase):
    """Tests with a temporary folder, `base`, removed at the end."""

    @classmethod
    def setUpClass(cls):
        cls.base = pathlib.Path(tempfile.mkdtemp(prefix="candela-farm-"))
        cls.addClassCleanup(shutil.rmtree, cls.base, ignore_errors=True)


def need(programs):
    """Ends the test where programs are missing: as a failure, or as skipped where nothing may be installed."""
    missing = [name for name in programs if not find(name)]
    if not missing:
        return
    print(f"not there: {', '.join(missing)} (./run install)", file=sys.stderr)
    sys.exit(77 if os.environ.get("CANDELA_SKIP_INSTALL") else 1)


def find(name):
    return shutil.which(name, path=os.environ.get("PATH", "") + ":/usr/sbin:/sbin")
