"""Shared by the tests of the command-line tool: small models, running the tool, looking at a folder."""
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

from room import MATERIALS, ROOM

TOOL = os.environ["PATCHLIGHT_TOOL"]


# Progress lines, printed every ten seconds, which a slow machine may cause; they are not messages.
PROGRESS = re.compile(r"^patchlight: (?!error|note|warning).* \d+ % of (the run|this stage)(, .* left)?\n", re.MULTILINE)


def run(*arguments, folder, timeout=600, text=""):
    """Runs the tool in a folder with a text on its standard input; returns its output as text, without progress."""
    words = [str(argument) for argument in arguments]
    done = subprocess.run([TOOL, *words], cwd=folder, input=text, capture_output=True, text=True, timeout=timeout,
                          check=False)
    done.stderr = PROGRESS.sub("", done.stderr)
    return done


def is_one_message(text):
    """Whether a text is one line followed by lines with hints."""
    first, *others = text.splitlines()
    return first.startswith("patchlight: ") and all(line.startswith("hint: ") for line in others)


def content(folder):
    """Name, bytes and time of every file of a folder."""
    return {
        path.relative_to(folder): (path.read_bytes(), path.stat().st_mtime_ns) if path.is_file() else None
        for path in sorted(folder.rglob("*"))
    }


class ToolTest(unittest.TestCase):
    """A test with a temporary folder that holds room.obj."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="patchlight-test-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.write("room.obj", ROOM)
        self.write("room.mtl", MATERIALS)

    def write(self, name, text):
        (self.folder / name).write_text(text)

    def run_tool(self, *arguments):
        return run(*arguments, folder=self.folder)
