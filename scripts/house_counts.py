#!/usr/bin/env python3
"""Counts by which the joints of the code are judged, for one checkout or several.

usage: scripts/house_counts.py [ROOT...]    default: this repository
"""
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent.parent
# Look-alike passages are so many lines of code that stand in two places, but for blanks and what names are called.
PASSAGE = 7
LONG = 40


def code(root, *folders):
    """Text of every header and source file in these folders, by its path."""
    return {str(file.relative_to(root)): file.read_text() for folder in folders
            for file in sorted((root / folder).rglob("*")) if file.suffix in (".h", ".cpp")}


def without_comments(text):
    return re.sub(r"//.*", "", text)


def naming(files, pattern, outside=()):
    """Files, but for those below some folders, whose code has the pattern."""
    return [name for name, text in files.items()
            if re.search(pattern, without_comments(text)) and not name.startswith(tuple(outside))]


def long_functions(files):
    """Places of functions whose body, with its head, is longer than LONG lines: from a line that ends with an opening
    brace after a parenthesis to the closing brace below its beginning."""
    found = []
    for name, text in files.items():
        lines = text.splitlines()
        begin = None
        for number, line in enumerate(lines):
            if begin is None and re.match(r"(?!namespace|class|struct|enum|union)\S.*[({,]$|\S.*\) (const )?{$", line):
                begin = number
            if begin is not None and line.startswith("}"):
                if number - begin + 1 > LONG and "(" in lines[begin]:
                    found.append(f"{name}:{begin + 1}")
                begin = None
            elif begin is not None and line == "":
                if not any(part.endswith("{") for part in lines[begin:number]):
                    begin = None
    return found


def passages(files):
    """How many runs of PASSAGE lines or more stand in a second place."""
    places = {}
    for name, text in files.items():
        lines = [(number, re.sub(r"\b[a-z_]\w*\b", "x", line.split("//")[0].strip()))
                 for number, line in enumerate(text.splitlines())]
        lines = [(number, line) for number, line in lines if len(line) > 3 and not line.startswith("#")]
        for k in range(len(lines) - PASSAGE + 1):
            window = "\n".join(line for _, line in lines[k:k + PASSAGE])
            places.setdefault(window, []).append((name, k))
    again = sorted(place for same in places.values() for place in same[1:])
    return sum(1 for k, (name, line) in enumerate(again) if k == 0 or again[k - 1] != (name, line - 1))


def counts(root):
    files = code(root, "include", "src")
    copies = [hit for text in files.values()
              for hit in re.findall(r"\bplan\.([\w.]+) = request\.\1\b|\brequest\.([\w.]+) = plan\.\2\b", text)]
    return {
        "files outside of transport and archive that name tiles":
            len(naming(files, r"(?<!::)\btiles?\b|tile_edge", ("src/transport/", "include/patchlight/transport/", "src/archive/", "src/render/"))),
        "files in which `on_demand` is asked for": len(naming(files, r"\bon_demand\b(?!_)")),
        "fields copied by hand between Request and Plan": len(copies),
        "files that build an Occluder": len(naming(files, r"\bOccluder>?\(\w|\bOccluder \w+\(", ("src/visibility/occluder", "include/patchlight/visibility/occluder"))),
        "public headers": sum(name.startswith("include/") for name in files),
        "files at the root of src": sum(name.count("/") == 1 for name in files if name.startswith("src/")),
        "files that multiply by reflectance":
            len(naming(files, r"reflectance(\.\w+\([^)]*\))* \*|\* \w*\.?reflectance|rho \*|\* rho\b")),
        "files of the solvers with dots or norms of their own":
            len([name for name in naming(files, r"\.(dot|squaredNorm|norm)\(|\.square\(\)\.(sum|colwise)")
                 if name.startswith("src/solve/")]),
        "messages of the library that name options of the tool":
            sum(len(re.findall(r'"[^"\n]*--[a-z][^"\n]*"', without_comments(text))) for name, text in files.items()
                if not name.startswith("src/cli/")),
        f"functions over {LONG} lines": len(long_functions(files)),
        f"passages of {PASSAGE} lines that stand twice": passages(files),
    }


def main():
    roots = [pathlib.Path(word) for word in sys.argv[1:]] or [HERE]
    columns = [counts(root) for root in roots]
    print("| counted |" + "".join(f" {root.name or root} |" for root in roots))
    print("|---|" + "---|" * len(roots))
    for what in columns[0]:
        print(f"| {what} |" + "".join(f" {column[what]} |" for column in columns))


if __name__ == "__main__":
    main()
