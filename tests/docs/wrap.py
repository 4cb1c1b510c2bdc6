#!/usr/bin/env python3
"""Breaks the lines of pages at 120 columns: tests/docs/wrap.py FILE.md...

Paragraphs and items of lists are filled anew; headings, tables, fenced and indented code, pictures, comments and link
definitions stay as they are. Code spans and targets of links are not broken. No word changes."""
import pathlib
import re
import sys
import textwrap

WIDTH = 120
FIXED = re.compile(r"#|\||<|!\[|\[[\w-]+\]: ")
ITEM = re.compile(r"( *)([-*] |\d+\. )(.*)$")
# What Markdown would read as the begin of something else at the head of a line.
MARKER = re.compile(r"([-+*#>] |\d+[.)] |=+$|-+$|\|)")


def filled(text, first, rest):
    whole = re.sub(r"`[^`]*`", lambda span: span[0].replace(" ", "\0") if len(span[0]) < 100 else span[0], text)
    lines = textwrap.wrap(whole, WIDTH, initial_indent=first, subsequent_indent=rest, break_long_words=False,
                          break_on_hyphens=False)
    lines = [line.replace("\0", " ") for line in lines]
    for i in range(1, len(lines)):
        if MARKER.match(lines[i].lstrip()):
            lines[i - 1], _, last = lines[i - 1].rpartition(" ")
            lines[i] = f"{rest}{last} {lines[i].lstrip()}"
    return lines


def wrapped(lines):
    out, i = [], 0
    while i < len(lines):
        line = lines[i]
        i += 1
        if line.lstrip().startswith("```"):
            out.append(line)
            while i < len(lines) and lines[i].strip() != "```":
                out.append(lines[i])
                i += 1
            out += lines[i:i + 1]
            i += 1
            continue
        code = line.startswith("    ") and (not out or not out[-1].strip() or out[-1].startswith("    "))
        if not line.strip() or FIXED.match(line) or code:
            out.append(line)
            continue
        item = ITEM.match(line)
        indent = re.match(r" *", line)[0]
        first = item[1] + item[2] if item else indent
        rest = " " * len(first) if item else indent
        body = [item[3] if item else line.strip()]
        # Only an item of a numbered list is ended by any number; a paragraph is ended by 1 alone.
        numbers = r" *([-*] |\d+\. )" if item and item[2][0].isdigit() else r" *([-*] |1\. )"
        while (i < len(lines) and lines[i].strip() and not FIXED.match(lines[i].lstrip()) and
               not lines[i].lstrip().startswith("```") and not re.match(numbers, lines[i])):
            body.append(lines[i].strip())
            i += 1
        out += filled(" ".join(body), first, rest)
    return out


if __name__ == "__main__":
    for name in sys.argv[1:]:
        page = pathlib.Path(name)
        page.write_text("\n".join(wrapped(page.read_text().split("\n"))))
