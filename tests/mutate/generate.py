#!/usr/bin/env python3
"""generate.py ROOT OUT [SHADER-FAULTS]: makes, from faults.toml and drawn.toml, what the build with faults needs.
With a file of by_goldens.py the faults that no golden caught stand beside them, with the tests of shader_tests.toml.

OUT/src/...              copies of the C++ sources that hold faults, each faulty place a choice at run time
OUT/include/...          the same for headers, named as they are included
OUT/active_fault.cpp     the variable that the copies ask, set from CANDELA_FAULT before main
OUT/shader_faults.cpp    faults of shaders, applied to the embedded text
OUT/faults.json          every fault with its tests, for mutate.py
OUT/inputs.txt           the files that were read
"""
import json
import re
import sys
import tomllib
from fnmatch import fnmatch
from pathlib import Path

sys.dont_write_bytecode = True
import draw  # noqa: E402

HERE = Path(__file__).resolve().parent


LONE_ASSIGNMENT = re.compile(r"(?<![=!<>+*/%&|^\[-])=(?!=)")


class Wrong(Exception):
    pass


def whole(code):
    """Whether the C++ text may be statements, or an expression: no part of one and no declaration's `name = value`."""
    if not draw.balanced(code):
        return False
    code = code.strip()
    if code.startswith("{") or re.match(r"(if|for|while|switch)\b", code) and not code.endswith((";", "}")):
        return False
    if code.endswith(";"):
        return not re.match(r"(const|static|auto|bool|int|float|double|uint32_t|size_t)\b", code)
    return not re.match(r"[?:,]|.*[?:,]$", code, re.DOTALL) and not LONE_ASSIGNMENT.search(code)


def place_of(text, fault, edit):
    """Where the old text stands: (start, end). `within` is a longer text that stands once in the file and holds `old` once."""
    old, within = edit["old"], edit.get("within", edit["old"])
    if text.count(within) != 1:
        raise Wrong(f"{fault['name']}: {edit['file']} holds this {text.count(within)} times, not once: {within}")
    if within.count(old) != 1:
        raise Wrong(f"{fault['name']}: 'within' holds this {within.count(old)} times, not once: {old}")
    start = text.index(within) + within.index(old)
    if edit["file"].startswith("src/"):
        begins = re.search(r"([;{})]|\belse|//.*)\s*$", text[:start])
        if not (whole(old) and whole(edit["new"])) or old.rstrip().endswith(";") and not begins:
            raise Wrong(f"{fault['name']}: neither an expression nor whole statements: {old}")
        if re.search(r"^\s*(static |inline )*constexpr ", text[text.rfind("\n", 0, start) + 1:start + len(old)]):
            raise Wrong(f"{fault['name']}: the compiler must know this, so it is no choice at run time: {old}")
    return start, start + len(old)


def choice(edits, old):
    """C++ that is `old`, or the new text of the fault that is active."""
    if old.rstrip().endswith(";"):
        code = "{ " + old + " }"
        for number, edit in edits:
            code = f"if (candela_active_fault == {number}) {{ {edit['new']} }} else {code}"
        return "{ " + code + " }"
    # A negated condition may be a pointer.
    negated = any(edit["new"] == f"!({old})" for _, edit in edits)
    code = f"bool({old})" if negated else f"({old})"
    for number, edit in edits:
        code = f"(candela_active_fault == {number} ? ({edit['new']}) : {code})"
    return code


def with_choices(name, text, edits):
    """The text of a C++ file with all its faults; edits: (number of the fault, edit with its place 'at')."""
    places = {}
    for number, edit in edits:
        places.setdefault(tuple(edit["at"]), []).append((number, edit))
    result, end = [], 0
    for (start, stop), here in sorted(places.items()):
        if start < end:
            raise Wrong(f"fault {here[0][0]} in {name}: its place overlaps another's; give both the same old text")
        result += [text[end:start], choice(here, text[start:stop])]
        end = stop
    return f'extern "C" int candela_active_fault;\n#line 1 "{name}"\n' + "".join(result) + text[end:]


def c_string(text):
    out = []
    for c in text:
        if c in '"\\':
            out.append("\\" + c)
        elif c == "\n":
            out.append("\\n")
        else:
            out.append(c)
    return '"' + "".join(out) + '"'


ACTIVE_FAULT = """// Which fault is active: its number, 0 for none.
#include <cstdio>
#include <cstdlib>
#include <cstring>
static int number_of(const char* name) {
  if (!name || !*name) return 0;
  static constexpr struct { const char* name; int number; } faults[] = {
%s  };
  for (const auto& fault : faults)
    if (std::strcmp(fault.name, name) == 0) return fault.number;
  std::fprintf(stderr, "CANDELA_FAULT names no fault of this build: %%s\\n", name);
  std::exit(2);
}
extern "C" int candela_active_fault;
int candela_active_fault = 0;
struct Choice {
  Choice() { candela_active_fault = number_of(std::getenv("CANDELA_FAULT")); }
};
// Before all other objects, whose constructors may hold faults.
__attribute__((init_priority(101))) static Choice choice;
"""

