#!/usr/bin/env python3
"""Prints what `check` and `plan` take on the models of large_models.py, as the table in docs/hard_cases.md.

usage: scripts/large_model_costs.py TOOL [--only NAME,NAME...] [--patience SECONDS] [--patches N]

Processor seconds of all threads and the largest memory of each. A run that takes longer than the patience is ended and
shown as such; one that is refused for want of memory is marked, as it ends before the survey of what stands between.
"""
import argparse
import os
import pathlib
import resource
import subprocess
import tempfile

from large_models import MODELS, write

NO_MEMORY = 4  # exit code


def measured(words, patience):
    """Processor seconds, or text when there are none, and the largest memory in MB."""
    def limit():
        resource.setrlimit(resource.RLIMIT_CPU, (patience, patience))

    process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, preexec_fn=limit)
    errors = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    megabytes = usage.ru_maxrss / 1024
    if process.returncode < 0:
        return f"over {patience}", megabytes
    if process.returncode not in (0, NO_MEMORY):
        raise SystemExit(f"{' '.join(words)}: exit code {process.returncode}\n{errors.decode()[-2000:]}")
    refused = ", refused" if process.returncode == NO_MEMORY else ""
    return f"{usage.ru_utime + usage.ru_stime:.2f}{refused}", megabytes


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool", type=os.path.abspath)
    parser.add_argument("--only", type=lambda text: text.split(","), default=list(MODELS))
    parser.add_argument("--patience", type=int, default=60, help="processor seconds")
    parser.add_argument("--patches", type=int, help="for plan")
    options = parser.parse_args()
    print("| model | `check`, s | MB | `plan`, s | MB |\n|---|---|---|---|---|")
    with tempfile.TemporaryDirectory(prefix="patchlight-large-") as folder:
        for name in options.only:
            path = write(pathlib.Path(folder), name)
            patches = [] if options.patches is None else ["--patches", str(options.patches)]
            check, check_memory = measured([options.tool, "check", str(path)], options.patience)
            plan, plan_memory = measured([options.tool, "plan", str(path), *patches], options.patience)
            path.unlink()
            print(f"| {MODELS[name][0]} | {check} | {check_memory:.0f} | {plan} | {plan_memory:.0f} |", flush=True)


if __name__ == "__main__":
    main()
