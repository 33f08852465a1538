#!/usr/bin/env python3
"""slips_name_the_nearest.py PROGRAM...: a mistyped command or option of any program is answered in one line that names it, with
the exit status of a wrong command line. Commands and options are those of --help, so that a new one is tested too: each command, and of its
options the first, one in the middle and the last, as one mechanism answers for all of them."""
import subprocess
import sys

from lists_take_one_word import commands, options, run


def slip(name):
    """Two letters in the wrong order, as fingers do; the last two where those are alike."""
    for i in reversed(range(len(name) - 1)):
        if name[i] != name[i + 1] and "-" not in name[i:i + 2]:
            return name[:i] + name[i + 1] + name[i] + name[i + 2:]
    return name + "s"


def fault(line, wanted):
    done = subprocess.run(line, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=60)
    right = done.returncode == 2 and done.stdout.count("\n") == 1 and f"did you mean {wanted}?" in done.stdout
    return None if right else f"{' '.join(line)}\n  status {done.returncode}: {done.stdout.strip()}"


def checks(program):
    for command in commands(program):
        if len(command) > 1:
            yield fault([program, slip(command[1])], f"'{command[1]}'")
        known = options(run(*command, "--help"))
        slips = [(slip(name), name) for name in known if name != "--help" and len(name) > 5]
        slips = [(wrong, name) for wrong, name in slips if wrong not in known]
        for wrong, name in {slips[i] for i in (0, len(slips) // 2, -1)} if slips else ():
            yield fault([*command, wrong, "x"], name)


def main(programs):
    found = [one for program in programs for one in checks(program)]
    faults = [one for one in found if one]
    print("\n".join(faults) or f"{len(found)} slips, each answered with the name that was meant")
    if len(found) < 60:
        print(f"only {len(found)} slips made: does --help look different?")
    return bool(faults) or len(found) < 60


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
