#!/usr/bin/env python3
"""Checks the prose of pages, messages, comments and scripts against the rules of docs/developer/prose-style.md.

usage: scripts/check_prose.py                   compares the hits of each group with scripts/prose_counts.txt
       scripts/check_prose.py --list [PATH...]  lists the hits as FILE:LINE, in these files and folders
       scripts/check_prose.py --lower           writes counts that have fallen to scripts/prose_counts.txt
The counts are a ratchet: they may only fall.
"""
import bisect
import collections
import json
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
COUNTS = ROOT / "scripts" / "prose_counts.txt"
LONGEST_LINE = 120
LONGEST_SENTENCE = 35  # words; the rule is 25, and lists of names may be longer

# name, pattern, advice. They see the text with each piece of code replaced by CODE.
RULES = [(name, re.compile(pattern, flags), advice) for name, pattern, advice, flags in [
    ("relative", r"[,;( ]what (of|is|are|they|it|these|that|stands|lies)\b", "name the thing instead of 'what ...'", 0),
    ("front", r"(^|[.!?] )(What|Who|Whoever|Of(?! these,)|By(?! default| day| reciprocity)|Into) ", "start with the subject", 0),
    ("tell", r"\b(tells?|told|says|is said)\b", "programs print, report, list, warn, estimate", 0),
    ("as", r"(?<!well), as (of|by)\b|(?<!well),? as \d", "write 'for example' or 'e.g.'", 0),
    ("decimal", r"(?<![\d\w.%+])\.\d+", "write 0.3, not .3", 0),
    ("archaic", r"\b(anew|of then|of now|mend(s|ed)?|errs?|astray|in the mean|by the clock)\b", "use a modern word", re.I),
    ("some", r"\bsome \d", "write 'about'", re.I),
    ("wanted", r"\b(were|was|are) (wanted|asked)\b", "goals do not belong here", 0),
    ("part", r"\b(tak\w+|took) (no )?part\b", "write 'is simulated', 'is included'", 0),
    ("spelling", r"(?<![\w/])([a-z]*(colour|neighbour|behaviour|favour|grey)[a-z]*|(centi|milli|kilo)?metres?|centred?|centres|licences?|fibres?|catalogues?"
                 r"|(analy|minimi|optimi|normali|visuali|organi|summari|generali|parameteri|triangulari|recogni)s(e|es|ed|ing|ation)"
                 r"|modell(ed|ing)|labell(ed|ing)|cancell(ed|ing)|travell(ed|ing))(?![\w/])", "use American spelling", re.I),
    ("machine", r"AMD EPYC|Intel Xeon|\bZen \d|\bCPU[- ](s|seconds)\b", "machines and timings belong to docs/benchmarks", 0),
]]
BARE_PAGE = re.compile(r"\bdocs/[a-z_/-]+\.md|(?<![\w/.-])[a-z_-]+\.md\b")


class Paragraph:
    """A paragraph with the line of each of its characters; kind is text, heading or cell."""

    def __init__(self, kind, lines):
        self.kind = kind
        self.text = ""
        self.starts, self.lines = [], []
        for number, line in lines:
            self.starts.append(len(self.text))
            self.lines.append(number)
            self.text += line.strip() + " "

    def line(self, position):
        return self.lines[bisect.bisect_right(self.starts, position) - 1]


def blank(match):
    """Code, addresses and formulas become a word of as many letters, so that places stay."""
    return "C" + "O" * (len(match[0]) - 1)


def without_code(text):
    text = re.sub(r"(`+)(?:.(?!\1))*.\1", blank, text)
    text = re.sub(r"\$[^$ ](?:[^$]*[^$ ])?\$", blank, text)
    return re.sub(r"<!--.*?-->", blank, text)


def without_targets(text):
    """Targets of links and their brackets become blanks."""
    text = re.sub(r"\]\([^)]*\)", lambda match: " " * len(match[0]), text)
    text = re.sub(r"<?https?://[^\s>)]+>?|\{[a-z:]+\}", blank, text)
    return re.sub(r"<[a-zA-Z/][^>]*>", blank, text)


def prose_lines(text):
    """The lines of Markdown that are prose, with their numbers; None where a block ends."""
    fence = None
    front_matter = text.startswith("---\n")
    comment = False
    for number, line in enumerate(text.splitlines(), 1):
        mark = re.match(r"\s*(?:> ?)*(`{3,}|~{3,}|\$\$)", line)
        if front_matter:
            front_matter = number == 1 or line.strip() != "---"
            yield number, None
        elif fence:
            if mark and mark[1].startswith(fence):
                fence = None
            yield number, None
        elif comment or (line.strip().startswith("<!--") and "-->" not in line):
            comment = "-->" not in line
            yield number, None
        elif mark and not (mark[1] == "$$" and line.strip().count("$$") == 2):
            fence = mark[1]
            yield number, None
        else:
            yield number, line


