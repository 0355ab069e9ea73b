"""A project of a few lines finds the installed library, builds with it and solves the furnace cube.

usage: consumer_test.py BUILD_FOLDER VERSION CMAKE COMPILER
"""
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
MODEL = HERE.parent.parent / "meshes" / "furnace_cube.obj"


def run(*words):
    subprocess.run([str(word) for word in words], check=True)


def main(build, version, cmake, compiler):
    with tempfile.TemporaryDirectory(prefix="patchlight-consumer-") as name:
        folder = pathlib.Path(name)
        installed = folder / "installed"
        run(cmake, "--install", build, "--prefix", installed)
        run(cmake, "-S", HERE / "consumer", "-B", folder / "build", "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={installed}",
            f"-DCMAKE_CXX_COMPILER={compiler}")
        run(cmake, "--build", folder / "build")
        run(folder / "build" / "consumer", MODEL, folder / "cube.ply")
        assert (folder / "cube.ply").read_bytes().startswith(b"ply\n")

        # What is installed is the tool, its manual and every public header, and it is moved as a whole.
        shown = subprocess.run([installed / "bin" / "patchlight", "--version"], check=True, capture_output=True, text=True)
        assert shown.stdout == f"patchlight {version}\n", shown.stdout
        assert (installed / "share" / "man" / "man1" / "patchlight.1").is_file()
        public = HERE.parent.parent / "include"
        for header in public.rglob("*.h"):
            assert (installed / "include" / header.relative_to(public)).is_file(), header
        for file in installed.rglob("*.cmake"):
            text = file.read_text()
            assert str(build) not in text and str(installed) not in text, f"{file.name} names a folder of the build"


main(*sys.argv[1:])
