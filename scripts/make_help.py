#!/usr/bin/env python3
"""Writes the pages of docs/reference/cli, the manual pages of docs/man and the completion for bash, docs/patchlight.bash,
from the help of the tool.

usage: PATCHLIGHT_TOOL=build/src/patchlight scripts/make_help.py [--check]
--check writes nothing. It fails if a file is not up to date, or if a manual page or a reference page lacks an option.
"""
import dataclasses
import os
import pathlib
import re
import subprocess
import sys
import textwrap

DOCS = pathlib.Path(__file__).resolve().parent.parent / "docs"
CLI = DOCS / "reference" / "cli"
MAN = DOCS / "man"
SHARED = 3  # an option with the same text in so many commands stands on common-options.md, in two on the page of the first

ALL = "All of these groups of"  # where a command takes all options of groups, in place of their names

EXIT_STATUS = [
    ("0", "Success."),
    ("1", "Usage: the command line is not valid. Nothing was read or written."),
    ("2", "Input: a model or another input file cannot be used. Nothing was written."),
    ("3", "The solver did not converge, or the requested accuracy was not reached. All results were written."),
    ("4", "Not enough memory. patchlight estimates the need before the run starts; nothing was written."),
    ("5", "A check failed: `patchlight crosscheck` or `patchlight selftest` found a deviation beyond the error bars."),
    ("6", "Output: a result cannot be written."),
    ("70", "Internal error, a defect of patchlight. Please report it."),
    ("128 + n", "Signal n stopped the run, e.g. 130 for Ctrl-C. `patchlight solve` and `patchlight relight` write the "
                "results so far, unless `--discard` is given."),
]

FILES = {
    "init": [("SCENE.toml", "The scene file that is created.")],
    "solve": [("NAME.irradiance.csv", "Readings of the sensors, beside the result or in the current folder, if no "
                                      "--points-output is given.")],
    "relight": [("FOLDER", "Form factors and scene, from patchlight form-factors.")],
    "form-factors": [("FOLDER/info.json", "The facts of the form factors: options, sizes and errors."),
                     ("FOLDER/scene.json", "The scene, which patchlight relight reads.")],
    "annual": [("FOLDER/illuminance.npy, FOLDER/illuminance.ill", "The illuminance of all hours and sensors, lx."),
               ("FOLDER/rooms.csv, FOLDER/sensors.csv", "The measures of rooms and sensors, with standard errors."),
               ("FOLDER/hours.csv, FOLDER/annual.json", "Sun and sky of all hours, and all facts.")],
    "compare-solvers": [("FOLDER/compare.csv, FOLDER/compare.json", "The table of all solvers, and all facts.")],
    "convergence": [("FOLDER/study.csv, FOLDER/study.json", "The table of all runs, and all facts.")],
}

SEE_ALSO = {
    "check": ["init", "plan"], "init": ["check", "solve"], "solve": ["plan", "render", "crosscheck"],
    "render": ["solve"], "annual": ["init", "solve"], "plan": ["solve"], "crosscheck": ["solve", "selftest"],
    "relight": ["form-factors", "solve"],
    "form-factors": ["relight"], "compare-solvers": ["convergence"], "convergence": ["compare-solvers"],
    "selftest": ["crosscheck"],
}


@dataclasses.dataclass(frozen=True)
class Option:
    head: str  # "-o, --output FILE"
    help: str
    more: str
    group: str

    def names(self):
        return re.findall(r"(?:^|, )(--?[a-z][\w-]*)", self.head) or [self.head]

    def value(self):
        return re.sub(r"^(-\w, )?--?[\w-]+ ?", "", self.head)


@dataclasses.dataclass
class Command:
    name: str
    summary: str
    usage: str
    about: str
    examples: list  # pairs of a meaning and a line
    options: list


def run(*words):
    tool = os.environ["PATCHLIGHT_TOOL"]
    return subprocess.run([tool, *words], check=True, capture_output=True, text=True).stdout


