"""patchlight render: pictures of a solution on disk."""
import os
import pty
import re
import signal
import struct
import subprocess
import unittest
import zlib

from support import TOOL, ToolTest


def radiances(data):
    """(header, rows of (r, g, b)) of a .hdr with run-length encoded scanlines, by the published format: Ward 1991,
    Real pixels."""
    header, rest = data.split(b"\n\n", 1)
    size, rest = rest.split(b"\n", 1)
    height, width = (int(word) for word in size.split()[1::2])
    at, rows = 0, []
    for _ in range(height):
        assert rest[at:at + 4] == bytes([2, 2, width >> 8, width & 255])
        at += 4
        line = bytearray()
        while len(line) < 4 * width:
            count = rest[at]
            if count > 128:
                line += bytes([rest[at + 1]]) * (count - 128)
                at += 2
            else:
                line += rest[at + 1:at + 1 + count]
                at += 1 + count
        for x in range(width):
            mantissas, exponent = line[x:3 * width:width], line[3 * width + x]
            scale = 2.0 ** (exponent - 136) if exponent else 0
            rows.append([(m + 0.5) * scale for m in mantissas])
    assert at == len(rest)
    return header, rows

GOOD, USAGE, INPUT, INTERRUPTED = 0, 1, 2, 130

SCENE = """[[model]]
file = "room.obj"

[[camera]]
name = "near"
eye = [0.5, 0.5, 1.5]
target = [0, 0, 1]

[[camera]]
name = "plan"
eye = [0, 0, 1.9]
target = [0, 0, 0]
projection = "orthographic"
height = 2
"""

SMALL = ["--size", "24x16", "-q"]


