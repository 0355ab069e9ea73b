#!/usr/bin/env python3
"""Writes docs/command_line.md, the manual page docs/patchlight.1 and the completion for bash, docs/patchlight.bash, from
what the tool says about itself.

usage: PATCHLIGHT_TOOL=build/src/patchlight scripts/make_help.py [--check]
--check writes nothing and fails when the files are not up to date.
"""
import os
import pathlib
import re
import subprocess
import sys

DOCS = pathlib.Path(__file__).resolve().parent.parent / "docs"
ENTRY = re.compile(r"^ {2}(?=\S)", re.MULTILINE)  # an option or command begins two columns in


def help_of(*command):
    tool = os.environ["PATCHLIGHT_TOOL"]
    return subprocess.run([tool, *command, "--help"], check=True, capture_output=True, text=True).stdout.rstrip()


def section(text, title):
    """The entries of a section of a help text: pairs of what is typed and what it means."""
    found = re.search(rf"^{title}:\n((?:  .*\n?)+)", text, re.MULTILINE)
    for entry in ENTRY.split(found[1])[1:] if found else []:
        head, *rest = entry.splitlines()
        typed, *meaning = re.split(r"\s{2,}", head.strip(), maxsplit=1)
        yield typed, " ".join(meaning + [line.strip() for line in rest])


def description(text):
    """What stands before the line of usage."""
    return " ".join(text.split("Usage:")[0].split())


def usage(text):
    return re.search(r"^Usage: (.*)$", text, re.MULTILINE)[1]


def commands(text):
    return [name for name, _ in section(text, "Subcommands")]


def markdown(texts):
    parts = ["# Command line\n\nWhat `patchlight --help` says. `scripts/make_help.py` writes this page.\n"]
    for words, text in texts.items():
        parts.append(f"## `{' '.join(('patchlight',) + words)}`\n\n```text\n{text}\n```\n")
    return "\n".join(parts)


def roff(text):
    """Text in which nothing is a command of the formatter."""
    escaped = text.replace("\\", "\\e").replace("-", "\\-")
    return re.sub(r"^(?=[.'])", r"\\&", escaped, flags=re.MULTILINE)


def entries(pairs):
    return [f".TP\n\\fB{roff(typed)}\\fR\n{roff(meaning)}" for typed, meaning in pairs]


def manual(texts):
    """A page for man(1)."""
    top = texts[()]
    about = description(top).split(": ", 1)[1]
    exits = re.search(r"Exit codes: (.*)\Z", top, re.DOTALL)[1].rstrip(".").replace("\n", " ")
    lines = [".TH PATCHLIGHT 1", ".SH NAME", roff(f"patchlight - {about}"), ".SH SYNOPSIS"]
    for words, text in texts.items():
        if words or len(texts) == 1:
            lines += [roff(usage(text)), ".br"]
    lines += [".SH COMMANDS"] + entries(section(top, "Subcommands"))
    for words, text in texts.items():
        name = " ".join(words).upper()
        lines += [f".SH {name + ' ' if name else ''}OPTIONS"]
        lines += entries(section(text, "Positionals")) + entries(section(text, "Options"))
    lines += [".SH EXIT STATUS"]
    codes = [code.split(" ", 1) for code in re.split(r", (?=\d)", exits)]
    lines += entries(codes) + [".SH SEE ALSO", "paraview(1)"]
    return "\n".join(lines) + "\n"


OPTION = re.compile(r"^  ((?:-\w,)?--[\w-]+)(?: (\S+))?", re.MULTILINE)


def options(text):
    """The options of a help text: {"--solver": the word after it, or None}; short names beside the long ones."""
    found = {}
    for names, value in OPTION.findall(text):
        for name in names.split(","):
            found[name] = value or None
    return found


COMPLETION = """# Completion of patchlight for bash. scripts/make_help.py writes this file.
_patchlight() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} command=${{COMP_WORDS[1]}}
  local words=
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    words="{commands}"
  else
    case "$command,$before" in
{choices}
    esac
    if [ -z "$words" ] && [[ $current == -* ]]; then
      case $command in
{options}
      esac
    fi
  fi
  if [ -n "$words" ]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$current")
  fi
}}
complete -o filenames -F _patchlight patchlight
"""


def completion(texts):
    """Commands, then their options and the words that these take; files everywhere else."""
    choices, names = [], []
    for words, text in texts.items():
        if not words:
            continue
        found = options(text)
        names.append(f"        {words[0]}) words=\"{' '.join(found)}\" ;;")
        for name, value in found.items():
            if value and re.fullmatch(r"[a-z0-9-]+(\|[a-z0-9-]+)+", value):
                choices.append(f"      {words[0]},{name}) words=\"{value.replace('|', ' ')}\" ;;")
    return COMPLETION.format(commands=" ".join(words[0] for words in texts if words) + " --help --version",
                             choices="\n".join(choices), options="\n".join(names))


def main():
    check = sys.argv[1:] == ["--check"]
    texts = {(): help_of()}
    for command in commands(texts[()]):
        texts[(command,)] = help_of(command)
    stale = 0
    for file, content in ((DOCS / "command_line.md", markdown(texts)), (DOCS / "patchlight.1", manual(texts)),
                          (DOCS / "patchlight.bash", completion(texts))):
        if file.exists() and file.read_text() == content:
            continue
        if check:
            stale += 1
            print(f"docs/{file.name} is not what the tool says; run scripts/make_help.py", file=sys.stderr)
        else:
            file.write_text(content)
            print(f"wrote docs/{file.name}")
    return 1 if stale else 0


if __name__ == "__main__":
    sys.exit(main())
