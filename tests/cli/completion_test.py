"""Completion in bash: docs/patchlight.bash, which scripts/make_help.py writes from the tool's help."""
import pathlib
import subprocess
import unittest

FILE = pathlib.Path(__file__).resolve().parent.parent.parent / "docs" / "patchlight.bash"


def offered(*words):
    """The completions that bash offers for the last of the words."""
    script = f'source "{FILE}"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _patchlight; printf "%s\\n" "${{COMPREPLY[@]}}"'
    done = subprocess.run(["bash", "-c", script, "bash", *words], capture_output=True, text=True, check=True)
    return done.stdout.split()


class CompletionTest(unittest.TestCase):
    def test_offers_commands(self):
        self.assertEqual(offered("patchlight", "so"), ["solve"])
        self.assertIn("relight", offered("patchlight", "re"))

    def test_offers_the_options_of_the_command(self):
        self.assertEqual(offered("patchlight", "solve", "room.obj", "--ht"), ["--html"])
        self.assertEqual(offered("patchlight", "plan", "room.obj", "--ht"), [])

    def test_offers_the_words_of_an_option(self):
        self.assertEqual(offered("patchlight", "solve", "--solver", "g"), ["gauss-seidel", "gmres"])
        self.assertEqual(offered("patchlight", "solve", "--picture-quality", ""), ["draft", "final"])

    def test_offers_files_elsewhere(self):
        self.assertIn(str(FILE), offered("patchlight", "solve", str(FILE)[:-2]))


if __name__ == "__main__":
    unittest.main()
