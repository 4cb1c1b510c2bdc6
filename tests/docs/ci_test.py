"""The jobs of docs/using/goldens.md for GitHub Actions and GitLab CI, and the action and the template in packaging/ci: they are YAML of the shape that these read, and their
shell steps pass in a repository whose pictures are as they were, and end with exit 1 when one changed. Stand-ins take
the place of apt-get and of Debian's list of sources; candela is the one built here."""
import pathlib
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree

import yaml

from documents import ROOT, blocks, link_program, program, shell

# As the image debian:12 has it, without the mirror's name.
SOURCES = "Types: deb\nURIs: mirror\nSuites: bookworm bookworm-updates\nComponents: main\n"
# Fails as apt-get would: a package that is no file, a suite that is in no source, an option or a command that is unknown.
APT = """#!/usr/bin/env bash
set -euo pipefail
here=$(dirname -- "$(readlink -f -- "$0")")
command=$1
shift
case $command in
  update) exit 0 ;;
  install) ;;
  *) echo "apt-get: no command $command" >&2; exit 100 ;;
esac
while [[ $# -gt 0 ]]; do
  case $1 in
    -y | --no-install-recommends) ;;
    -t) shift; grep -qE "^Suites:.* $1( |\\$)" "$here/debian.sources" || { echo "apt-get: no suite $1" >&2; exit 100; } ;;
    ./*) [[ -f $1 ]] || { echo "apt-get: no file $1" >&2; exit 100; } ;;
    mesa-vulkan-drivers) ;;
    *) echo "apt-get: no package $1" >&2; exit 100 ;;
  esac
  printf '%s\\n' "$1" >>"$here/installed"
  shift
done
"""
# Debian's sed, on the copy of the list.
SED = """#!/usr/bin/env bash
here=$(dirname -- "$(readlink -f -- "$0")")
exec /bin/sed "${@/#\\/etc\\/apt\\/sources.list.d/$here}"
"""


def example(heading):
    page = ROOT / "docs/using/goldens.md"
    at = page.read_text().splitlines().index(f"## {heading}") + 1
    return yaml.safe_load(next(text for line, _, text in blocks(page, "yaml") if line > at))


class Examples(unittest.TestCase):
    def run_steps(self, steps):
        """Exits of the job before and after the scene changes. Each step is a shell of its own; the first that fails
        ends the job."""
        with tempfile.TemporaryDirectory(prefix="candela-ci-") as scratch:
            base = pathlib.Path(scratch)
            programs = link_program(base / "programs")
            for name, text in (("apt-get", APT), ("sed", SED)):
                (programs / name).write_text(text)
                (programs / name).chmod(0o755)
            (programs / "debian.sources").write_text(SOURCES)
            repository = base / "repository"
            (repository / "tools").mkdir(parents=True)
            (repository / "tools/candela_0.1.0_amd64.deb").write_text("")
            (repository / "scenes").mkdir()

            def make(seed):
                subprocess.run([program(), "make-scene", "animated", "--seed", str(seed), "-o", "scenes/plaza.glb"],
                               cwd=repository, check=True, capture_output=True)

            def job():
                (programs / "debian.sources").write_text(SOURCES)
                for step in steps:
                    ended = shell(step, repository, programs)
                    if ended.returncode != 0:
                        return step, ended
                return steps[-1], ended

            make(1)
            subprocess.run([program(), "golden", "add", "scenes/plaza.glb", "--size", "96x54", "--device", "cpu"],
                           cwd=repository, check=True, capture_output=True)
            step, ended = job()
            self.assertEqual(ended.returncode, 0, f"{step}\n{ended.stdout}{ended.stderr}")
            installed = (programs / "installed").read_text().split()
            self.assertIn("./tools/candela_0.1.0_amd64.deb", installed)
            self.assertIn("mesa-vulkan-drivers", installed)
            make(2)
            step, ended = job()
            self.assertEqual((ended.returncode, step), (1, steps[-1]), ended.stdout + ended.stderr)
            return {path.relative_to(repository).as_posix() for path in repository.rglob("*")}, \
                xml.etree.ElementTree.parse(repository / "out/junit.xml").getroot()

    def test_github_actions(self):
        job = example("GitHub Actions")
        self.assertIn("push", job[True])  # YAML 1.1 reads the key "on" so
        goldens = job["jobs"]["goldens"]
        self.assertEqual(goldens["container"], "debian:12")
        for step in goldens["steps"]:
            self.assertEqual(len({"run", "uses"} & step.keys()), 1, step)
            self.assertTrue(all(isinstance(value, (str, dict)) for value in step.values()), step)
        kept = goldens["steps"][-1]
        self.assertEqual(kept["if"], "always()")
        files, junit = self.run_steps([step["run"] for step in goldens["steps"] if "run" in step])
        self.assertIn(kept["with"]["path"] + "/index.html", files)
        self.assertEqual(junit.find("testsuite").get("failures"), "1")

    def test_gitlab_ci(self):
        goldens = example("GitLab CI")["goldens"]
        self.assertEqual(goldens["image"], "debian:12")
        self.assertTrue(all(isinstance(line, str) for line in goldens["script"]), goldens["script"])
        files, junit = self.run_steps(goldens["script"])
        self.assertEqual(goldens["artifacts"]["when"], "always")
        self.assertIn(goldens["artifacts"]["reports"]["junit"], files)
        for path in goldens["artifacts"]["paths"]:
            self.assertIn(path, files)
        self.assertEqual(len(junit.find("testsuite").findall("testcase")), 1)

    def same_steps(self, run, variables, example):
        """With variables filled in, but for the folder of the package: what is run in the tests of the examples."""
        for name, value in variables.items():
            run = [line.replace(f'"${name}"', value).replace(f"${name}", value) for line in run]
        self.assertEqual([line.replace("tools/candela/", "tools/") for line in run], example)

    def test_github_action(self):
        """A composite action, whose steps get inputs by variables of their own."""
        action = yaml.safe_load((ROOT / "packaging/ci/action.yml").read_text())
        self.assertEqual(action["runs"]["using"], "composite")
        self.assertTrue(action["name"] and action["description"])
        inputs = {f"${{{{ inputs.{name} }}}}": of["default"] for name, of in action["inputs"].items()}
        steps = action["runs"]["steps"]
        variables = {}
        for step in steps:
            self.assertEqual(len({"run", "uses"} & step.keys()), 1, step)
            self.assertEqual("run" in step, "shell" in step, "a composite action names the shell of each run")
            variables.update({name: inputs[value] for name, value in step.get("env", {}).items()})
        self.assertEqual((steps[-1]["if"], inputs[steps[-1]["with"]["path"]]), ("always()", variables["REPORT"]))
        self.same_steps([step["run"] for step in steps if "run" in step], variables,
                        [step["run"] for step in example("GitHub Actions")["jobs"]["goldens"]["steps"] if "run" in step])

    def test_gitlab_template(self):
        goldens = yaml.safe_load((ROOT / "packaging/ci/gitlab.yml").read_text())[".candela-goldens"]
        of_page = example("GitLab CI")["goldens"]
        self.same_steps(goldens["script"], goldens["variables"], of_page["script"])
        self.assertEqual((goldens["image"], goldens["artifacts"]), (of_page["image"], of_page["artifacts"]))


if __name__ == "__main__":
    unittest.main()
