#!/usr/bin/env python3
"""Checks that every public header compiles alone and that every declaration in it is explained.

usage: scripts/check_headers.py [--compiler COMPILER]    default: c++
Declarations that follow each other without an empty line share the comment above the first.
"""
import argparse
import concurrent.futures
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
INCLUDE = ROOT / "include"


def compile_alone(compiler, header):
    """The messages of the compiler for a file that includes only the header, twice."""
    line = f'#include "{header.relative_to(INCLUDE)}"\n'
    done = subprocess.run([compiler, "-std=c++20", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", "-I", INCLUDE,
                           "-isystem", "/usr/include/eigen3", "-x", "c++", "-"],
                          input=2 * line, capture_output=True, text=True, check=False)
    return done.stderr if done.returncode else ""


def unexplained(header):
    """Lines of a namespace that begin a declaration after an empty line, without a comment."""
    faults = []
    before = ""
    for number, line in enumerate(header.read_text().splitlines(), 1):
        begins = re.match(r"[A-Za-z_\[]", line) and not re.match(r"(namespace|using namespace|extern)\b", line)
        is_forward = re.match(r"(class|struct) \w+;", line)
        if begins and not is_forward and (before == "" or before.startswith("namespace")):
            faults.append(f"{header.relative_to(ROOT)}:{number}: no comment says what this is: {line}")
        before = line.strip()
    return faults


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--compiler", default="c++")
    arguments = parser.parse_args()
    headers = sorted(INCLUDE.rglob("*.h"))
    faults = [fault for header in headers for fault in unexplained(header)]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        faults += filter(None, pool.map(lambda header: compile_alone(arguments.compiler, header), headers))
    print("\n".join(faults), file=sys.stderr, end="\n" if faults else "")
    print(f"headers: {len(headers)} public headers, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