def markdown_paragraphs(text):
    paragraph = []
    for number, line in prose_lines(text):
        begins = line is None or not line.strip() or re.match(r"\s*([-*+]|\d+[.)]|#+|\|) ?", line)
        if begins and paragraph:
            yield Paragraph("text", paragraph)
            paragraph = []
        if line is None or not line.strip():
            continue
        line = re.sub(r"^(\s*> ?)+", "", line)
        if line.lstrip().startswith("#"):
            yield Paragraph("heading", [(number, line.lstrip("# "))])
        elif line.lstrip().startswith("|"):
            for cell in re.split(r"(?<!\\)\|", line):
                if cell.strip(" -:"):
                    yield Paragraph("cell", [(number, cell)])
        else:
            paragraph.append((number, re.sub(r"^\s*([-*+]|\d+[.)]) ", "", line)))
    if paragraph:
        yield Paragraph("text", paragraph)


def notebook_paragraphs(text):
    """The Markdown cells of a notebook, with the lines of its file."""
    raw = text.splitlines()
    at = 0
    for cell in json.loads(text)["cells"]:
        if cell["cell_type"] != "markdown":
            continue
        source = "".join(cell["source"]).splitlines()
        places = []
        for line in source:
            quoted = json.dumps(line, ensure_ascii=False)[1:-1]
            at = next((k for k in range(at, len(raw)) if quoted in raw[k]), at)
            places.append(at + 1)
        for paragraph in markdown_paragraphs("\n".join(source)):
            paragraph.lines = [places[number - 1] for number in paragraph.lines]
            yield paragraph