SHADER_FAULTS = """// The embedded shaders, with the active fault in its file's text.
#include <list>
#include <string>
#include <vector>

#include "glsl/shader_sources.h"
extern "C" int candela_active_fault;
namespace candela::glsl {
std::span<const EmbeddedShader> embedded_shaders_without_faults();
std::span<const EmbeddedShader> embedded_shaders() {
  struct Fault { int number; const char* file; size_t start, length; const char* text; };
  static constexpr Fault faults[] = {
%s    {0, "", 0, 0, ""}};
  static const std::vector<EmbeddedShader> table = [] {
    const auto all = embedded_shaders_without_faults();
    std::vector<EmbeddedShader> result(all.begin(), all.end());
    for (const Fault& fault : faults)
      if (fault.number && fault.number == candela_active_fault)
        for (EmbeddedShader& shader : result)
          if (shader.name == fault.file) {
            static std::list<std::string> texts;  // live as long as the table
            shader.text = texts.emplace_back(std::string(shader.text).replace(fault.start, fault.length, fault.text));
          }
    return result;
  }();
  return table;
}
}  // namespace candela::glsl
"""


def write(path, text):
    """Only what changed, so that nothing else is compiled again."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text() != text:
        path.write_text(text)


def missed_by_goldens(file, text_of):
    """The faults of by_goldens.py's file that no golden caught."""
    rows = tomllib.loads((HERE / "shader_tests.toml").read_text())["shaders"]
    faults = []
    for fault in json.loads(file.read_text())["faults"]:
        if fault["verdict"] not in ("survived", "unused"):
            continue
        name, (start, end) = fault["file"], fault["at"]
        if text_of(name)[start:end] != fault["old"]:
            raise Wrong(f"{file}: {name} has changed since these faults were drawn")
        tests = next(row["tests"] for row in rows if any(fnmatch(name.removeprefix("shaders/"), pattern) for pattern in row["files"]))
        faults.append({"name": f"shader:{fault['operator'].replace(' ', '-')}:{name.rsplit('/')[-1]}:{fault['line']}:{start}", "kind": "shader",
                       "operator": fault["operator"], "tests": tests,
                       "edit": [{"file": name, "old": fault["old"], "new": fault["new"], "at": [start, end], "line": fault["line"]}]})
    return faults


def main(root, out, shader_faults=None):
    table = tomllib.loads((HERE / "faults.toml").read_text())["fault"]
    drawn_settings = tomllib.loads((HERE / "drawn.toml").read_text())
    names = [fault["name"] for fault in table]
    for name in sorted(set(names)):
        if names.count(name) > 1:
            raise Wrong(f"two faults are named {name}")
    texts, inputs = {}, [HERE / "faults.toml", HERE / "drawn.toml"]

    def text_of(name):
        if name not in texts:
            if not (root / name).is_file():
                raise Wrong(f"there is no file {name}")
            texts[name] = (root / name).read_text()
            inputs.append(root / name)
        return texts[name]

    taken, wrong = {}, []
    for fault in table:
        fault["kind"] = "written"
        if "edit" not in fault:
            fault["edit"] = [{key: fault.pop(key) for key in ("file", "within", "old", "new") if key in fault}]
        for edit in fault["edit"]:
            try:
                edit["at"] = list(place_of(text_of(edit["file"]), fault, edit))
            except Wrong as w:
                wrong.append(str(w))
                continue
            edit["line"] = text_of(edit["file"])[:edit["at"][0]].count("\n") + 1
            taken.setdefault(edit["file"], []).append(tuple(edit["at"]))
    for place in drawn_settings.get("equivalent", []):
        if place["old"] not in text_of(place["file"]):
            wrong.append(f"drawn.toml says that this is equivalent, but {place['file']} does not hold it: {place['old']}")
    if wrong:
        raise Wrong("\n".join(wrong))
    faults = table + draw.draw(root, drawn_settings, taken, text_of)
    if shader_faults:
        faults += missed_by_goldens(shader_faults, text_of)
    by_file = {}
    for number, fault in enumerate(faults, 1):
        fault["id"] = number
        for edit in fault["edit"]:
            by_file.setdefault(edit["file"], []).append((number, edit))

    made = set()
    shader_rows = ""
    for name, here in sorted(by_file.items()):
        if name.startswith("shaders/"):
            for number, edit in here:
                start, stop = edit["at"]
                # Positions in the program are of bytes.
                before = len(text_of(name)[:start].encode())
                length = len(text_of(name)[start:stop].encode())
                shader_rows += (f"    {{{number}, {c_string(name.removeprefix('shaders/'))}, {before}, {length}, "
                                f"{c_string(edit['new'])}}},\n")
        else:
            below = "include/" + name.removeprefix("src/") if name.endswith(".h") else name
            write(out / below, with_choices(name, text_of(name), here))
            made.add(out / below)
    for folder in ("src", "include"):
        for old in (out / folder).rglob("*"):
            if old.is_file() and old not in made:
                old.unlink()
    write(out / "active_fault.cpp", ACTIVE_FAULT % "".join(f'    {{"{f["name"]}", {f["id"]}}},\n' for f in faults))
    write(out / "shader_faults.cpp", SHADER_FAULTS % shader_rows)
    write(out / "faults.json", json.dumps(faults, indent=1) + "\n")
    write(out / "inputs.txt", "".join(f"{path}\n" for path in sorted(inputs)))


if __name__ == "__main__":
    try:
        main(Path(sys.argv[1]), Path(sys.argv[2]), Path(sys.argv[3]) if len(sys.argv) > 3 else None)
    except Wrong as wrong:
        sys.exit(f"tests/mutate/faults.toml: {wrong}")
