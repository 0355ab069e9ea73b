#!/usr/bin/env python3
"""Runs the commands of pages and compares their output; checks links, and numbers quoted from benchmarks.

usage: export PATCHLIGHT_TOOL=build/src/patchlight; then
       scripts/check_docs.py PAGE|FOLDER...             runs the blocks of these pages
       scripts/check_docs.py --write PAGE|FOLDER...     puts the present output into these pages where it differs
       scripts/check_docs.py --links                    checks links and quotes of all pages

PATCHLIGHT_PYTHON is the interpreter that pages run as python3, Debian's if it is not set: the module needs that one.

Each page has a scratch folder of its own, in which meshes/ and scripts/ are visible and `patchlight` and `python3` are
on the PATH. A block whose first line is `# file: NAME` (or `// file: NAME`) becomes this file. Each line after `$ ` in a
```console block is run, and the lines below are compared with its output. `...` alone stands for any lines, `...` at the
end of a line for its rest. Numbers may differ by 5 %, times and memory by anything. `[exit 2]` as the last line is the
exit code; without it a command that prints no error has to end with 0. ```sh blocks run in README.md alone.

A paragraph or table with `<!-- from: benchmarks/NAME.md#section -->` in it or right above it quotes this section: each
of its numbers has to stand there, rounded or not.
"""
import difflib
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
PYTHON = os.environ.get("PATCHLIGHT_PYTHON") or "/usr/bin/python3"
TOLERANCE = 0.05
NUMBER = r"[-+]?(?:\d[\d,]*\d|\d)(?:\.\d+)?(?:[eE][-+]?\d+)?"
MEASURED = re.compile(rf"(?<![\w.]){NUMBER} ?(?:us|µs|ms|s|min|h|[kMG]i?B)\b|\b\d\d?:\d\d(?::\d\d)?\b|\b\d{{4}}-\d\d-\d\d\b")
BUILDS = ("scripts/", "sudo ", "apt", "git ", "cd ", "cmake ", "ctest ")


class Command:
    def __init__(self, line, text):
        self.line = line
        self.text = text
        self.shown = []
        self.compared = True


def blocks(page):
    """Yields language, line of the first line, and lines of each fenced block."""
    fence = None
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        mark = re.match(r"(\s*)(`{3,})\s*(\S*)", line)
        if fence is None and mark:
            indent, fence, language, lines = mark[1], mark[2], mark[3], []
        elif fence is not None and line.strip() == fence:
            yield language, number - len(lines), lines
            fence = None
        elif fence is not None:
            lines.append(line.removeprefix(indent))


def commands_of_console(first, lines):
    """The commands of a console block, with the lines shown below each."""
    found = []
    rest = iter(enumerate(lines, first))
    for number, line in rest:
        if not line.startswith("$ "):
            if found:
                found[-1].shown.append(line)
            continue
        text = line[2:]
        while text.endswith("\\"):
            text = text[:-1] + next(rest)[1].removeprefix("> ")
        here = re.search(r"<<-?\s*['\"]?(\w+)", text)
        while here and text.splitlines()[-1] != here[1]:
            text += "\n" + next(rest)[1].removeprefix("> ")
        found.append(Command(number, text))
    return found


def commands_of_script(first, lines):
    found = []
    for number, line in enumerate(lines, first):
        if found and found[-1].text.endswith("\\"):
            found[-1].text = found[-1].text[:-1] + line
        elif line.strip() and not line.startswith(("#", *BUILDS)):
            found.append(Command(number, line))
            found[-1].compared = False
    return found


def words(line):
    return re.sub(r"\s+", " ", re.sub(r"\x1b\[[\d;]*m", "", MEASURED.sub("MEASURED", line))).strip()


def same_number(shown, printed):
    if shown == printed:
        return True
    a, b = (float(text.replace(",", "")) for text in (shown, printed))
    if "e" in (shown + printed).lower():  # residuals and the like
        return a * b > 0 and 0.1 < a / b < 10
    digits = len(shown.partition(".")[2])
    return abs(a - b) <= max(TOLERANCE * max(abs(a), abs(b)), 1.01 * 10.0**-digits if digits else 0)


def same_line(shown, printed):
    shown, printed = words(shown), words(printed)
    if shown.endswith("...") and not printed.endswith("..."):
        shown = shown[:-3].rstrip()
        printed = printed[:len(shown)]
    if shown == printed:
        return True
    texts = [re.sub(NUMBER, "#", line) for line in (shown, printed)]
    numbers = [re.findall(NUMBER, line) for line in (shown, printed)]
    return texts[0] == texts[1] and all(map(same_number, *numbers))


