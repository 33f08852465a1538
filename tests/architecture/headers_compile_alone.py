"""Every public header compiles alone, twice in a row, whatever a source included before it.

    headers_compile_alone.py COMPILER INCLUDE_DIR WORK_DIR [FLAG ...]

Parsing Eigen and the standard library is most of the cost. A header that includes all of a few of these itself, or through
other headers of ours, gets them precompiled: it would parse the same. Nothing else stands before it. What passed is kept in
WORK_DIR by the digest of all that it reads of ours, and is not compiled again."""
import concurrent.futures
import hashlib
import os
import pathlib
import re
import subprocess
import sys

PRECOMPILED = (("Eigen/Core", "filesystem", "string", "vector"), ("Eigen/Core",), ("filesystem", "string", "vector"), ("string", "vector"))
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.M)


def closure(header, root, seen):
    """All headers of ours that `header` reads, and the names of the others."""
    others = set()
    if header in seen:
        return others
    seen.add(header)
    for name in INCLUDE.findall((root / header).read_text()):
        if (root / name).exists():
            others |= closure(name, root, seen)
        else:
            others.add(name)
    return others


def compile_alone(compiler, flags, header, digest, kept, precompiled):
    if kept.exists() and kept.read_text() == digest:
        return None
    text = f'#include "{header}"\n#include "{header}"\n'
    before = ["-include", str(precompiled)] if precompiled else []
    done = subprocess.run([compiler, *flags, *before, "-x", "c++", "-fsyntax-only", "-"], input=text, text=True,
                          capture_output=True)
    if done.returncode != 0 or done.stderr:
        return done.stderr
    kept.write_text(digest)
    return None


def precompile(compiler, flags, names, work):
    header = work / (re.sub(r"\W", "_", "_".join(names)) + ".hpp")
    header.write_text("".join(f"#include <{name}>\n" for name in names))
    subprocess.run([compiler, *flags, "-x", "c++-header", str(header), "-o", str(header) + ".gch"], check=True)
    return header


def main():
    compiler, root, work = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    flags = ["-std=c++20", "-Wall", "-Wextra", "-Wpedantic", "-Wshadow", f"-I{root}"]
    flags += [flag for flag in sys.argv[4:] if flag not in ("", "-isystem/usr/include")]  # that one breaks #include_next
    work.mkdir(parents=True, exist_ok=True)
    precompiled = {names: precompile(compiler, flags, names, work) for names in PRECOMPILED}
    jobs = []
    with concurrent.futures.ThreadPoolExecutor(max(1, (os.cpu_count() or 1) // 2)) as pool:
        for path in sorted(root.rglob("*.hpp")):
            header, seen = str(path.relative_to(root)), set()
            others = closure(header, root, seen)
            before = next((precompiled[names] for names in PRECOMPILED if others.issuperset(names)), None)
            content = "".join((root / name).read_text() for name in sorted(seen)) + " ".join([compiler, *flags])
            digest = hashlib.sha256(content.encode()).hexdigest()
            jobs.append((header, pool.submit(compile_alone, compiler, flags, header, digest,
                                             work / header.replace("/", "_"), before)))
    failed = [(header, job.result()) for header, job in jobs if job.result() is not None]
    for header, errors in failed:
        print(f"{header} does not compile alone:\n{errors}")
    print(f"{len(jobs) - len(failed)} of {len(jobs)} headers compile alone")
    return 1 if failed or not jobs else 0


sys.exit(main())
