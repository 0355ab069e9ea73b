"""The checks of pages find mistakes of every kind."""
import importlib.util
import pathlib
import tempfile
import unittest

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "scripts"


def load(name):
    spec = importlib.util.spec_from_file_location(name, SCRIPTS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


check_docs = load("check_docs")
check_prose = load("check_prose")


class CheckDocsTest(unittest.TestCase):
    def failures(self, text):
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder) / "page.md"
            page.write_text(text)
            return check_docs.check_page(page, pathlib.Path("/bin/true"))

    def test_output_is_compared(self):
        for shown, failed in (("100 patches, 1.5 s", 0), ("103 patches, 900 ms", 0), ("120 patches, 1.5 s", 1), ("100 faces, 1.5 s", 1),
                              ("...", 0), ("100 pat...", 0), ("100 patches, 1.5 s\nmore", 1)):
            with self.subTest(shown):
                self.assertEqual(self.failures(f"```console\n$ echo 100 patches, 1.5 s\n{shown}\n```\n"), (1, failed))

    def test_lines_below_the_last_are_missed(self):
        self.assertEqual(self.failures("```console\n$ printf 'a\\nb\\n'\na\n```\n"), (1, 1))
        self.assertEqual(self.failures("```console\n$ printf 'a\\nb\\nc\\n'\na\n...\nc\n```\n"), (1, 0))

    def test_lines_of_both_outputs_may_alternate(self):
        self.assertEqual(self.failures("```console\n$ echo b >&2; echo a; echo c\na\nb\nc\n```\n"), (1, 0))

    def test_exit_codes(self):
        self.assertEqual(self.failures("```console\n$ false\n```\n"), (1, 1))
        self.assertEqual(self.failures("```console\n$ false\n[exit 1]\n```\n"), (1, 0))
        self.assertEqual(self.failures("```console\n$ false\n$ echo $?\n1\n```\n"), (2, 0))

    def test_files_are_written(self):
        self.assertEqual(self.failures("```toml title\n# file: a.toml\nx = 1\n```\n```console\n$ tail -n 1 a.toml\nx = 1\n```\n"), (1, 0))

    def test_quotes_may_be_rounded(self):
        self.assertTrue(check_docs.rounds_to("0.1473", "0.15"))
        self.assertTrue(check_docs.rounds_to("52067", "52000"))
        self.assertFalse(check_docs.rounds_to("0.1573", "0.15"))
        self.assertEqual(check_docs.numbers_in("A [room](x1.md) `2` of 3.5 % takes 12."), ["3.5", "12"])

    def test_anchors_are_those_of_the_sites(self):
        self.assertEqual(check_docs.anchor("## How `solve` works, in short"), "how-solve-works-in-short")


class CheckProseTest(unittest.TestCase):
    def rules(self, text, name="page.md"):
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder) / name
            page.write_text(text)
            return sorted(hit[2] for hit in check_prose.hits_of(page))

    def test_finds_each_rule(self):
        for text, rule in (("See, what is new.", "relative"), ("What is new stays.", "front"), ("The tool tells it.", "tell"), ("Small, as by rays.", "as"), ("It is small, as 5cm.", "as"),
                           ("Below .3 of it.", "decimal"), ("It errs.", "archaic"), ("In some 12 rooms.", "some"), ("They are wanted.", "wanted"),
                           ("They take part.", "part"), ("A grey wall.", "spelling"), ("On an Intel Xeon.", "machine"), ("See docs/page.md here.", "page"),
                           ("word " * 36 + ".", "long")):
            with self.subTest(text):
                self.assertIn(rule, self.rules(text))

    def test_code_links_and_questions_are_left_alone(self):
        self.assertEqual(self.rules("The option `--tell .3` is on [its page](docs/page.md).\n\n```\nWhat is told\n```\n\nIt runs. What is new?\n"), [])

    def test_reads_comments_and_messages(self):
        self.assertEqual(self.rules('// What is new stays.\nint a;  // astray\nauto b = "patchlight " "tells of it here";\n', "a.cpp"), ["archaic", "front", "tell"])


if __name__ == "__main__":
    unittest.main()