class RenderTest(ToolTest):
    def good(self, *words):
        done = self.run_tool(*words)
        self.assertEqual(done.returncode, GOOD, done.stdout + done.stderr)
        return done

    def refused(self, code, *words):
        done = self.run_tool(*words)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stderr

    def solve(self, *words):
        self.good("solve", "room.obj", "--patches", "200", "-o", "room.vtp", "-q", *words)

    def bytes_of(self, name):
        return (self.folder / name).read_bytes()

    def test_a_picture_of_a_file_is_that_of_the_run(self):
        # The file has single precision, so the picture equals that of the run except for rounding to eight bits.
        self.solve("--picture", "of_run.hdr", "--picture-quality", "final", "--size", "24x16")
        self.good("render", "room.obj", "--solution", "room.vtp", "-o", "of_file.hdr", *SMALL)
        (run_header, run), (file_header, file) = (radiances(self.bytes_of(name)) for name in ("of_run.hdr", "of_file.hdr"))
        self.assertEqual(run_header, file_header)
        self.assertEqual(len(run), 24 * 16)
        # Rounding radiosities to single precision changes a mantissa of eight bits by at most one step.
        for a, b in zip(run, file):
            for x, y in zip(a, b):
                self.assertLessEqual(abs(x - y), 1.01 * max(a) / 128)
        self.assertGreater(max(max(pixel) for pixel in run), 0)

    def test_pictures_are_the_same_on_one_thread_and_two(self):
        self.solve()
        for threads in ("1", "2"):
            self.good("render", "room.obj", "--solution", "room.vtp", "-o", threads + ".exr", "--threads", threads, *SMALL)
        self.assertEqual(self.bytes_of("1.exr"), self.bytes_of("2.exr"))

    def test_several_views_have_their_names(self):
        self.write("scene.toml", SCENE)
        self.good("solve", "scene.toml", "--patches", "200", "-o", "scene.vtp", "-q")
        self.good("render", "scene.toml", "--solution", "scene.vtp", "--view", "near", "--view", "plan", "-o", "room.png",
                  "--picture-error-map", "errors.png", *SMALL)
        names = sorted(file.name for file in self.folder.glob("*.png"))
        self.assertEqual(names, ["errors.near.png", "errors.plan.png", "room.near.png", "room.plan.png"])

    def test_other_cameras_are_taken_and_other_lights_refused(self):
        self.write("scene.toml", SCENE)
        self.good("solve", "scene.toml", "--patches", "200", "-o", "scene.vtp", "-q")
        self.write("scene.toml", SCENE.replace("0.5, 0.5, 1.5", "0.4, 0.4, 1.4"))
        self.good("render", "scene.toml", "--solution", "scene.vtp", "-o", "room.png", *SMALL)
        message = self.refused(INPUT, "render", "scene.toml", "--sky", "overcast", "--solution", "scene.vtp", "-o",
                               "other.png", *SMALL)
        self.assertIn("scene.vtp", message)
        self.assertIn("another scene", message)
        self.assertFalse((self.folder / "other.png").exists())

    def test_observers_have_a_line_each(self):
        self.write("scene.toml", SCENE)
        self.good("solve", "scene.toml", "--patches", "200", "-o", "scene.vtp", "-q")
        self.good("render", "scene.toml", "--solution", "scene.vtp", "--observers", "all.csv", "-q")
        lines = (self.folder / "all.csv").read_text().splitlines()
        self.assertEqual([line.split(",")[0] for line in lines], ["observer", "near", "plan"])
        self.good("render", "scene.toml", "--solution", "scene.vtp", "--observers", "one.csv", "--view", "plan", "-q")
        self.assertEqual((self.folder / "one.csv").read_text().splitlines()[1:], lines[2:])

    def test_observers_stand_at_a_camera_without_a_picture(self):
        self.write("scene.toml", SCENE)
        self.good("solve", "scene.toml", "--patches", "200", "-o", "scene.vtp", "-q")
        both = ["render", "scene.toml", "--solution", "scene.vtp", "-q", "--observers"]
        self.good(*both, "view.csv", "--view", "near")
        self.good(*both, "camera.csv", "--camera", "0.5,0.5,1.5", "0,0,1", "60")
        view, camera = ((self.folder / name).read_text().splitlines()[1] for name in ("view.csv", "camera.csv"))
        self.assertEqual(view.split(",")[1:], camera.split(",")[1:])
        self.assertEqual([view.split(",")[0], camera.split(",")[0]], ["near", "camera"])
        self.assertFalse(list(self.folder.glob("*.png")))

    def srgb(self, *words):
        """The colors of an image, row by row, and its exposure."""
        self.good("render", *words, "--picture-quality", "draft", "--size", "24x16", "-o", "shown.png", "-q")
        return self.shown("shown.png")

    def shown(self, name):
        data = self.bytes_of(name)
        at, parts, exposure = 8, b"", None
        while at < len(data):
            size, = struct.unpack(">I", data[at:at + 4])
            kind, content = data[at + 4:at + 8], data[at + 8:at + 8 + size]
            parts += content if kind == b"IDAT" else b""
            if kind == b"tEXt" and content.startswith(b"Exposure"):
                exposure = float(content.split(b"\0")[1].split()[0])
            at += 12 + size
        return zlib.decompress(parts), exposure

    def test_an_exposure_given_is_that_of_the_image(self):
        self.solve()
        of_room = ["room.obj", "--solution", "room.vtp"]
        pixels, automatic = self.srgb(*of_room)
        self.assertEqual(self.srgb(*of_room, "--exposure", repr(automatic)), (pixels, automatic))
        for stops, factor in (("+1", 2), ("-2", 0.25), ("+0", 1)):
            other, exposure = self.srgb(*of_room, "--exposure", stops)
            self.assertEqual(exposure, factor * automatic)
            self.assertEqual(self.srgb(*of_room, "--exposure", repr(exposure)), (other, exposure))
            self.assertEqual(other == pixels, factor == 1)

    def test_views_of_a_run_have_one_exposure_and_one_scale(self):
        self.write("scene.toml", SCENE)
        self.good("solve", "scene.toml", "--patches", "200", "-o", "scene.vtp", "-q")
        of_scene = ["scene.toml", "--solution", "scene.vtp"]
        near = self.srgb(*of_scene, "--view", "near")
        plan = self.srgb(*of_scene, "--view", "plan")
        self.assertNotEqual(near[1], plan[1])
        both = ["render", *of_scene, "--view", "near", "--view", "plan", "--picture-quality", "draft", *SMALL]
        self.good(*both, "-o", "own.png", "--exposure", "each")
        self.assertEqual([self.shown("own.near.png"), self.shown("own.plan.png")], [near, plan])
        self.good(*both, "-o", "room.png")
        self.assertEqual(self.shown("room.near.png"), near)
        self.assertEqual(self.shown("room.plan.png"), self.srgb(*of_scene, "--view", "plan", "--exposure", repr(near[1])))
        # A scale of colors that is given, and that of the first
        self.good(*both, "-o", "given.png", "--false-color", "luminance:1")
        alone = self.srgb(*of_scene, "--view", "plan", "--false-color", "luminance:1")
        self.assertEqual(self.shown("given.plan.png"), alone)
        self.good(*both, "-o", "first.png", "--false-color", "luminance")
        self.assertEqual(self.shown("first.near.png"), self.srgb(*of_scene, "--view", "near", "--false-color", "luminance"))
        self.assertNotEqual(self.shown("first.plan.png"), alone)

    def test_an_error_that_is_not_reached_is_told_with_how_to_mend_it(self):
        self.solve()
        words = ["render", "room.obj", "--solution", "room.vtp", "-o", "room.exr", "--size", "24x16"]
        told = self.good(*words, "--picture-error", "0.01%", "--picture-samples", "4").stderr
        reached = re.search(r"warning: room\.exr: .* ([\d.]+)% .* 0\.01% .*--picture-error", told)
        self.assertGreater(float(reached[1]), 0.01)
        self.assertGreater(int(re.search(r"--picture-samples (\d+)", told)[1]), 4)
        self.assertNotIn("warning: ", self.good(*words, "--picture-error", "50%").stderr)
        self.assertIn("power of two", self.refused(USAGE, *words, "--picture-samples", "65"))

    def test_two_solutions_stand_beside_each_other(self):
        self.solve()
        self.good("solve", "room.obj", "--patches", "400", "-o", "fine.vtp", "-q")
        self.good("render", "room.obj", "--solution", "room.vtp", "--difference", "fine.vtp", "-o", "both.png", *SMALL)
        # Width and height of a PNG follow its first 16 bytes.
        width, height = struct.unpack(">2I", self.bytes_of("both.png")[16:24])
        self.assertEqual(height, 16)
        self.assertGreater(width, 3 * 24)

    def test_after_ctrl_c_no_other_view_begins(self):
        self.write("scene.toml", SCENE)
        self.good("solve", "scene.toml", "--patches", "200", "-o", "scene.vtp", "-q")
        ours, theirs = pty.openpty()
        command = [TOOL, "render", "scene.toml", "--solution", "scene.vtp", "--view", "near", "--view", "plan", "-o",
                   "room.png", "--size", "1200x1200"]
        with subprocess.Popen(command, cwd=self.folder, stdout=theirs, stderr=theirs) as process:
            os.close(theirs)
            shown = b""
            while not re.search(rb"render, [7-9]\d %", shown):  # the first samples of each pixel are there
                shown += os.read(ours, 4096)
            process.send_signal(signal.SIGINT)
            while True:
                try:
                    if not os.read(ours, 4096):
                        break
                except OSError:
                    break
        os.close(ours)
        self.assertEqual(process.returncode, INTERRUPTED)
        self.assertEqual(sorted(file.name for file in self.folder.glob("*.png")), ["room.near.png"])

    def test_refuses_what_is_no_solution(self):
        self.write("text.vtp", "no file of VTK\n")
        self.assertIn("text.vtp", self.refused(INPUT, "render", "room.obj", "--solution", "text.vtp", "-o", "a.png"))
        alone = self.refused(USAGE, "render", "room.vtp", "-o", "a.png")
        self.assertIn("--solution room.vtp", alone)
        grid = self.refused(USAGE, "render", "room.obj", "--solution", "room.vtu", "-o", "a.png")
        self.assertIn("-o RESULT.vtp", grid)
        self.assertIn("none.vtp", self.refused(INPUT, "render", "room.obj", "--solution", "none.vtp", "-o", "a.png"))

    def test_refuses_options_that_contradict_each_other(self):
        for words, named in (
            (["-o", "a.gif"], "-o"),
            (["-o", "a.png", "--size", "12"], "--size"),
            (["-o", "a.png", "--picture-quality", "draft", "--picture-error", "1%"], "--picture-error"),
            (["-o", "a.hdr", "--false-color", "luminance"], "--false-color"),
            (["-o", "a.png", "--projection", "panorama"], "--projection"),
            (["-o", "a.exr", "--exposure", "2"], "--exposure"),
            (["-o", "a.png", "--exposure", "0"], "--exposure"),
            (["-o", "a.png", "--exposure", "+bright"], "--exposure"),
            (["-o", "a.png", "--exposure", "2", "--false-color", "luminance"], "luminance:END"),
            (["-o", "a.png", "--false-color", "luminance:0"], "--false-color"),
            (["--observers", "a.csv", "--exposure", "2"], "--exposure"),
            (["-o", "a.png", "--view", "one/two", "--view", "one:two"], "-o"),
            (["-o", "a.png", "--view", "one", "--view", "two", "--picture-error-map", "../{}/a.png"], "--picture-error-map"),
            (["-o", "a.png", "--camera", "0,0,1", "1,0,1", "190"], "--camera"),
            ([], "-o"),
        ):
            words = [word.format(self.folder.name) for word in words]
            message = self.refused(USAGE, "render", "room.obj", "--solution", "room.vtp", *words)
            self.assertIn(named, message)


if __name__ == "__main__":
    unittest.main()
