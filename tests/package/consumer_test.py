"""Small projects find the installed library and build with it. One solves the furnace cube, the other uses the
core alone, which needs nothing that reads or writes files.

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


def linked(program, libraries):
    """The given libraries that the program loads, directly or indirectly."""
    loaded = subprocess.run(["ldd", program], check=True, capture_output=True, text=True).stdout
    return {name for name in libraries if f"lib{name}" in loaded}


def main(build, version, cmake, compiler):
    with tempfile.TemporaryDirectory(prefix="patchlight-consumer-") as name:
        folder = pathlib.Path(name)
        installed = folder / "installed"
        run(cmake, "--install", build, "--prefix", installed)

        def build_project(name, to, flags=""):
            run(cmake, "-S", HERE / name, "-B", folder / to, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={installed}",
                f"-DCMAKE_CXX_COMPILER={compiler}", f"-DCMAKE_CXX_FLAGS={flags}")
            run(cmake, "--build", folder / to)

        for name in ("consumer", "consumer_of_core"):
            build_project(name, name)
        run(folder / "consumer" / "consumer", MODEL, folder / "cube.ply")
        run(folder / "consumer" / "own_solver", MODEL)
        assert (folder / "cube.ply").read_bytes().startswith(b"ply\n")

        # Each side can free the other's values, whatever instructions each side is compiled for.
        build_project("consumer", "native", "-O2 -march=native")
        run(folder / "native" / "consumer", MODEL, folder / "native.ply")
        run(folder / "native" / "own_solver", MODEL)
        assert (folder / "native.ply").read_bytes() == (folder / "cube.ply").read_bytes()

        # The core is linked only with the libraries for meshes and rays.
        core = folder / "consumer_of_core" / "consumer_of_core"
        run(core)
        of_files = {"vtk", "cairo", "assimp", "tinygltf", "stb", "crypto"}
        assert linked(folder / "consumer" / "consumer", of_files | {"embree"}) == of_files | {"embree"}
        assert linked(core, of_files | {"embree"}) == {"embree"}, linked(core, of_files)

        # The installation has the tool, its manual and every public header, and can be moved as a whole.
        shown = subprocess.run([installed / "bin" / "patchlight", "--version"], check=True, capture_output=True, text=True)
        assert shown.stdout == f"patchlight {version}\n", shown.stdout
        for manual in ("patchlight.1.gz", "patchlight-solve.1.gz"):
            assert (installed / "share" / "man" / "man1" / manual).is_file(), manual
        public = HERE.parent.parent / "include"
        for header in public.rglob("*.h"):
            assert (installed / "include" / header.relative_to(public)).is_file(), header
        for file in installed.rglob("*.cmake"):
            text = file.read_text()
            assert str(build) not in text and str(installed) not in text, f"{file.name} names a folder of the build"


main(*sys.argv[1:])
