#!/usr/bin/env python3
"""lists_take_one_word.py PROGRAM...: an option that holds several values takes one word, so that the word behind it is the
program's next argument. Options are found by the dots that --help shows behind them, so that a new one is tested too."""
import pathlib
import re
import subprocess
import sys

WORDS = ["word_1_behind_the_option", "word_2_behind_the_option"]
# What a command wants to see before it looks at its files.
BEFORE = {"import": ["--mesh", str(pathlib.Path(__file__).parents[2] / "data/mesh/furnace_20x42x66.h5")]}
# What an option must hold for its command to go on.
VALUES = {"--accept": "unit"}


def run(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=60)
    return done.stdout


def commands(program):
    """The program's command lines: itself, and with each of its subcommands."""
    listed = run(program, "--help").partition("\nSubcommands:\n")[2].partition("\n\n")[0]
    names = re.findall(r"^  (\S+) ", listed, re.M)
    return [[program, name] for name in names] or [[program]]


def options(text):
    """Name -> what --help says of its type; an option's line begins with it, and may go on in the next."""
    listed = text.partition("\nOptions:\n")[2].partition("\n\n")[0]
    found = re.findall(r"^  (?:-\w,)?(--[\w-]+)([^\n]*)", listed, re.M)
    return {name: re.split(r"\s{2,}", rest.strip())[0] for name, rest in found}


def mistakes(command):
    known = options(run(*command, "--help"))
    for name, kind in known.items():
        if not kind.endswith("..."):
            continue
        needed = [part for other, its in known.items() if "REQUIRED" in its and other != name for part in (other, "x")]
        value = VALUES.get(name, "hdf")
        for given in ([name, value], [f"{name}={value}"]):
            line = [*command, *BEFORE.get(command[-1], []), *needed, *given, *WORDS]
            said = run(*line)
            # The first word is a file that is not there, or there is a word too many.
            right = WORDS[0] in said or WORDS[1] in said
            yield None if right else f"{' '.join(line)}\n  {said.strip()}"


def main(programs):
    faults, seen = [], 0
    for program in programs:
        for command in commands(program):
            for fault in mistakes(command):
                seen += 1
                faults += [fault] if fault else []
    print("\n".join(faults) or f"{seen} command lines, all as they should be")
    if seen < 14:
        print(f"only {seen} command lines found: does --help look different?")
    return bool(faults) or seen < 14


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
