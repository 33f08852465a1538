#!/usr/bin/env python3
"""Each layer includes only what is left of it:
base -> {math, io} -> field -> model -> {ingest, study} -> {torch, mpi, report} -> programs."""
import pathlib
import re
import sys

ALLOWED = {
    "base": set(),
    "math": {"base"},
    "io": {"base", "math"},  # matrices are the currency of tensors and datasets
    "field": {"base", "math", "io"},
    "model": {"base", "math", "io", "field"},
    "ingest": {"base", "math", "io", "field", "model"},
    "study": {"base", "math", "io", "field", "model"},
    "torch": {"base", "math", "io", "field", "model", "study"},
    "mpi": {"base", "math", "io", "field", "model", "study"},
    "report": {"base", "math", "io", "field", "model", "study"},
}
# Source folder -> component; program folders at the end may use what their program links.
FOLDERS = {
    "src/base": "base", "src/math": "math", "src/io": "io", "src/field": "field", "src/model": "model",
    "data": "ingest", "train/study": "study", "train/torch": "torch", "train/mpi": "mpi", "train/report": "report",
}
FOLDERS |= {f"include/elrom/{name}": name for name in ALLOWED}
PROGRAMS = {"predict": {"base", "math", "io", "field", "model"}}


def faults(root: pathlib.Path):
    places = [(folder, ALLOWED[name] | {name}) for folder, name in FOLDERS.items()] + list(PROGRAMS.items())
    seen = 0
    for folder, allowed in places:
        for path in sorted((root / folder).glob("*.[ch]pp")):
            seen += 1
            for number, line in enumerate(path.read_text().splitlines(), 1):
                if found := re.match(r'\s*#include\s*[<"]elrom/(\w+)/', line):
                    if found.group(1) not in allowed:
                        yield f"{path.relative_to(root)}:{number}: includes {found.group(1)}, allowed are {sorted(allowed)}"
                if "torch/" in line and re.match(r"\s*#include\s*<(torch|ATen|c10)/", line) and folder != "train/torch":
                    yield f"{path.relative_to(root)}:{number}: LibTorch belongs into train/torch"
    if seen < 20:
        yield f"only {seen} files found below {root}: wrong folder?"


if __name__ == "__main__":
    problems = list(faults(pathlib.Path(sys.argv[1])))
    print("\n".join(problems) or "include direction holds")
    sys.exit(bool(problems))
