"""Runs the commands of docs/troubleshooting.md: each prints the lines below it, and has the exit code that stands there.

troubles_test.py --write puts into the page what the tool prints now; of an output with "..." the lines that end as before.
"""
import os
import pathlib
import re
import sys
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
    def setUp(self):
        super().setUp()
        (self.folder / "meshes").symlink_to(os.environ["PATCHLIGHT_MESHES"])
        for name, text in re.findall(r"^```text\n# file: (\S+)\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL):
            self.write(name, f"# file: {name}\n{text}")

    def printed(self, command):
        done = self.run_tool(*command.split())
        return done.stderr.replace(str(self.folder), "FOLDER").splitlines(), done.returncode

    def test_prints_what_the_page_shows(self):
        seen = 0
        for command, lines, code in shown():
            with self.subTest(command):
                printed, returned = self.printed(command)
                for line in lines:
                    self.assertIn(line, printed)
                if code not in (0, 3):
                    self.assertEqual(printed, lines)
                self.assertEqual(returned, code)
                seen += 1
        self.assertGreater(seen, 10)

    def write_page(self):
        def block(match):
            lines = []
            for part in match[1].split("$ patchlight ")[1:]:
                command, *old = part.splitlines()
                printed, code = self.printed(command)
                if "..." in old:
                    ends = {line.split()[-1] for line in old if line != "..."}
                    printed = ["...", *(line for line in printed if line.split()[-1] in ends), "..."]
                elif code == 0:
                    printed = []
                lines += [f"$ patchlight {command}", *printed, *([f"[exit {code}]"] if code else [])]
            return "```console\n" + "\n".join(lines) + "\n```"

        text = PAGE.read_text(encoding="utf-8")
        PAGE.write_text(re.sub(r"^```console\n(.*?)^```", block, text, flags=re.MULTILINE | re.DOTALL), encoding="utf-8")


if __name__ == "__main__":
    if sys.argv[1:] == ["--write"]:
        case = TroublesTest("write_page")
        case.setUp()
        case.write_page()
        case.doCleanups()
    else:
        unittest.main()
