"""The tool is built with hardening against damaged files that try to take over the process.

usage: hardening_test.py TOOL
"""
import re
import subprocess
import sys


def readelf(option, tool):
    return subprocess.run(["readelf", "-W", option, tool], check=True, capture_output=True, text=True).stdout


def main(tool):
    segments = readelf("-l", tool)
    dynamic = readelf("-d", tool)
    symbols = readelf("--dyn-syms", tool)
    holds = {
        "position independent": re.search(r"FLAGS_1\).*\bPIE\b", dynamic),
        "relocations read-only after loading (-z relro)": "GNU_RELRO" in segments,
        "all symbols bound at the start (-z now)": re.search(r"FLAGS\).*\bBIND_NOW\b", dynamic),
        "stack not executable (-z noexecstack)": re.search(r"GNU_STACK(\s+0x\w+){5}\s+RW\s", segments),
        "guarded stack frames (-fstack-protector-strong)": "__stack_chk_fail" in symbols,
        "checked buffer functions (_FORTIFY_SOURCE)": re.search(r"\b__\w+_chk@", symbols.replace("__stack_chk", "")),
        "checked indices (_GLIBCXX_ASSERTIONS)": "__glibcxx_assert_fail" in symbols,
    }
    for what, is_so in holds.items():
        print(f"{'yes' if is_so else 'NO '}  {what}")
    assert all(holds.values())


if __name__ == "__main__":
    main(sys.argv[1])
