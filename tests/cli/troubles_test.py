"""Runs the commands of docs/what_can_go_wrong.md: each says what stands below it, and has the exit code that stands there."""
import os
import pathlib
import re
import unittest

from support import ToolTest

PAGE = pathlib.Path(__file__).resolve().parent.parent.parent / "docs" / "what_can_go_wrong.md"


def told():
    """Command, lines and exit code of each."""
    for block in re.findall(r"^```console\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL):
        for part in block.split("$ patchlight ")[1:]:
            command, *lines = part.splitlines()
            yield command, lines[:-1], int(re.fullmatch(r"\[exit (\d+)\]", lines[-1])[1])


class TroublesTest(ToolTest):
    def test_says_what_the_page_tells(self):
        (self.folder / "meshes").symlink_to(os.environ["PATCHLIGHT_MESHES"])
        self.write("dark.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n")
        self.write("broken.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 4\n")
        seen = 0
        for command, lines, code in told():
            with self.subTest(command):
                done = self.run_tool(*command.split())
                said = done.stderr.replace(str(self.folder), "FOLDER").splitlines()
                for line in lines:
                    self.assertIn(line, said)
                if code not in (0, 3):
                    self.assertEqual(said, lines)
                self.assertEqual(done.returncode, code)
                seen += 1
        self.assertGreater(seen, 10)


if __name__ == "__main__":
    unittest.main()
