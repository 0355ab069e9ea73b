"""The Debian packages name their dependencies and work when unpacked elsewhere.

usage: debian_test.py BUILD_FOLDER VERSION CMAKE COMPILER
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


def output(*words, **options):
    return subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True, **options).stdout


def dependencies(deb):
    """The names of the required packages; the first of alternatives."""
    return [re.match(r"[^ (|]+", entry)[0] for entry in output("dpkg-deb", "-f", deb, "Depends").strip().split(", ") if entry]


def installed(package):
    done = subprocess.run(["dpkg-query", "-W", "-f", "${db:Status-Status}", package], capture_output=True, text=True,
                          check=False)
    return done.stdout.startswith("installed")


def faults(debs):
    """Faults found by lintian, Debian's own check, if installed, except for the missing address of the project."""
    if shutil.which("lintian") is None:
        return []
    found = subprocess.run(["lintian", "--allow-root", *map(str, debs)], capture_output=True, text=True, check=False)
    assert found.returncode in (0, 2), found.stderr  # 2: it has found something
    found = found.stdout
    return [line for line in found.splitlines() if line[:2] in ("E:", "W:") and "bogus-mail-host" not in line]


def check_pages(usr):
    """The tool's package has every page that the tool names, with the pages that it links; that of pages has the models."""
    pages = usr / "share" / "doc" / "patchlight" / "md"
    sources = "".join(file.read_text(encoding="utf-8") for file in sorted((ROOT / "src").rglob("*.cpp")))
    topics = set(re.findall(r"patchlight help ([a-z][a-z-]+)", sources))
    assert {"scene-file", "exit-status"} <= topics, topics
    for topic in topics:
        assert output(usr / "bin" / "patchlight", "help", topic), topic
    for page in pages.rglob("*.md"):
        for target in re.findall(r"\]\(([\w./-]+\.md)(?:#[\w-]+)?\)", page.read_text(encoding="utf-8")):
            there = (page.parent / target).resolve()
            assert there.is_file() or pages not in there.parents, f"{page} links to {target}"
    documents = usr / "share" / "doc" / "patchlight-doc"
    assert (documents / "html" / "index.html").is_file() or (documents / "markdown" / "index.md").is_file()
    assert {path.name for path in (documents / "examples" / "meshes").iterdir()} >= {"study.obj", "flat.ifc", "panel.ies"}
    assert (documents / "examples" / "scripts" / "paraview_view.py").is_file()


def main(build, version, cmake, _compiler):
    cpack = pathlib.Path(cmake).with_name("cpack")
    with tempfile.TemporaryDirectory(prefix="patchlight-debian-") as name:
        folder = pathlib.Path(name)
        output(cpack, "--config", pathlib.Path(build) / "CPackConfig.cmake", "-B", folder)
        debs = {output("dpkg-deb", "-f", deb, "Package").strip(): deb for deb in folder.glob("*.deb")}
        assert set(debs) - {"python3-patchlight"} == {"patchlight", "libpatchlight-dev", "patchlight-doc"}, debs
        assert not faults(debs.values()), faults(debs.values())
        for deb in debs.values():
            assert output("dpkg-deb", "-f", deb, "Version").strip() == version
            print(output("dpkg", "-I", deb))
            for package in dependencies(deb):
                assert installed(package), f"{deb.name} needs {package}, which patchlight was not built with"
            output("dpkg-deb", "-x", deb, folder / "root")

        # The tool needs libraries; the library needs the packages that it was built with.
        needed = dependencies(debs["patchlight"])
        for package in ("libembree3-3", "libtbb12", "libvtk9.1", "libc6", "libstdc++6"):
            assert package in needed, f"patchlight does not depend on {package}: {needed}"
        assert not any(package.endswith("-dev") for package in needed), needed
        wanted = set(re.findall(r"\bz?lib[a-z0-9+-]+-dev|nlohmann-json3-dev",
                                (ROOT / "scripts" / "install_packages.sh").read_text()))
        missing = wanted - {"libcli11-dev", "libgtest-dev", "libclang-rt-14-dev"} - set(dependencies(debs["libpatchlight-dev"]))
        assert not missing, f"libpatchlight-dev does not depend on {missing}"

        usr = folder / "root" / "usr"
        if "python3-patchlight" in debs:
            # Isolated from other installations: -I ignores PYTHONPATH and the folder of the script.
            packages = usr / "lib" / "python3" / "dist-packages"
            text = (f"import sys; sys.path.insert(0, {str(packages)!r}); import patchlight as pl; "
                    f"print(pl.__file__, pl.solve({str(ROOT / 'meshes/furnace_cube.obj')!r}, patches=60).size)")
            said = output("/usr/bin/python3", "-I", "-c", text, cwd=folder)
            assert str(packages) in said, said
        output(usr / "bin" / "patchlight", "solve", ROOT / "meshes" / "furnace_cube.obj", "--patches", 100, "-o",
               folder / "cube.glb")
        for file in ("share/man/man1/patchlight.1.gz", "share/man/man1/patchlight-solve.1.gz", "share/doc/patchlight/changelog.gz", "share/doc/patchlight/copyright", "include/patchlight/simulate.h"):
            assert (usr / file).is_file(), file
        check_pages(usr)


main(*sys.argv[1:])
