"""Runs the commands of docs/troubleshooting.md: each prints the lines below it, and has the exit code that stands there."""
import os
import pathlib
import re
import unittest

from support import ToolTest

PAGE = pathlib.Path(__file__).resolve().parent.parent.parent / "docs" / "troubleshooting.md"


def shown():
    """Command, lines and exit code of each; without a code it is 0."""
    for block in re.findall(r"^```console\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL):
        for part in block.split("$ patchlight ")[1:]:
            command, *lines = part.splitlines()
            code = re.fullmatch(r"\[exit (\d+)\]", lines[-1]) if lines else None
            yield command, [line for line in lines[:-1 if code else None] if line != "..."], int(code[1]) if code else 0


class TroublesTest(ToolTest):
    def test_prints_what_the_page_shows(self):
        (self.folder / "meshes").symlink_to(os.environ["PATCHLIGHT_MESHES"])
        for name, text in re.findall(r"^```text\n# file: (\S+)\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL):
            self.write(name, f"# file: {name}\n{text}")
        seen = 0
        for command, lines, code in shown():
            with self.subTest(command):
                done = self.run_tool(*command.split())
                printed = done.stderr.replace(str(self.folder), "FOLDER").splitlines()
                for line in lines:
                    self.assertIn(line, printed)
                if code not in (0, 3):
                    self.assertEqual(printed, lines)
                self.assertEqual(done.returncode, code)
                seen += 1
        self.assertGreater(seen, 10)


if __name__ == "__main__":
    unittest.main()
