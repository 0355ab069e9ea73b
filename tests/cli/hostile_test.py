"""Invalid input and environments give the documented exit code and one sentence, and destroy no files."""
import json
import os
import pathlib
import re
import resource
import signal
import struct
import subprocess
import time
import unittest
import zlib

from support import MATERIALS, ROOM, TOOL, ToolTest, is_one_message

USAGE, INPUT, NOT_CONVERGED, MEMORY, OUTPUT = 1, 2, 3, 4, 6

SCENE = '[[model]]\nfile = "room.obj"\n'


def solve(*more):
    return ("solve", "room.obj", "--patches", "40", "-q", *more)


def scaled(factor):
    lines = [line.split() for line in ROOM.splitlines()]
    return "".join(" ".join([word[0], *(repr(float(x) * factor) for x in word[1:])] if word[0] == "v" else word) + "\n"
                   for word in lines)


class HostileTest(ToolTest):
    def refused(self, code, named, *arguments, **run):
        done = subprocess.run([TOOL, *arguments], cwd=self.folder, capture_output=True, text=True, errors="replace",
                              timeout=20, check=False, **run)
        self.assertEqual(done.returncode, code, (arguments, done.stderr[-500:]))
        self.assertTrue(is_one_message(done.stderr), done.stderr[-500:])
        for word in named:
            self.assertIn(word, done.stderr)
        return done

    def good(self, *arguments, **run):
        done = subprocess.run([TOOL, *arguments], cwd=self.folder, capture_output=True, timeout=60, check=False, **run)
        self.assertEqual(done.returncode, 0, (arguments, done.stderr))
        return done

    def test_positions_out_of_reach(self):
        """In meters and in millimeters: the limit applies to the size of the scene."""
        for unit, factor in (("m", 1), ("mm", 1e-3), ("mm", 1e-9)):
            self.write("room.obj", scaled(factor))
            far = 1e19 * factor
            near = 1e6 * factor
            for position, check in ((near, self.good), (far, self.refused)):
                points = f"0 0 {position} 0 0 1\n"
                self.write("far.pts", points)
                model = f'[[model]]\nfile = "room.obj"\nunit = "{unit}"\n'
                head = f'unit = "{unit}"\n' + model
                lamps = [f'[[luminaire]]\nkind = "point"\nlumens = 100\nposition = [0, 0, {position}]\n',
                         f'[[luminaire]]\nkind = "sphere"\nlumens = 100\nradius = {position}\nposition = [0, 0, 0]\n'
                         if position == far else '[site]\nlatitude = 1\nlongitude = 1\n',
                         f'[[camera]]\neye = [0, 0, {position}]\ntarget = [0, 0, 1]\n',
                         f'[[sensors]]\npoints = [[0, 0, {position}, 0, 0, 1]]\n',
                         f'[[sensors]]\nfloor = "*"\nheight = {position}\nspacing = {0.5 * factor}\n']
                runs = [solve("--unit", unit, "--points", "far.pts")]
                if position == far:
                    runs.append(solve("--unit", unit, "--picture", "a.png", "--camera", f"0,0,{position}", "0,0,0", "40"))
                for k, lamp in enumerate(lamps):
                    self.write(f"{k}.toml", head + lamp)
                    runs.append(("solve", f"{k}.toml", "--patches", "40", "-q", "-o", "a.ply"))
                for run in runs:
                    with self.subTest(unit=unit, factor=factor, position=position, run=run):
                        if check == self.good:
                            self.good(*run)
                        else:
                            self.refused(INPUT, ["1e12"], *run)

    def test_faces_that_are_nothing_beside_another(self):
        """Rays of the large face would be infinitely long relative to the extents of the others."""
        a = 2.278e-41
        faces = (((0, 0, 0), (1, 0, 0), (1, 1, 0)), ((0, 0, 0), (0, a, a), (0, 0, a)), ((0, 0, 0), (a, 0, a), (a, a, a)),
                 ((0, 0, 0), (a, a, a), (a, a, 0)))
        (self.folder / "tiny.stl").write_bytes(bytes(80) + struct.pack("<I", 4) + b"".join(
            struct.pack("<12f", 0, 0, 0, *(x for corner in face for x in corner)) + bytes(2) for face in faces))
        self.good("solve", "tiny.stl", "--set", "*.exitance=1", "--patches", "40", "-q", "-o", "a.ply")

    def test_deep_keys_and_long_lists(self):
        for deep in (".".join(["a"] * 20000) + " = 1\n", "[" + ".".join(["a"] * 20000) + "]\n",
                     "a = " + 20000 * "[" + 20000 * "]" + "\n", "a = " + 9000 * "{a.a.a = " + "1" + 9000 * "}" + "\n",
                     '"a"' + 20000 * ' . "a"' + " = 1\n"):
            self.write("deep.toml", SCENE + deep)
            self.refused(INPUT, ["deep.toml:3"], "check", "deep.toml")
        self.write("dots.toml", SCENE + "# " + 200 * "." + "\nup = \"z\"  # it's " + 200 * "[" + "\n")
        self.good("check", "dots.toml")
        self.write("long.toml", SCENE + "a = [" + 600_000 * "1," + "]\n" + "b = [" + 600_000 * "1," + "]\n")
        self.refused(INPUT, ["long.toml:4", "1000000"], "check", "long.toml")
        self.write("key.toml", SCENE + 100_000 * "k" + " = [" + 10_000 * "[]," + "]\n")
        self.refused(INPUT, ["key.toml:3"], "check", "key.toml")

    def test_full_and_closed_standard_output(self):
        for words in (("check", "room.obj", "--json"), ("check", "room.obj"), ("plan", "room.obj"), ("--help",),
                      ("solve", "room.obj", "--patches", "40", "-o", "a.ply"), ("solve", "--help")):
            with self.subTest(words), open("/dev/full", "wb") as full:
                done = subprocess.run([TOOL, *words], cwd=self.folder, stdout=full, stderr=subprocess.PIPE, check=False)
                self.assertEqual(done.returncode, OUTPUT, done.stderr)
                self.assertIn(b"standard output", done.stderr)
                closed = subprocess.run(["bash", "-c", '"$@" >&-', "bash", TOOL, *words], cwd=self.folder, check=False,
                                        stderr=subprocess.PIPE)
                self.assertEqual(closed.returncode, OUTPUT, closed.stderr)
        unread = subprocess.run(["bash", "-c", 'set -o pipefail; "$@" | true', "bash", "bash", "-c", 'sleep 0.1; exec "$@"', "bash", TOOL,
                                 "check", "room.obj"], cwd=self.folder, check=False, stderr=subprocess.PIPE)
        self.assertEqual(unread.returncode, OUTPUT, unread.stderr)

    def test_closed_descriptors_are_not_taken_by_files(self):
        triangle = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
        (self.folder / "t.bin").write_bytes(triangle)
        self.write("t.gltf", json.dumps({
            "asset": {"version": "2.0"}, "buffers": [{"uri": "t.bin", "byteLength": 36}], "scenes": [{"nodes": [0]}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}], "nodes": [{"mesh": 0}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
            "materials": [{"emissiveFactor": [1, 1, 1]}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}]}))
        for closed in ("0<&-", "0<&- 2>&-", "0<&- 1>&- 2>&-", "2>&-"):
            code = OUTPUT if "1>" in closed else 0
            done = subprocess.run(["bash", "-c", f'"$@" {closed}', "bash", TOOL, "check", "t.gltf"], cwd=self.folder,
                                  capture_output=True, check=False)
            self.assertEqual(done.returncode, code, (closed, done))

    def test_nothing_that_a_file_says_acts_on_the_terminal(self):
        name = "a\x1b]0;x\x07\x7f\u009b31m\u00e9"
        self.write("room.obj", ROOM.replace("usemtl white", "usemtl " + name))
        self.write("room.mtl", MATERIALS.replace("white", name))
        for words in (("check", "room.obj"), ("check", "room.obj", "--json"), ("plan", "room.obj"),
                      solve("--set", "none\x1b[2J.reflectance=1"), ("form-factors", "room.obj", "--patches", "40", "-o",
                                                                  "F", "--by", "material"),
                      ("check", "b\x1b[2J.obj"), solve("\x1b[2J", "-o", "a.ply"), ("\x1b[2J",), solve("-o", "\x1b.ply", "-v")):
            with self.subTest(words):
                done = self.run_tool(*words)
                for text in (done.stdout, done.stderr):
                    self.assertFalse(re.search("[\x00-\x09\x0b-\x1f\x7f-\x9f]", text), text)
        self.assertIn("\\u001b", self.run_tool("check", "room.obj").stdout)
        self.assertIn("\u00e9", self.run_tool("check", "room.obj").stdout)
        listed = json.loads(self.run_tool("check", "room.obj", "--json").stdout)
        self.assertIn(name, json.dumps(listed, ensure_ascii=False).encode().decode("unicode_escape").encode("latin-1").decode())

    def test_names_of_tables_are_text_for_spreadsheets(self):
        self.write("room.obj", ROOM.replace("usemtl white", "usemtl =cmd|'/C").replace("usemtl lamp", "usemtl -lamp"))
        self.write("room.mtl", MATERIALS.replace("white", "=cmd|'/C").replace("lamp", "-lamp"))
        self.write("+desk.pts", "0 0 0.5 0 0 1\n")
        self.good(*solve("--points", "+desk.pts", "--points-output", "a.csv"))
        self.assertTrue((self.folder / "a.csv").read_text().endswith(",'+desk\n"))
        self.good("form-factors", "room.obj", "--patches", "40", "-o", "F", "--by", "material", "-q")
        self.assertEqual((self.folder / "F" / "by_material.csv").read_text().splitlines()[0],
                         "from,area_m2,'=cmd|'/C,'-lamp")

    def test_points_from_pipes_and_no_points_from_devices(self):
        line = b"0 0 0.5 0 0 1\n"
        self.good(*solve("--points", "/dev/stdin", "--points-output", "a.csv"), input=line)
        done = subprocess.run(["bash", "-c", '"$@" --points <(printf "0 0 0.5 0 0 1\\n") --points-output b.csv', "bash",
                               TOOL, *solve()], cwd=self.folder, capture_output=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        def columns(name):
            return (self.folder / name).read_text().splitlines()[1].rsplit(",", 1)[0]
        self.assertEqual(columns("a.csv"), columns("b.csv"))
        self.refused(INPUT, ["/dev/zero"], *solve("--points", "/dev/zero"))
        os.mkfifo(self.folder / "pipe")
        self.write("pipe.toml", SCENE + '[[sensors]]\nfile = "pipe"\n')
        self.refused(INPUT, ["pipe"], "check", "pipe.toml")
        self.write("pipe.toml", SCENE + '[[luminaire]]\nkind = "ies"\nfile = "pipe"\nposition = [0, 0, 1]\n')
        self.refused(INPUT, ["pipe"], "check", "pipe.toml")

    def test_pipes_in_a_folder_of_form_factors(self):
        self.good("form-factors", "room.obj", "--patches", "40", "-o", "F", "-q")
        for name in ("F.npy", "area.npy", "info.json", "scene.json"):
            file = self.folder / "F" / name
            kept = file.read_bytes()
            file.unlink()
            os.mkfifo(file)
            with self.subTest(name):
                self.refused(INPUT, [name], "relight", "F", "-o", "a.ply", "-q")
            file.unlink()
            file.write_bytes(kept)

    def test_form_factors_that_cannot_be(self):
        for raw in ((), ("--no-closure",)):
            self.good("form-factors", "room.obj", "--patches", "40", "-o", "F", "-q", *raw)
            self.good("relight", "F", "-o", "a.ply", "-q")
            file = self.folder / "F" / "F.npy"
            kept = file.read_bytes()
            begin = kept.index(b"\n") + 1
            entries = struct.unpack(f"<{(len(kept) - begin) // 4}f", kept[begin:])
            for factor in (0, 0.5, 1.5, 1e30):
                file.write_bytes(kept[:begin] + struct.pack(f"<{len(entries)}f", *(factor * x for x in entries)))
                with self.subTest(raw=raw, factor=factor):
                    self.refused(INPUT, ["F.npy", "row 1"], "relight", "F", "-o", "a.ply", "-q")
            sums = self.folder / "F" / "raw_row_sum.npy"
            file.write_bytes(kept)
            whole = sums.read_bytes()
            begin = whole.index(b"\n") + 1
            sums.write_bytes(whole[:begin] + struct.pack("<d", 1e30) * ((len(whole) - begin) // 8))
            self.refused(INPUT, ["raw_row_sum.npy"], "relight", "F", "-o", "a.ply", "-q")

    def test_light_beyond_measure(self):
        for value in ("1e39", "1e300"):
            self.write("room.mtl", MATERIALS.replace("Ke 10 9 8", f"Ke {value} 1 1"))
            self.refused(INPUT, ["exitance", "lamp"], *solve("-o", "a.ply"))
            self.write("room.mtl", MATERIALS)
            self.refused(INPUT, ["exitance", "lamp"], *solve("-o", "a.ply", "--set", f"lamp.exitance={value}"))
            for key, light in (("intensity", f'[[luminaire]]\nkind = "point"\nwatts = {value}\nposition = [0, 0, 1.5]\n'),
                               ("sky", f'[sky]\nkind = "uniform"\nirradiance = {value}\n'),
                               ("sun", f'[sun]\ndirection = [0, 0, 1]\nirradiance = {value}\n')):
                self.write("light.toml", SCENE + light)
                self.refused(INPUT, [key], "check", "light.toml")
        self.good(*solve("-o", "a.ply", "--set", "lamp.exitance=1e24"))

    def test_enough_digits(self):
        self.write("room.mtl", MATERIALS.replace("Kd 0.7", "Kd 1.0000001"))
        self.refused(INPUT, ["1.0000001;"], "check", "room.obj")
        self.write("scene.toml", SCENE + '[[material]]\nname = "white"\nreflectance = 1.0000001\n')
        self.refused(INPUT, ["found 1.0000001;"], "check", "scene.toml")

    def test_places_and_years_that_are_not(self):
        place = "LOCATION,Here,-,-,-,1,{},{},{},10\n"
        hour = "{},6,21,12,60,A,20,10,50,100000,1000,1400,300,500,700,150\n"
        good = ("50", "10", "1", "2001")
        self.write("w.toml", SCENE + '[weather]\nfile = "w.epw"\nmonth = 6\nday = 21\nhour = 11\n')
        for k, named in enumerate(("latitude", "longitude", "time zone", "year")):
            for value in ("1e300", "-1000"):
                values = list(good)
                values[k] = value
                self.write("w.epw", place.format(*values[:3]) + hour.format(values[3]))
                self.refused(INPUT, ["w.epw:", named], "check", "w.toml")
        self.write("w.epw", place.format(*good[:3]) + hour.format(good[3]))
        self.good("check", "w.toml")

    def test_little_address_space(self):
        """Upward from the memory that the program needs at start: a result, or the exit code for too little memory."""
        codes = []
        for megabytes in range(180, 320, 20):
            def limit(size=megabytes << 20):
                resource.setrlimit(resource.RLIMIT_AS, (size, size))
            done = subprocess.run([TOOL, *solve("-o", "a.ply", "--threads", "2")], cwd=self.folder, capture_output=True,
                                  check=False, preexec_fn=limit)
            codes.append(done.returncode)
            self.assertIn(done.returncode, (0, MEMORY), (megabytes, done.stderr))
        self.assertTrue(codes)

    def test_too_little_address_space_for_ifc(self):
        """The message is not that of the library, and does not blame the file."""
        good = pathlib.Path(__file__).parents[1] / "fuzz" / "corpus" / "ifc" / "room.ifc"
        (self.folder / "room.ifc").write_bytes(good.read_bytes())
        done = self.refused(INPUT, ["ulimit -v"], "check", "room.ifc",
                            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30)))
        self.assertNotIn("Wasm", done.stderr)

    def test_a_name_that_is_taken(self):
        """Files already exist under the names of temporary files of this process."""
        script = ('import os, sys\n'
                  'for k in range(20):\n'
                  '  for suffix in ("ply", "pvd", "vtp", "partial"):\n'
                  '    open(f".patchlight-{os.getpid()}-{k}.{suffix}", "w").write("theirs")\n'
                  'import fcntl\n'
                  'os.execv(sys.argv[1], sys.argv[1:])\n')
        folder = self.folder / "out"
        folder.mkdir()
        (folder / "result").mkdir()
        words = [TOOL, "solve", "../room.obj", "--patches", "40", "-q", "-o", "a.ply", "--series", "a.pvd"]
        done = subprocess.run(["python3", "-c", script, *words], cwd=folder, capture_output=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        script = script.replace(".patchlight-", "result/../.patchlight-")
        words = [TOOL, "form-factors", "../room.obj", "--patches", "40", "-q", "-o", "F"]
        done = subprocess.run(["python3", "-c", script, *words], cwd=folder, capture_output=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_light_below_the_smallest_numbers(self):
        """Squares of numbers below 1e-150 are subnormal or zero."""
        for exitance in ("5e-324", "1e-320", "1e-200"):
            self.refused(INPUT, ["exitance", "1e-150"], *solve("--set", f"lamp.exitance={exitance}", "-o", "a.ply"))
        self.good(*solve("--set", "lamp.exitance=1e-150", "-o", "a.ply"))

    def test_closed_rooms_that_absorb_nothing(self):
        """A reflectance that differs from 1 by rounding equals 1: there is no solution, and no negative light."""
        words = solve("--set", "*.reflectance=0.99999999999999989", "-o", "a.vtp", "--json", "a.json")
        done = subprocess.run([TOOL, *words], cwd=self.folder, capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual(done.returncode, NOT_CONVERGED, done.stderr)
        self.assertTrue(json.loads((self.folder / "a.json").read_text())["solution"]["singular"])

    def test_names_that_xml_cannot_hold(self):
        self.refused(OUTPUT, ["control characters"], *solve("--series", "a\x1b.pvd"))

    def test_two_dashes_end_the_options(self):
        self.write("-room.obj", ROOM)
        self.good("check", "--", "-room.obj")

    def test_instances_of_nothing_and_variables_of_variables(self):
        """Twelve kilobytes that expand to 20^13 objects, and a text of ten gigabytes."""
        groups = ['<shape type="shapegroup" id="g0"><shape type="obj"><string name="filename" value="none.obj"/></shape>'
                  '</shape>']
        groups += [f'<shape type="shapegroup" id="g{k}">' +
                   f'<shape type="instance"><ref id="g{k - 1}"/></shape>' * 20 + "</shape>" for k in range(1, 14)]
        self.write("deep.xml", '<scene version="3.0.0">' + "".join(groups) +
                   '<shape type="instance"><ref id="g13"/></shape></scene>')
        self.refused(INPUT, ["deep.xml", "1,000,000"], "check", "deep.xml")
        self.write("long.xml", '<scene version="3.0.0"><default name="a" value="' + "1" * 4096 + '"/>'
                   '<shape type="obj"><string name="filename" value="' + "$a" * 100_000 + '"/></shape></scene>')
        self.refused(INPUT, ["long.xml", "a million"], "check", "long.xml")
        self.write("value.xml", '<scene version="3.0.0"><default name="a" value="' + "1" * 5000 + '"/></scene>')
        self.refused(INPUT, ["value.xml", "4,096"], "check", "value.xml")

    def signalled(self, *words, before=None, which=signal.SIGHUP):
        process = subprocess.Popen([TOOL, *words], cwd=self.folder, stderr=subprocess.PIPE, preexec_fn=before)
        time.sleep(0.6)
        process.send_signal(which)
        _, errors = process.communicate(timeout=300)
        return process.returncode, errors

    def test_hanging_up_and_ignored_signals(self):
        long = ("solve", "room.obj", "--patches", "3000", "--samples", "1024", "--threads", "1", "-q", "-o", "a.ply")
        code, errors = self.signalled(*long)
        self.assertEqual(code, 128 + signal.SIGHUP, errors)
        self.assertEqual([path.name for path in self.folder.iterdir() if path.name.startswith(".patchlight")], [])
        short = ("solve", "room.obj", "--patches", "2000", "--samples", "128", "--threads", "1", "-q", "-o", "a.ply")
        for which in (signal.SIGINT, signal.SIGHUP):
            def ignore(number=which):
                signal.signal(number, signal.SIG_IGN)
            code, errors = self.signalled(*short, before=ignore, which=which)
            self.assertEqual(code, 0, errors)

    def test_pictures_larger_than_they_are_long(self):
        """60,000 x 60,000 pixels in a few kilobytes must not be decoded; a picture under twelve names is decoded
        once."""
        def png(width, height, rows):
            def chunk(kind, data):
                return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
            return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)) +
                    chunk(b"IDAT", rows) + chunk(b"IEND", b""))
        packer = zlib.compressobj(9)
        row = bytes(1 + 60_000)
        rows = b"".join(packer.compress(row) for _ in range(2000)) + packer.flush()
        (self.folder / "bomb.png").write_bytes(png(60_000, 60_000, rows))
        grey = zlib.compress(b"".join(b"\0" + bytes([188]) * 4000 for _ in range(4000)))
        (self.folder / "grey.png").write_bytes(png(4000, 4000, grey))
        (self.folder / "t.bin").write_bytes(struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0))
        def model(picture, times):
            materials = [{"name": str(k), "emissiveFactor": [1, 1, 1],
                          "pbrMetallicRoughness": {"baseColorTexture": {"index": k}}} for k in range(times)]
            return json.dumps({
                "asset": {"version": "2.0"}, "buffers": [{"uri": "t.bin", "byteLength": 36}],
                "bufferViews": [{"buffer": 0, "byteLength": 36}], "nodes": [{"mesh": k} for k in range(times)],
                "scenes": [{"nodes": list(range(times))}],
                "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
                "images": [{"uri": picture} for _ in range(times)], "textures": [{"source": k} for k in range(times)],
                "materials": materials,
                "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": k}]} for k in range(times)]})
        def cpu_seconds(name):
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            done = self.good("check", name)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            return after.ru_utime - before.ru_utime, done.stdout.decode()
        self.write("bomb.gltf", model("bomb.png", 1))
        self.assertIn("unreadable_picture", cpu_seconds("bomb.gltf")[1])
        self.write("one.gltf", model("grey.png", 1))
        self.write("twelve.gltf", model("grey.png", 12))
        one, text = cpu_seconds("one.gltf")
        self.assertIn("0.5029", text)  # ((188 / 255 + 0.055) / 1.055)^2.4
        self.assertLess(cpu_seconds("twelve.gltf")[0], 4 * one + 0.2)


if __name__ == "__main__":
    unittest.main()