def first_difference(shown, outputs):
    """The first line of `shown` that is not printed, None if all are; lines of the two outputs may alternate."""
    furthest = 0
    states = {(0, 0)}  # lines used of each output
    elided = False
    for k, line in enumerate(shown):
        if line.strip() == "...":
            elided = True
            continue
        reached = set()
        for used in states:
            for which in (0, 1):
                last = len(outputs[which]) if elided else used[which] + 1
                for at in range(used[which], min(last, len(outputs[which]))):
                    if same_line(line, outputs[which][at]):
                        reached.add((at + 1, used[1]) if which == 0 else (used[0], at + 1))
        if elided:  # the other output may have been elided as well
            reached |= {(len(outputs[0]), b) for a, b in reached} | {(a, len(outputs[1])) for a, b in reached}
        if not reached:
            return line
        states, elided, furthest = reached, False, k
    if shown and not elided and not any(a == len(outputs[0]) and b == len(outputs[1]) for a, b in states):
        return f"(the end, after: {shown[furthest]})"
    return None


def printed_lines(text, folder):
    return [line for line in text.replace(str(folder), "FOLDER").splitlines() if line.strip()]


def likeness(shown, printed):
    """How much two lines look alike, whatever numbers they have."""
    a, b = (re.sub(NUMBER, "#", words(line)) for line in (shown, printed))
    return difflib.SequenceMatcher(None, a, b, autojunk=False).ratio()


def refreshed(shown, outputs):
    """The lines of the outputs that look most like the lines shown, with `...` for the others."""
    early = [line for line in outputs[1] if not re.match(r"patchlight: note|hint:", line)]
    late = [line for line in outputs[1] if line not in early]
    printed = early + outputs[0] + late
    if not any(line.strip() == "..." for line in shown):
        return printed
    chosen = set()
    for line in shown:
        free = [k for k in range(len(printed)) if k not in chosen]
        best = max(free, key=lambda k: likeness(line, printed[k]), default=None)
        if line.strip() != "..." and best is not None and likeness(line, printed[best]) > 0.5:
            chosen.add(best)
    lines, last = [], -1
    for k in sorted(chosen):
        lines += (["..."] if k > last + 1 else []) + [printed[k]]
        last = k
    return lines + (["..."] if last + 1 < len(printed) else [])