TOKEN = re.compile(r'//[^\n]*|/\*.*?\*/|R"(?P<mark>\w*)\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'', re.DOTALL)


def source_paragraphs(text, comments):
    """Comments of C++ or its string literals, those that follow each other joined."""
    joined, end = [], -1
    newlines = [k for k, character in enumerate(text) if character == "\n"]
    for token in TOKEN.finditer(text):
        is_comment = token[0].startswith("/")
        if is_comment != comments or token[0].startswith("'"):
            continue
        between = text[end:token.start()] if end >= 0 else ""
        words = re.sub(r"^///?<?|^/\*+|\*/$", "", token[0]) if is_comment else token[0]
        if token[0].startswith("//   "):  # usage or code
            words = ""
        if not is_comment:
            words = re.sub(r'^R"\w*\(|\)\w*"$|^"|"$', "", words)
        number = bisect.bisect_left(newlines, token.start()) + 1
        own_line = not text[text.rfind("\n", 0, token.start()) + 1:token.start()].strip()
        if joined and (between.strip() or between.count("\n") > 1 or not words.strip() or (is_comment and not own_line)):
            yield Paragraph("text", joined)
            joined = []
        end = token.end()
        lines = [(number + k, line.lstrip(" *")) for k, line in enumerate(words.replace("\\n", "\a").replace('\\"', '"').splitlines())]
        if is_comment or joined or len(re.findall(r"\b[a-z]{2,}\b", words)) > 2:
            joined += [(at, line) for at, line in lines if line.strip()]
    if joined:
        yield Paragraph("text", joined)


def script_paragraphs(text, is_python):
    """Comments of scripts and docstrings of Python; an indented line begins a paragraph."""
    docstring = r'(?:\A(?:#![^\n]*\n)?|:\n\s*)"""(.*?)"""' if is_python else r"(?!)()"
    joined, last = [], -1
    for match in re.finditer(docstring + r"|^[ ]*# ([^\n]*)", text, re.DOTALL | re.MULTILINE):
        number = text.count("\n", 0, match.start(match.lastindex)) + 1
        lines = (match[1] if match[2] is None else match[2]).splitlines()
        if joined and (match[2] is None or number > last + 1):
            yield Paragraph("text", joined)
            joined = []
        for k, line in enumerate(lines):
            if joined and (not line.strip() or line.startswith(("usage:", " " * 7))):
                yield Paragraph("text", joined)
                joined = []
            if line.strip() and not line.startswith(("usage:", " " * 7)):
                joined.append((number + k, line))
        last = number + len(lines) - 1
    if joined:
        yield Paragraph("text", joined)


def sentences(text):
    at = 0
    for end in re.finditer(r"(?<=[.!?])[\"')*]* +(?=[A-Z\"'(`*])|(?<=[:;]) +|\a|$", text):
        yield at, text[at:end.start()]
        at = end.end()


def check_paragraph(paragraph, pages, timings):
    """Yields line, rule, excerpt and advice of each hit."""
    text = without_code(paragraph.text)
    if pages:
        for match in BARE_PAGE.finditer(without_targets(text)):
            yield paragraph.line(match.start()), "page", match[0], "link the page"
    text = without_targets(text)
    for name, pattern, advice in RULES:
        if name == "machine" and timings or name == "front" and paragraph.kind != "text":
            continue
        for match in pattern.finditer(text):
            if name == "front" and re.match(r"[^.!?]*\?", text[match.end():]):
                continue  # a question
            around = paragraph.text[max(0, match.start() - 20):match.end() + 30].strip()
            yield paragraph.line(match.start()), name, around, advice
    for at, sentence in sentences(text):
        words = len(re.findall(r"[\w'’./%-]*\w[\w'’./%-]*", sentence))
        if words > LONGEST_SENTENCE:
            yield paragraph.line(at), "long", paragraph.text[at:at + 50], f"{words} words; at most 25"


def long_lines(text):
    for number, line in prose_lines(text):
        stays = line is None or line.lstrip().startswith(("|", "#", "![", "<")) or re.match(r"\s*(\S+ )?\S*\]\([^)]*\)\S*$", line)
        if not stays and len(line) > LONGEST_LINE:
            yield number, "line", line[:50], f"{len(line)} characters; at most {LONGEST_LINE}"


def hits_of(path):
    """Yields group, line, rule, excerpt and advice of each hit in a file."""
    text = path.read_text(encoding="utf-8")
    if path.suffix in (".h", ".cpp"):
        is_benchmark = "benchmarks" in path.parts
        for comments, group in ((True, "scripts"),) if is_benchmark else ((True, "comments"), (False, "messages")):
            for paragraph in source_paragraphs(text, comments):
                for hit in check_paragraph(paragraph, False, comments):
                    yield (group, *hit)
        return
    if path.suffix in (".py", ".sh"):
        for paragraph in script_paragraphs(text, path.suffix == ".py"):
            for hit in check_paragraph(paragraph, False, True):
                yield ("scripts", *hit)
        return
    timings = "benchmarks" in path.parts or path.name == "CHANGELOG.md"
    group = group_of(path)
    for paragraph in (notebook_paragraphs if path.suffix == ".ipynb" else markdown_paragraphs)(text):
        for hit in check_paragraph(paragraph, True, timings):
            yield (group, *hit)
    if path.suffix == ".md" and "cli" not in path.parts:
        for hit in long_lines(text):
            yield (group, *hit)


def group_of(page):
    for group in ("getting-started", "tutorials", "how-to", "concepts"):
        if group in page.parts:
            return group
    return page.name if page.name in ("README.md", "CHANGELOG.md") else "docs"


def files_in(path):
    if path.is_file():
        return [path]
    return sorted(file for file in path.rglob("*") if file.suffix in (".h", ".cpp", ".md", ".ipynb", ".py", ".sh")
                  and not {"node_modules", "_build"}.intersection(file.parts))


def all_files():
    paths = [ROOT / name for name in ("README.md", "CHANGELOG.md", "docs", "include", "src", "scripts", "tests/benchmarks")]
    return [file for path in paths for file in files_in(path)]


def read_counts():
    return {name: int(count) for name, count in (line.split() for line in COUNTS.read_text().splitlines() if line and line[0] != "#")}


def write_counts(allowed):
    head = "# The hits of scripts/check_prose.py that each group may have; they may only fall.\n"
    COUNTS.write_text(head + "".join(f"{name} {count}\n" for name, count in allowed.items()))


def main():
    if sys.argv[1:2] == ["--list"]:
        found = 0
        for file in [file for name in sys.argv[2:] for file in files_in(pathlib.Path(name))] or all_files():
            for _, line, rule, excerpt, advice in sorted(hits_of(file), key=lambda hit: hit[1]):
                print(f"{file}:{line}: {rule}: {excerpt!r}: {advice}")
                found += 1
        print(f"prose: {found} hits")
        return 1 if found else 0
    counts = collections.Counter(hit[0] for file in all_files() for hit in hits_of(file))
    allowed = read_counts()
    failed = [name for name in sorted(counts) if counts[name] > allowed.get(name, 0)]
    for name in failed:
        print(f"prose: {name}: {counts[name]} hits, allowed are {allowed.get(name, 0)}: see scripts/check_prose.py --list", file=sys.stderr)
    fallen = {name: min(count, counts[name]) for name, count in allowed.items()}
    if sys.argv[1:2] == ["--lower"]:
        write_counts(fallen)
    elif fallen != allowed:
        print("prose: some counts have fallen; scripts/check_prose.py --lower keeps them")
    print("prose: " + ", ".join(f"{name} {counts[name]}" for name in allowed))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
