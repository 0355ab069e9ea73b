#!/usr/bin/env python3
"""Checks that modules include only the modules and libraries that scripts/layers.txt allows.

usage: scripts/check_layers.py [ROOT]    ROOT holds include/, src/ and scripts/layers.txt; default: this repository
"""
import pathlib
import re
import sys

INCLUDE = re.compile(r'^\s*#\s*include\s+(?:"([^"]+)"|<([^>]+)>)')
STANDARD = re.compile(r"^[a-z_]+$")  # <vector>, <cmath>: neither dot nor slash


def read_layers(file):
    """Sections of the file: {section: {name: set of modules}}; names keep their order."""
    sections, section = {}, None
    for line in file.read_text().splitlines():
        line = line.split("#")[0].strip()
        if line.startswith("["):
            section = sections.setdefault(line.strip("[]"), {})
        elif line:
            name, modules = line.split(":")
            section[name.strip()] = set(modules.split())
    return sections


def check_order(modules):
    """A module may only name earlier ones."""
    seen = set()
    for name, allowed in modules.items():
        for later in sorted(allowed - seen):
            yield f"scripts/layers.txt: {name} names {later}, which is not an earlier module"
        seen.add(name)


def module_of(path):
    """Module of a path below include/patchlight or src: its folder; of those at the top, headers are of the pipeline."""
    parts = pathlib.PurePosixPath(path).parts
    if len(parts) > 1:
        return parts[0]
    return "pipeline" if path.endswith(".h") else "simulate"


def check_include(module, public, quoted, angled, layers):
    """The fault of one include line, or None."""
    if quoted:
        other = module_of(quoted.removeprefix("patchlight/"))
        if other == module or other in layers["modules"][module]:
            return None
        return f"{module} may not include {other}"
    if STANDARD.match(angled):
        return None
    for prefix, allowed in (layers["libraries"] | layers["system"]).items():
        if not angled.startswith(prefix):
            continue
        if public and prefix != "Eigen/":
            return f"a public header may not include <{angled}>"
        return None if module in allowed else f"{module} may not include <{angled}>"
    return f"<{angled}> is not in scripts/layers.txt"


def check_files(root, layers):
    for top in ("include/patchlight", "src"):
        for file in sorted((root / top).rglob("*")):
            # The header of all headers belongs to no module.
            if file.suffix not in (".h", ".cpp") or file.name == "patchlight.h":
                continue
            name = file.relative_to(root)
            module = module_of(file.relative_to(root / top).as_posix())
            if module not in layers["modules"]:
                yield f"{name}: module {module} is not in scripts/layers.txt"
                continue
            for number, line in enumerate(file.read_text().splitlines(), 1):
                match = INCLUDE.match(line)
                wrong = match and check_include(module, top != "src", match[1], match[2], layers)
                if wrong:
                    yield f"{name}:{number}: {wrong}"


def main():
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent
    layers = read_layers(root / "scripts" / "layers.txt")
    faults = list(check_order(layers["modules"])) + list(check_files(root, layers))
    for fault in faults:
        print(fault, file=sys.stderr)
    print(f"layers: {len(layers['modules'])} modules, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