def run(command, asks_code, folder, environment, last_code):
    """Runs a command; returns its exit code, its faults and its output as the page would show it."""
    done = subprocess.run(["bash", "-c", f"(exit {last_code}); {command.text}"], cwd=folder, env=environment, check=False,
                          stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace")
    shown = [line for line in command.shown if line.strip()]
    outputs = [printed_lines(done.stdout, folder), printed_lines(done.stderr, folder)]
    code = re.fullmatch(r"\[exit (\d+)\]", shown[-1].strip()) if shown else None
    code_shown = [shown.pop()] if code else []
    fails = asks_code or any(re.search(r"\berror\b|Error|NOT converged", line) for line in shown)
    wrong = []
    if code and done.returncode != int(code[1]):
        wrong.append(f"ends with {done.returncode}, expected {code[1]}")
    elif not code and done.returncode != 0 and not fails:
        wrong.append(f"ends with {done.returncode}")
    if command.compared:
        line = first_difference(shown, outputs)
        if line is not None:
            wrong.append(f"does not print: {line}")
    if wrong:
        wrong += ["  | " + line for output in outputs for line in output[:60]]
    return done.returncode, wrong, refreshed(shown, outputs) + code_shown


def check_page(page, tool, writes=False):
    """Runs the blocks of a page; returns the number of commands and of those that fail. Replaces lines if it `writes`."""
    failed = count = 0
    page_lines = page.read_text(encoding="utf-8").splitlines()
    edits = []
    name = page.relative_to(ROOT) if page.is_relative_to(ROOT) else page
    with tempfile.TemporaryDirectory(prefix="patchlight-docs-") as scratch:
        folder = pathlib.Path(scratch) / "work"
        programs = pathlib.Path(scratch) / "bin"
        folder.mkdir()
        programs.mkdir()
        for entry in ("meshes", "scripts"):
            (folder / entry).symlink_to(ROOT / entry)
        (programs / "patchlight").symlink_to(tool)
        if pathlib.Path(PYTHON).exists():
            (programs / "python3").symlink_to(PYTHON)
        environment = {**os.environ, "PATH": f"{programs}:{os.environ['PATH']}", "LC_ALL": "C.UTF-8"}
        code = 0
        for language, first, lines in blocks(page):
            head = re.match(r"\s*(?:#|//|--|;) ?file: (\S+)", lines[0]) if lines else None
            if head:
                file = folder / head[1]
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text("\n".join(lines) + "\n")
                continue
            commands = []
            if language == "console":
                commands = commands_of_console(first, lines)
            elif language == "sh" and page.name == "README.md":
                commands = commands_of_script(first, lines)
            for k, command in enumerate(commands):
                count += 1
                asks_code = k + 1 < len(commands) and "$?" in commands[k + 1].text
                start = time.monotonic()
                code, wrong, now = run(command, asks_code, folder, environment, code)
                print(f"{name}:{command.line}: {time.monotonic() - start:.1f} s: {command.text}", flush=True)
                if wrong and writes and command.shown:
                    edits.append((command, now))
                elif wrong:
                    failed += 1
                    print(f"{name}:{command.line}: error: {command.text}\n  " + "\n  ".join(wrong), file=sys.stderr, flush=True)
    for command, now in reversed(edits):
        begin = next(k for k in range(command.line, len(page_lines)) if page_lines[k].strip() == command.shown[0].strip())
        indent = page_lines[begin][:len(page_lines[begin]) - len(page_lines[begin].lstrip())]
        page_lines[begin:begin + len(command.shown)] = [indent + line for line in now]
    if edits:
        page.write_text("\n".join(page_lines) + "\n", encoding="utf-8")
    return count, failed


# Links, and quotes of benchmarks.

def without_blocks(text):
    """Markdown without its fenced blocks, as blank lines."""
    lines, fence = [], None
    for line in text.splitlines():
        mark = re.match(r"\s*(`{3,}|~{3,})", line)
        if mark and (fence is None or line.strip() == fence):
            fence = None if fence else mark[1]
            lines.append("")
        else:
            lines.append("" if fence else line)
    return "\n".join(lines)


def anchor(heading):
    """The anchor that GitHub and MyST give a heading."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading.strip().strip("#").strip())
    return re.sub(r" ", "-", re.sub(r"[^\w\- ]", "", text.replace("`", "")).lower())


def anchors(page):
    text = page.read_text(encoding="utf-8")
    own = re.findall(r"^\(([\w-]+)\)=$", text, re.MULTILINE) + re.findall(r"<a (?:id|name)=\"([\w-]+)\"", text)
    return {anchor(line) for line in without_blocks(text).splitlines() if re.match(r"#+ ", line)}.union(own)


def links(page):
    """Yields line and target of each relative link and figure of a page."""
    text = page.read_text(encoding="utf-8")
    if page.suffix == ".ipynb":
        text = text.replace('\\"', '"')
    plain = re.sub(r"`[^`\n]*`", lambda match: " " * len(match[0]), without_blocks(text))
    for match in re.finditer(r"\]\(<?([^)\s>]+)>?(?: \"[^\"]*\")?\)|(?:src|href)=\"([^\"]+)\"|^\[[^\]^]+\]: (\S+)", plain, re.MULTILINE):
        yield plain.count("\n", 0, match.start()) + 1, next(group for group in match.groups() if group)
    for toctree in re.finditer(r"```\{(?:toctree|include|figure|image)\} ?(\S*)\n(.*?)```", text, re.DOTALL):
        line = text.count("\n", 0, toctree.start()) + 1
        if toctree[1]:
            yield line, toctree[1]
        elif "toctree" in toctree[0][:15]:
            for entry in toctree[2].splitlines():
                entry = re.sub(r"^.*<(.*)>$", r"\1", entry.strip())
                if entry and not entry.startswith(":"):
                    yield line, entry


def targets(page, target):
    """The files that a link means: entries of a toctree have no extension and may be patterns."""
    path = DOCS / target[1:] if target.startswith("/") else page.parent / target
    if "*" in target:
        return [file for file in path.parent.glob(path.name) if file.suffix in (".md", ".ipynb")] + list(path.parent.glob(path.name + ".md"))
    for file in (path, path.with_name(path.name + ".md"), path.with_name(path.name + ".ipynb")):
        if file.exists():
            return [file]
    return []


def all_pages():
    return [ROOT / "README.md", ROOT / "CHANGELOG.md"] + sorted(
        file for file in DOCS.rglob("*") if file.suffix in (".md", ".ipynb") and "_build" not in file.parts)


def check_links():
    wrong = []
    linked = {}
    for page in all_pages():
        linked[page] = set()
        for line, target in links(page):
            if re.match(r"[a-z]+:|//", target):
                continue
            name, _, part = target.partition("#")
            found = targets(page, name) if name else [page]
            if not found:
                wrong.append(f"{page.relative_to(ROOT)}:{line}: there is no {target}")
            elif part and found[0].suffix == ".md" and part not in anchors(found[0]):
                wrong.append(f"{page.relative_to(ROOT)}:{line}: there is no heading {target}")
            linked[page] |= {file.resolve() for file in found}
    shown = set().union(*linked.values())
    wrong += [f"{figure.relative_to(ROOT)}: no page shows this figure" for figure in sorted((DOCS / "figures").rglob("*"))
              if figure.is_file() and figure not in shown]
    reached, waiting = set(), [DOCS / "index.md"]
    while waiting:
        page = waiting.pop()
        if page in linked and page not in reached:
            reached.add(page)
            waiting += linked[page]
    wrong += [f"{page.relative_to(ROOT)}: no way leads here from docs/index.md" for page in linked if page not in reached and DOCS in page.parents]
    return wrong


def section(page, name):
    """The text under the heading with this anchor, up to the next of its level."""
    lines, level = [], 0
    for line in page.read_text(encoding="utf-8").splitlines():
        heading = re.match(r"(#+) ", line)
        if level and heading and len(heading[1]) <= level:
            break
        if heading and not level and anchor(line) == name:
            level = len(heading[1])
        elif level:
            lines.append(line)
    return "\n".join(lines)


def numbers_in(text):
    plain = re.sub(r"`[^`]*`|<!--.*?-->|\]\([^)]*\)|<[^>]*>", " ", text)
    return [number.replace(",", "") for number in re.findall(rf"(?<![\w.]){NUMBER}(?![\w.]*\w)|(?<![\w.]){NUMBER}(?=\.\s|\.$)", plain)]


def rounds_to(number, quote):
    digits = len(quote.partition(".")[2])
    whole = len(quote) - len(quote.rstrip("0")) if not digits else 0
    return abs(float(number) - float(quote)) <= 0.5001 * 10.0**(whole - digits)


def check_quotes():
    wrong = []
    for page in all_pages():
        if page.suffix != ".md":
            continue
        text = page.read_text(encoding="utf-8")
        for mark in re.finditer(r"<!-- from: (\S+?)#(\S+) -->", text):
            end = text.find("\n\n", mark.end())
            begin = text.rfind("\n\n", 0, mark.start()) + 2
            if not text[begin:end].replace(mark[0], "").strip():  # the mark stands alone: the next paragraph
                end = text.find("\n\n", end + 2)
            paragraph = text[begin:end if end >= 0 else len(text)]
            source = DOCS / mark[1]
            measured = numbers_in(section(source, mark[2])) if source.exists() else []
            line = text.count("\n", 0, mark.start()) + 1
            if not measured:
                wrong.append(f"{page.relative_to(ROOT)}:{line}: there is no section with numbers {mark[1]}#{mark[2]}")
                continue
            wrong += [f"{page.relative_to(ROOT)}:{line}: {quote} does not stand in {mark[1]}#{mark[2]}"
                      for quote in numbers_in(paragraph) if not any(rounds_to(number, quote) for number in measured)]
    return wrong


def main():
    if sys.argv[1:] == ["--links"]:
        wrong = check_links() + check_quotes()
        print("\n".join(wrong), file=sys.stderr)
        print(f"docs: {len(all_pages())} pages, {len(wrong)} links or quotes are wrong")
        return 1 if wrong else 0
    tool = pathlib.Path(os.environ["PATCHLIGHT_TOOL"]).resolve()
    writes = sys.argv[1:2] == ["--write"]
    pages = [page for name in sys.argv[2 if writes else 1:] for path in [pathlib.Path(name).resolve()]
             for page in ([path] if path.is_file() else sorted(path.rglob("*.md")))]
    count = failed = 0
    for page in pages:
        ran, wrong = check_page(page, tool, writes)
        count, failed = count + ran, failed + wrong
    print(f"docs: {len(pages)} pages, {count} commands, {failed} failed")
    return 1 if failed or not pages else 0


if __name__ == "__main__":
    sys.exit(main())
