"""Draws faults by seed: an operator on a place of a line. Settings and areas: drawn.toml."""
import random
import re
from fnmatch import fnmatch

# Lines that are no code of a function's body, or whose value the compiler needs.
NO_CODE = re.compile(r"constexpr|static|template|std::array<|using |namespace|enum|struct|class |case |default:|layout\(|precision|CHECK\("
                     r"|#|refuse|fail\(|warn\(|fmt::|push_back\(\"|operator|extern|\bshared (u?int|float)|readonly|^\s*(//|\{|\"|\d)")
FLOAT = re.compile(r"(?<![\w.\"])(\d+\.\d*(e-?\d+)?f?|\d+e-?\d+f?)(?![\w.])")
STEP = re.compile(r"(?<=\w [+-] )1u?(?![\w.])")
LOOP = re.compile(r"for \((?:const )?\w+ (\w+) = [^;]*; (\1 (<[^;]+));")
CONDITION = re.compile(r"^\s*(?:\} else )?if \((.*)\)( (?:return|continue|break|[\w.>-]+ (?:[-+*/]?=) ).*;| \{)?$")
DECLARED = re.compile(r"^\s*(?:const )?(?:double|float|glm::dvec[234]|vec[234]) \w+ = (.*);$")
ASSIGNED = re.compile(r"^\s*[\w.\[\]]+(?:->[\w.]+)? (?:[-+*/|&]?=) .*;$|^\s*\w+(?:\.\w+)+\(.*\);$")


def balanced(text):
    depth = 0
    for c in text:
        depth += (c in "([{") - (c in ")]}")
        if depth < 0:
            return False
    return depth == 0


def has_outer_comma(text):
    depth = 0
    for c in text:
        depth += (c in "([{") - (c in ")]}")
        if c == "," and depth == 0:
            return True
    return False


def operators(text, start, line, before, is_shader):
    """(operator, start, end, new text) of every place in a line that starts at `start`."""
    found = []
    condition = CONDITION.match(line)
    if condition and balanced(condition[1]) and " = " not in condition[1] and ";" not in condition[1]:
        found.append(("negate", start + condition.start(1), start + condition.end(1), f"!({condition[1]})"))
    declared = DECLARED.match(line)
    if declared and balanced(declared[1]) and not has_outer_comma(declared[1]) and "{" not in declared[1]:
        found.append(("negate", start + declared.start(1), start + declared.end(1), f"-({declared[1]})"))
        factor = "1.05f" if re.match(r"^\s*(?:const )?float", line) and not is_shader else "1.05"
        found.append(("scale", start + declared.start(1), start + declared.end(1), f"({declared[1]}) * {factor}"))
    for number in FLOAT.finditer(line):
        factor = "1.05f" if number[1].endswith("f") else "1.05"
        if float(number[1].rstrip("f")) != 0:
            found.append(("scale", start + number.start(1), start + number.end(1), f"({number[1]} * {factor})"))
    for one in STEP.finditer(line):
        found.append(("off by one", start + one.start(), start + one.end(), one[0].replace("1", "2")))
    loop = LOOP.search(line)
    if loop:
        step = "1u" if is_shader and "uint " in line else "1"
        found.append(("off by one", start + loop.start(2), start + loop.end(2), f"{loop[1]} + {step} {loop[3]}"))
    # A statement on a line of its own, after a line that ended one.
    if ASSIGNED.match(line) and balanced(line) and before.rstrip().endswith((";", "{", "}")):
        stripped = line.strip()
        at = start + line.index(stripped)
        found.append(("drop", at, at + len(stripped), ";"))
    return found


def candidates(name, text):
    is_shader = name.startswith("shaders/")
    found, start, before = [], 0, ""
    for line in text.split("\n"):
        if line.startswith("  ") and not NO_CODE.search(line) and "//" not in line:
            found += operators(text, start, line, before, is_shader)
        if line.strip():
            before = line.split("//")[0]
        start += len(line) + 1
    return found


def draw(root, settings, taken, text_of):
    """`taken`: places of other faults, by file; drawn ones keep off them, and off those that settings say are equivalent."""
    random_of = random.Random(settings["seed"])
    equivalent = {(e["file"], e["operator"], e["old"]) for e in settings.get("equivalent", [])}
    faults = []
    for area in settings["area"]:
        places = []
        for pattern in area["files"]:
            for path in sorted(root.glob(pattern)):
                name = path.relative_to(root).as_posix()
                if not any(fnmatch(name, other) for other in settings.get("without", [])):
                    places += [(name, *place) for place in candidates(name, text_of(name))]
        random_of.shuffle(places)
        drawn = []
        # As many of each operator as there can be.
        for operator in ["negate", "scale", "off by one", "drop"] * area["count"]:
            if len(drawn) == area["count"]:
                break
            for place in places:
                name, kind, start, end, new = place
                if kind != operator or any(start < b and a < end for a, b in taken.get(name, [])):
                    continue
                if (name, kind, text_of(name)[start:end]) in equivalent:
                    continue
                taken.setdefault(name, []).append((start, end))
                line = text_of(name)[:start].count("\n") + 1
                drawn.append({"name": f"drawn:{operator.replace(' ', '-')}:{name.rsplit('/')[-1]}:{line}:{start}",
                              "kind": "drawn", "operator": operator, "tests": area["tests"],
                              "edit": [{"file": name, "old": text_of(name)[start:end], "new": new, "at": [start, end],
                                        "line": line}]})
                break
        faults += drawn
    return faults
