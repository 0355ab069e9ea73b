#!/usr/bin/env python3
"""Runs every command of README.md's ```sh blocks in a scratch copy of the repository's top folder.

usage: PATCHLIGHT_TOOL=build/src/patchlight scripts/check_readme.py
Lines that start with scripts/ are left out: they build everything.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent


def commands(text):
    """The lines of the sh blocks, with continued lines joined, without comments."""
    for block in re.findall(r"^```sh\n(.*?)^```", text, re.MULTILINE | re.DOTALL):
        for line in block.replace("\\\n", " ").splitlines():
            command = line.strip()
            if command and not command.startswith(("#", "scripts/")):
                yield command


def main():
    tool = pathlib.Path(os.environ["PATCHLIGHT_TOOL"]).resolve()
    failed = count = 0
    with tempfile.TemporaryDirectory(prefix="patchlight-readme-") as name:
        folder = pathlib.Path(name)
        for entry in ("meshes", "scripts"):
            (folder / entry).symlink_to(ROOT / entry)
        (folder / "build" / "src").mkdir(parents=True)
        (folder / "build" / "src" / "patchlight").symlink_to(tool)
        for command in commands((ROOT / "README.md").read_text()):
            count += 1
            print("$ " + command, flush=True)
            code = subprocess.run(["bash", "-c", command], cwd=folder, check=False).returncode
            if code != 0:
                failed += 1
                print(f"README.md: this command ends with {code}: {command}", file=sys.stderr)
    if count == 0:
        print("README.md: found no command to run; expected some in ```sh blocks", file=sys.stderr)
    return 1 if failed or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
