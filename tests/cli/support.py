"""What the tests of the command-line tool share: small models, running the tool, looking at a folder."""
import os
import pathlib
import subprocess
import tempfile
import unittest

TOOL = os.environ["PATCHLIGHT_TOOL"]

# A closed room of 2 x 2 x 2 m whose faces look inward, with a lamp of 0.5 x 0.5 m that hangs below the ceiling and looks
# down, and a plate in the middle.
ROOM = """mtllib room.mtl
v -1 -1 0
v 1 -1 0
v 1 1 0
v -1 1 0
v -1 -1 2
v 1 -1 2
v 1 1 2
v -1 1 2
v -0.25 -0.25 1.9
v 0.25 -0.25 1.9
v 0.25 0.25 1.9
v -0.25 0.25 1.9
v -0.5 -0.5 1
v 0.5 -0.5 1
v 0.5 0.5 1
v -0.5 0.5 1
usemtl white
f 1 2 3 4
f 5 8 7 6
f 1 5 6 2
f 2 6 7 3
f 3 7 8 4
f 4 8 5 1
f 13 14 15 16
usemtl lamp
f 9 12 11 10
"""

MATERIALS = """newmtl white
Kd 0.7 0.6 0.5
newmtl lamp
Kd 0 0 0
Ke 10 9 8
"""


def run(*arguments, folder, timeout=600, text=""):
    """Runs the tool in a folder, with a text on its standard input; its output as text."""
    words = [str(argument) for argument in arguments]
    return subprocess.run([TOOL, *words], cwd=folder, input=text, capture_output=True, text=True, timeout=timeout,
                          check=False)


def content(folder):
    """Name, bytes and time of every file of a folder."""
    return {
        path.relative_to(folder): (path.read_bytes(), path.stat().st_mtime_ns) if path.is_file() else None
        for path in sorted(folder.rglob("*"))
    }


class ToolTest(unittest.TestCase):
    """A test with a folder of its own that holds room.obj."""

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