def groups_of_commands():
    """{"Start": [("check", "Report ..."), ...], ...} from patchlight --help."""
    found = {}
    for title, lines in re.findall(r"^([A-Z]\w+):\n((?:  .*\n)+)", run("--help"), re.MULTILINE):
        if title != "Help":
            found[title] = [tuple(line.strip().split(None, 1)) for line in lines.splitlines()]
    return found


def command_of(name):
    """A command from its --help."""
    summary, usage, about, *parts = run(name, "--help").rstrip().split("\n\n")
    parts = parts[:-1]  # the exit status
    comments = [line.strip() for line in parts.pop(0).splitlines()[1:]]
    options = []
    for part in parts:
        title, *lines = part.splitlines()
        for entry in re.split(r"^  (?=\S)", "\n".join(lines), flags=re.MULTILINE)[1:]:
            head, short, *more = entry.splitlines()
            options.append(Option(head, short.strip(), " ".join(line.strip() for line in more), title.rstrip(":")))
    return Command(name, summary, usage.removeprefix("Usage: "), " ".join(about.split()),
                   [(comments[k].lstrip("# "), comments[k + 1]) for k in range(0, len(comments), 2)], options)


def in_groups(options):
    found = {}
    for option in options:
        found.setdefault(option.group, []).append(option)
    return found


# Markdown

def prose(text):
    """Text with options as code and nothing that Markdown takes for emphasis."""
    pieces = re.split(r"(`[^`]*`)", text)
    for k in range(0, len(pieces), 2):
        pieces[k] = re.sub(r"(?<![\w-])(--[a-z][\w-]*|-[a-z](?![\w-]))", r"`\1`", pieces[k].replace("*", r"\*"))
    return "".join(pieces)


def filled(text, first="", rest=""):
    return textwrap.fill(text, 118, initial_indent=first, subsequent_indent=rest, break_long_words=False,
                         break_on_hyphens=False)


def entry(option):
    more = " " + prose(option.more) if option.more else ""
    return filled(f"**`{option.head}`**: {prose(option.help)}.{more}", "- ", "  ")


def entries(options):
    return "\n".join(entry(option) for option in options) + "\n"


def anchor(title):
    return title.lower().replace(" ", "-")


def page_of(command, homes):
    own = in_groups(option for option in command.options if homes[option] == command.name)
    common = {}
    for option in command.options:
        if homes[option] != command.name:
            common.setdefault((homes[option], option.group), []).append(option)
    lines = [f"# patchlight {command.name}\n", command.summary + "\n", f"```sh\n{command.usage}\n```\n",
             filled(prose(command.about)) + "\n", "## Examples\n", "```sh"]
    for meaning, line in command.examples:
        lines += [f"# {meaning}", line]
    lines += ["```\n", "## Options\n"]
    for title, options in own.items():
        lines += [f"### {title}\n", entries(options)]
    if common:
        lines += ["## Options in common with other commands\n"]
        whole = {}
        for (home, title), options in common.items():
            if {option for option, at in homes.items() if (at, option.group) == (home, title)} == set(options):
                whole.setdefault(home, []).append(title)
        for home, titles in sorted(whole.items()):
            lines.append(filled(f"{ALL} [{home.replace('-', ' ')}]({home}.md): {', '.join(titles)}", "- ", "  "))
        for (home, title), options in common.items():
            if title not in whole.get(home, []):
                names = ", ".join(f"`{option.names()[-1]}`" for option in options)
                lines.append(filled(f"[{title}]({home}.md#{anchor(title)}): {names}", "- ", "  "))
        lines.append("")
    lines.append("The command ends with one of these codes: [exit status](exit-status.md).")
    return "\n".join(lines) + "\n"


