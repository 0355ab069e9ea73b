"""All outputs have the same bytes in locales with a decimal comma or a dotted capital I.

PATCHLIGHT_TAKE_LOCALE may name a library that makes the tool use the locale of its environment; by default it stays
with the C locale."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

from support import TOOL, ToolTest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "scripts"))
import mutate  # noqa: E402  it holds a scene file with everything

CODES = [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 2]  # of the commands

LOCALES = ["de_DE", "tr_TR"]

COMMANDS = [
    "check room.obj",
    "check scene.toml",
    "check room.stl",
    "check ROOM.IFC",
    "plan scene.toml",
    "solve scene.toml -q --patches 60 -o a.ply -o a.glb -o a.vtp --picture a.png --size 80x60 --false-color luminance"
    " --json report.json --points-output a.csv --points-output points.vtp",
    "solve daylight.toml -q --patches 60 -o daylight.ply --set wh*.reflectance=0.25,0.5,0.75",
    "solve room.obj -q --unit ft --max-edge 1.5 --series series.pvd",
    "form-factors room.obj -q --patches 60 -o F",
    "relight F -q -o relit.ply",
    "solve room.obj --max-edge 0,5 -o never.ply",
    "solve broken.toml -o never.ply",
]


def made(name, folder):
    """Whether the locale can be made in the folder, where LOCPATH makes the C library look for it."""
    if shutil.which("localedef") is None:
        return False
    done = subprocess.run(["localedef", "-i", name, "-f", "UTF-8", folder / f"{name}.UTF-8"], capture_output=True,
                          check=False)
    return done.returncode == 0


def reproducible(value):
    """The value without measured times and memory."""
    if isinstance(value, dict):
        return {key: reproducible(entry) for key, entry in value.items()
                if "second" not in key and key != "memory_peak_bytes"}
    return [reproducible(entry) for entry in value] if isinstance(value, list) else value


def comparable(path):
    """The bytes of a file, without the times in it."""
    if path.suffix == ".json":
        return json.dumps(reproducible(json.loads(path.read_text())))
    if path.suffix == ".vtp" and path.name in ("a.vtp", "points.vtp"):
        # Names and ranges of the arrays only, as their compressed length depends on the times among them.
        text = path.read_bytes().split(b"<AppendedData")[0].decode()
        lines = [line for line in re.sub(r'offset="\d+"\s*', "", text).splitlines() if "seconds" not in line]
        return "\n".join(lines)
    return path.read_bytes()


class LocaleTest(ToolTest):
    def results(self, environment):
        """The output of every command, and all files."""
        with tempfile.TemporaryDirectory(prefix="patchlight-locale-") as name:
            folder = pathlib.Path(name)
            shutil.copytree(self.folder, folder, dirs_exist_ok=True)
            said = {}
            for command in COMMANDS:
                done = subprocess.run([TOOL, *command.split()], cwd=folder, env={**os.environ, **environment},
                                      capture_output=True, text=True, check=False)
                text = done.stdout + done.stderr
                if command.startswith("plan"):
                    # Estimated times vary, so only the format of these numbers is compared.
                    text = re.sub(r"\d+(\.\d+)?", "1", text)
                said[command] = (done.returncode, text)
            files = {str(path.relative_to(folder)): comparable(path) for path in folder.rglob("*") if path.is_file()}
        return said, files

    def test_same_bytes(self):
        self.write("room.obj", mutate.ROOM)
        self.write("scene.toml", mutate.SCENE)
        self.write("daylight.toml", mutate.SCENE + mutate.SKIES[1])
        self.write("broken.toml", mutate.SCENE.replace("0.5, 0.4", "1.5, 0.4"))
        self.write("lamp.ies", mutate.IES)
        self.write("spots.pts", mutate.POINTS)
        self.write("room.stl", (mutate.CORPUS / "stl" / "room.stl").read_text())
        self.write("ROOM.IFC", (mutate.CORPUS / "ifc" / "room.ifc").read_text())
        loader = os.environ.get("PATCHLIGHT_TAKE_LOCALE", "")
        plain = self.results({"LC_ALL": "C"})
        self.assertEqual([code for code, _ in plain[0].values()], CODES, plain[0])
        with tempfile.TemporaryDirectory(prefix="patchlight-locale-") as name:
            there = [locale for locale in LOCALES if made(locale, pathlib.Path(name))]
            for locale in there:
                with self.subTest(locale=locale):
                    environment = {"LOCPATH": name, "LC_ALL": f"{locale}.UTF-8"}
                    comma = subprocess.run(["locale", "decimal_point"], env={**os.environ, **environment},
                                           capture_output=True, text=True, check=True).stdout
                    self.assertEqual(comma, ",\n")
                    other = self.results({**environment, "LD_PRELOAD": loader})
                    self.assertEqual(plain[0], other[0])
                    self.assertEqual(plain[1].keys(), other[1].keys())
                    for file, content in plain[1].items():
                        self.assertEqual(content, other[1][file], file)
        missing = sorted(set(LOCALES) - set(there))
        if missing:
            self.skipTest(f"localedef cannot make {', '.join(missing)}: the package locales is not installed")


if __name__ == "__main__":
    unittest.main()
