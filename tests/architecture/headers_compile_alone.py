"""Every public header compiles alone, twice in a row, whatever a source included before it.

    headers_compile_alone.py COMPILER INCLUDE_DIR WORK_DIR [FLAG ...]

Parsing Eigen and the standard library is most of the cost. A header that includes all of a few of these itself, or through
other headers of ours, gets them precompiled: it would parse the same. For the same reason a header may follow headers of ours
that it includes: the compiler is started once for a row of them. Nothing else stands before it. What passed is kept in WORK_DIR
by the digest of all that it reads of ours, and is not compiled again."""
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


def rows_of(reads, precompiled):
    """Headers in rows: each includes all that stand before it, and what is precompiled for them."""
    rows = []
    for header in sorted(reads, key=lambda header: len(reads[header]), reverse=True):
        fitting = [row for row in rows if header in reads[row[0]] and precompiled[row[0]] == precompiled[header]]
        if fitting:
            min(fitting, key=lambda row: len(reads[row[0]])).insert(0, header)
        else:
            rows.append([header])
    return rows


def compile_row(compiler, flags, row, digest, kept, precompiled):
    if kept.exists() and kept.read_text() == digest:
        return None
    text = "".join(f'#include "{header}"\n' for header in [*row, *row])
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
    headers = {names: precompile(compiler, flags, names, work) for names in PRECOMPILED}
    reads, precompiled = {}, {}
    for path in sorted(root.rglob("*.hpp")):
        header = str(path.relative_to(root))
        reads[header] = set()
        others = closure(header, root, reads[header])
        precompiled[header] = next((headers[names] for names in PRECOMPILED if others.issuperset(names)), None)
    jobs = []
    with concurrent.futures.ThreadPoolExecutor(max(1, (os.cpu_count() or 1) // 2)) as pool:
        for row in rows_of(reads, precompiled):
            content = "".join((root / name).read_text() for name in sorted(reads[row[-1]])) + " ".join([compiler, *flags, *row])
            digest = hashlib.sha256(content.encode()).hexdigest()
            jobs.append((row, pool.submit(compile_row, compiler, flags, row, digest, work / row[-1].replace("/", "_"),
                                          precompiled[row[0]])))
    failed = [(row, job.result()) for row, job in jobs if job.result() is not None]
    for row, errors in failed:
        print(f"one of these does not compile alone: {' '.join(row)}\n{errors}")
    print(f"{len(reads) - sum(len(row) for row, _ in failed)} of {len(reads)} headers compile alone")
    return 1 if failed or not reads else 0


sys.exit(main())
