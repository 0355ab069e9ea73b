"""The core is configured with its own packages alone, none of which knows a file format, and its files compile so.

usage: core_alone_test.py BUILD_FOLDER VERSION CMAKE COMPILER
"""
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
OF_CORE = {"Eigen3", "embree", "OpenMesh", "GEOS", "TBB", "Boost"}
OF_FILES = """tinyobjloader assimp TinyGLTF tomlplusplus nlohmann_json pugixml draco meshoptimizer OpenSSL ZLIB PkgConfig
OpenEXR VTK CLI11 pybind11 GTest""".split()
# The fastest to compile of the files that include more than the standard library.
FILES = ("src/base/parallel.cpp", "src/mesh/noded_lines.cpp")


def run(*words):
    return subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True).stdout


def main(_build, _version, cmake, compiler):
    with tempfile.TemporaryDirectory(prefix="patchlight-core-") as name:
        folder = pathlib.Path(name)
        run(cmake, "-S", ROOT, "-B", folder, "-G", "Ninja", "-DPATCHLIGHT_IO=OFF", "-DPATCHLIGHT_UNITY=OFF",
            f"-DCMAKE_CXX_COMPILER={compiler}", "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_CXX_FLAGS_DEBUG=-O0",
            *(f"-DCMAKE_DISABLE_FIND_PACKAGE_{package}=ON" for package in OF_FILES))
        targets = run("ninja", "-C", folder, "-t", "targets", "all")
        assert "src/libpatchlight_core.a:" in targets
        for other in ("patchlight_io", "patchlight_cli", "patchlight_tool", "page_parts"):
            assert other not in targets, other
        run("ninja", "-C", folder, *(f"src/CMakeFiles/patchlight_core.dir/{file.removeprefix('src/')}.o" for file in FILES))

        # The installed core's CMake configuration finds the same packages.
        found = {line.split("(")[1].split()[0].rstrip(")") for line in (folder / "patchlightConfig.cmake").read_text().splitlines()
                 if line.startswith("find_dependency(")}
        assert found == OF_CORE, found


main(*sys.argv[1:])
