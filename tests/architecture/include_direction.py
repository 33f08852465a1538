#!/usr/bin/env python3
"""Holds the shape of the house: rooms.txt says which folder is which room and what each may include.

A source lies in a room's folder, declares that room's namespace, includes public headers of rooms that its own may include,
and private headers ("x.hpp") only from beside itself. CONTRIBUTING.md shows rooms.txt word by word.
"""
import pathlib
import re
import sys

SHIPPED = ("src", "data", "train", "predict", "include/elrom")


class House:
    def __init__(self, text):
        self.needs, self.room_of, self.libraries = {}, {}, []
        section = "rooms"
        for line in text.splitlines():
            if line.startswith("# library"):
                section = "libraries"
            if not line.strip() or line.startswith("#"):
                continue
            name, *rest = line.split("#")[0].split()
            if section == "libraries":
                self.libraries.append((name, rest[0], set(rest[1:])))
                continue
            folders = [word for word in rest if "/" in word]
            self.needs[name] = [word for word in rest if "/" not in word]
            for folder in folders:
                self.room_of[folder] = name
            if name != "programs":
                self.room_of[f"include/elrom/{name}"] = name

    def may_include(self, room):
        found, open_rooms = {room}, [room]
        while open_rooms:
            for need in self.needs[open_rooms.pop()]:
                if need not in self.needs:
                    raise SystemExit(f"rooms.txt: no room '{need}'")
                if need not in found:
                    found.add(need)
                    open_rooms.append(need)
        return found


def sources(root):
    for top in SHIPPED:
        for path in sorted((root / top).rglob("*")):
            if path.suffix in (".cpp", ".hpp", ".h", ".c"):
                yield path


def faults_of_line(house, room, allowed, path, line):
    if found := re.match(r'\s*#include\s*[<"]elrom/(\w+)/', line):
        if found[1] not in house.needs:
            yield f"includes '{found[1]}', which is no room"
        elif found[1] not in allowed:
            yield f"{room} includes {found[1]}, allowed are {', '.join(sorted(allowed))}"
    elif found := re.match(r'\s*#include\s*"([^"]+)"', line):
        if path.parts[-4:-2] == ("include", "elrom") or not (path.parent / found[1]).is_file():
            yield f'private include "{found[1]}" from outside its folder: make the header public, in include/elrom'
        elif ".." in found[1]:
            yield f'private include "{found[1]}" reaches into another folder'
    elif found := re.match(r"\s*#include\s*<([^>]+)>", line):
        for library, header, rooms in house.libraries:
            if found[1].startswith(header) and room not in rooms:
                yield f"{library} belongs into {', '.join(sorted(rooms))}"
    elif found := re.match(r"namespace elrom::(\w+)", line):
        if found[1] not in ({room} if path.suffix == ".cpp" else allowed):  # a header may declare another room's class
            yield f"namespace elrom::{found[1]} in the room {room}"


def faults(root, house):
    seen = 0
    for path in sources(root):
        seen += 1
        folder = path.parent.relative_to(root).as_posix()
        room = house.room_of.get(folder)
        if room is None:
            yield f"{path.relative_to(root)}: its folder is no room of tests/architecture/rooms.txt"
            continue
        allowed = house.may_include(room)
        for number, line in enumerate(path.read_text().splitlines(), 1):
            for fault in faults_of_line(house, room, allowed, path, line):
                yield f"{path.relative_to(root)}:{number}: {fault}"
    if seen < 20:
        yield f"only {seen} files found below {root}: wrong folder?"


def main(root, rooms):
    text = rooms.read_text()
    problems = list(faults(root, House(text)))
    page = root / "CONTRIBUTING.md"
    if page.is_file() and text not in page.read_text():
        problems.append("CONTRIBUTING.md does not show tests/architecture/rooms.txt as it is")
    print("\n".join(problems) or "include direction holds")
    return bool(problems)


if __name__ == "__main__":
    top = pathlib.Path(sys.argv[1])
    sys.exit(main(top, pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else pathlib.Path(__file__).parent / "rooms.txt"))