def common_page(commands, homes):
    lines = ["# Common options\n", "Options with the same meaning in three or more commands. The page of each command lists "
             "the ones that it takes.\n"]
    ordered = []
    for command in commands:
        ordered += [option for option in command.options if homes[option] == "common-options" and option not in ordered]
    for title, options in in_groups(ordered).items():
        lines += [f"## {title}\n", entries(options)]
    return "\n".join(lines).rstrip() + "\n"


def index_page(groups):
    lines = ["# Command line\n", "```sh\npatchlight COMMAND [ARGUMENTS]\n```\n",
             "| command | purpose |\n|---|---|"]
    for commands in groups.values():
        lines += [f"| [`{name}`]({name}.md) | {summary} |" for name, summary in commands]
    lines += ["", "- `patchlight COMMAND -h` prints the options that most people use, with examples.",
              "- `patchlight COMMAND --help` prints all options. The manual page `patchlight-COMMAND(1)` has the same text.",
              "- `patchlight help TOPIC` prints a page of this documentation, e.g. `patchlight help daylight`.",
              "- `patchlight --version` prints the version.", "",
              "See also [common options](common-options.md) and [exit status](exit-status.md)."]
    return "\n".join(lines) + "\n"


def exit_page():
    rows = "\n".join(f"| {code} | {meaning} |" for code, meaning in EXIT_STATUS)
    return ("# Exit status\n\nEvery command returns one of these codes to the shell. A result file is always whole: it has "
            f"either\nits old content or its new content.\n\n| code | meaning |\n|---|---|\n{rows}\n")


# Manual pages

def roff(text):
    """Text in which nothing is a request of the formatter; code is bold."""
    escaped = text.replace("\\", "\\e").replace("-", "\\-")
    escaped = re.sub(r"`([^`]*)`", r"\\fB\1\\fR", escaped)
    return re.sub(r"^(?=[.'])", r"\\&", escaped, flags=re.MULTILINE)


def tagged(pairs):
    return [f".TP\n\\fB{roff(head)}\\fR\n{roff(text)}" for head, text in pairs]


def manual_of(command):
    name = f"patchlight-{command.name}"
    lines = [f".TH {name.upper()} 1", ".SH NAME", roff(f"{name} - {command.summary[0].lower()}{command.summary[1:-1]}"),
             ".SH SYNOPSIS", f".B {roff(command.usage)}", ".SH DESCRIPTION", roff(command.about), ".SH OPTIONS"]
    for title, options in in_groups(command.options).items():
        lines += [f".SS {roff(title)}"] + tagged((option.head, f"{option.help}. {option.more}".rstrip())
                                                 for option in options)
    lines.append(".SH EXAMPLES")
    for meaning, line in command.examples:
        lines += [".PP", roff(meaning[0].upper() + meaning[1:]) + ":", ".PP", ".nf", ".RS", roff(line), ".RE", ".fi"]
    if command.name in FILES:
        lines += [".SH FILES"] + tagged(FILES[command.name])
    others = ["patchlight"] + [f"patchlight-{other}" for other in SEE_ALSO[command.name]]
    lines += [".SH EXIT STATUS"] + tagged(EXIT_STATUS)
    lines += [".SH SEE ALSO", ", ".join(f"\\fB{roff(other)}\\fR(1)" for other in others)]
    return "\n".join(lines) + "\n"


def manual_of_tool(groups):
    lines = [".TH PATCHLIGHT 1", ".SH NAME", roff("patchlight - lighting simulation for rooms and buildings"),
             ".SH SYNOPSIS", ".B patchlight COMMAND [ARGUMENTS]", ".SH DESCRIPTION",
             "patchlight computes how light from lamps, luminaires, sun and sky spreads through a model, by finite\\-element "
             "radiosity. Every value has an error bar.", ".SH COMMANDS"]
    for title, commands in groups.items():
        lines += [f".SS {title}"] + tagged((f"{name}", f"{summary}. See patchlight-{name}(1).") for name, summary in commands)
    lines += [".SH OPTIONS"] + tagged([("-h, --help", "Print help."), ("--version", "Print the version.")])
    lines += [".SH EXAMPLES", ".nf", ".RS"]
    lines += [roff(line) for line in ("patchlight check room.obj", "patchlight init room.obj -o room.toml",
                                      "patchlight solve room.toml -o room.vtp --html room.html")]
    lines += [".RE", ".fi", ".SH EXIT STATUS"] + tagged(EXIT_STATUS)
    names = [f"patchlight\\-{roff(name)}" for commands in groups.values() for name, _ in commands]
    lines += [".SH SEE ALSO", ", ".join(f"\\fB{name}\\fR(1)" for name in names)]
    return "\n".join(lines) + "\n"


