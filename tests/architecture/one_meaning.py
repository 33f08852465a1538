#!/usr/bin/env python3
"""A type's name stands for one thing: no two rooms declare a type of the same name in their public headers.

Whoever reads `Part` or `Run` need not ask which. Types of a room's own sources are its own matter, and so are types inside
a class, which are read with the class's name.
"""
import pathlib
import re
import sys

# study's settings are those of networks and more, and every room that trains reads the part it needs.
SAME_THING = {"Settings"}


def faults(root):
    rooms = {}
    for path in sorted((root / "include" / "elrom").glob("*/*.hpp")):
        for line in path.read_text().splitlines():
            # A declaration that ends here (class X;) introduces nothing.
            if found := re.match(r"(?:class|struct|enum class) (\w+)(?: final)?(?: :.*)?(?: \{.*)?$|using (\w+) =", line):
                rooms.setdefault(found[1] or found[2], set()).add(path.parent.name)
    if len(rooms) < 50:
        yield f"only {len(rooms)} types found below {root}/include/elrom: wrong folder?"
    for name, places in sorted(rooms.items()):
        if len(places) > 1 and name not in SAME_THING:
            yield f"type '{name}' means something in each of {', '.join(sorted(places))}"


if __name__ == "__main__":
    problems = list(faults(pathlib.Path(sys.argv[1])))
    print("\n".join(problems) or "every name has one meaning")
    sys.exit(bool(problems))