# Completion

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


def completion(commands):
    """Commands, then their options and the words that these take; files everywhere else."""
    choices, names = [], []
    for command in commands:
        options = [option for option in command.options if option.head.startswith("-")]
        names.append(f"        {command.name}) words=\"{' '.join(name for option in options for name in option.names())}\" ;;")
        for option in options:
            if re.fullmatch(r"[a-z0-9-]+(\|[a-z0-9-]+)+", option.value()):
                choices.append(f"      {command.name},{option.names()[-1]}) words=\"{option.value().replace('|', ' ')}\" ;;")
    return COMPLETION.format(commands=" ".join(command.name for command in commands) + " help --help --version",
                             choices="\n".join(choices), options="\n".join(names))


def group_of_page(page, title):
    """The options of a group on a page."""
    return next(part for part in re.split(r"(?m)^##+ ", page) if part.splitlines()[0] == title)


def missing_options(command, files):
    """Options that the help of a command has, but its manual page or its reference page does not."""
    manual = files[MAN / f"patchlight-{command.name}.1"]
    page = files[CLI / f"{command.name}.md"]
    whole = re.findall(rf"{ALL} \[[a-z ]+\]\(([a-z-]+)\.md\): (.+(?:\n  .+)*)", page)
    groups = [group_of_page(files[CLI / f"{home}.md"], title)
              for home, titles in whole for title in " ".join(titles.split()).split(", ")]
    for name in re.findall(r"(?m)^  (?:-\w, )?(--[\w-]+)", run(command.name, "--help")):
        if not re.search(re.escape(roff(name)) + r"(?!\w|\\-)", manual):
            yield f"docs/man/patchlight-{command.name}.1 has no {name}"
        if not any(re.search(re.escape(name) + r"(?![\w-])", text) for text in [page, *groups]):
            yield f"docs/reference/cli/{command.name}.md has no {name}"


def all_files():
    groups = groups_of_commands()
    commands = [command_of(name) for group in groups.values() for name, _ in group]
    users = {}
    for command in commands:
        for option in command.options:
            users.setdefault(option, []).append(command.name)
    homes = {option: "common-options" if len(names) >= SHARED else names[0] for option, names in users.items()}
    files = {CLI / "index.md": index_page(groups), CLI / "common-options.md": common_page(commands, homes),
             CLI / "exit-status.md": exit_page(), MAN / "patchlight.1": manual_of_tool(groups),
             DOCS / "patchlight.bash": completion(commands)}
    for command in commands:
        files[CLI / f"{command.name}.md"] = page_of(command, homes)
        files[MAN / f"patchlight-{command.name}.1"] = manual_of(command)
    note = "<!-- scripts/make_help.py writes this page. -->\n"
    return commands, {path: note + text if path.suffix == ".md" else text for path, text in files.items()}


def main():
    check = sys.argv[1:] == ["--check"]
    commands, files = all_files()
    there = {**files, **{path: path.read_text() for path in files if path.exists()}}
    problems = [line for command in commands for line in missing_options(command, there if check else files)]
    for path, content in files.items():
        name = path.relative_to(DOCS.parent)
        if path.exists() and path.read_text() == content:
            continue
        if check:
            problems.append(f"{name} is not up to date; run scripts/make_help.py")
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(content)
            print(f"wrote {name}")
    for problem in problems:
        print(problem, file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
