"""Lightmaps of the tool: --lightmap of solve and render."""
import json
import unittest

from support import ToolTest, content

FILES = {"baked.glb", "direct.exr", "direct.png", "indirect.exr", "indirect.png", "irradiance.exr", "irradiance.png",
         "lightmap.glb", "lightmap.json"}


class LightmapTest(ToolTest):
    def test_solve_writes_a_whole_folder_and_replaces_it(self):
        for _ in range(2):
            done = self.run_tool("solve", "room.obj", "--patches", 100, "--lightmap", "map", "--texel", "0.5m")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("lightmap: ", done.stdout)
            self.assertIn(" MB of memory", done.stdout)
            self.assertEqual({path.name for path in (self.folder / "map").iterdir()}, FILES)
        facts = json.loads((self.folder / "map" / "lightmap.json").read_text())
        self.assertEqual(facts["kind"], "patchlight lightmap")
        self.assertEqual(facts["texel_m"], 0.5)
        self.assertGreater(facts["texels_on_surfaces"], 0)

    def test_render_writes_one_of_a_stored_solution(self):
        self.run_tool("solve", "room.obj", "--patches", 100, "-o", "room.vtp")
        done = self.run_tool("render", "room.obj", "--solution", "room.vtp", "--lightmap", "map", "--texel", "0.5m")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual({path.name for path in (self.folder / "map").iterdir()}, FILES)

    def test_refuses_what_would_be_lost_before_anything_is_solved(self):
        (self.folder / "map").mkdir()
        self.write("map/mine.txt", "mine")
        before = content(self.folder / "map")
        done = self.run_tool("solve", "room.obj", "--lightmap", "map")
        self.assertEqual(done.returncode, 6)
        self.assertTrue(done.stderr.startswith("patchlight: error: map: "), done.stderr)
        self.assertEqual(content(self.folder / "map"), before)
        done = self.run_tool("solve", "room.obj", "--lightmap", "map", "--json", "map/report.json")
        self.assertEqual(done.returncode, 1)
        self.assertIn("--json: 'map/report.json' ", done.stderr)

    def test_a_model_in_the_folder_is_not_replaced(self):
        self.run_tool("solve", "room.obj", "--patches", 100, "--lightmap", "map", "--texel", "0.5m")
        before = content(self.folder / "map")
        done = self.run_tool("solve", "map/lightmap.glb", "--lightmap", "map")
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn("--lightmap", done.stderr)
        self.assertEqual(content(self.folder / "map"), before)

    def test_texels_are_of_a_lightmap(self):
        done = self.run_tool("solve", "room.obj", "-o", "room.vtp", "--texel", "5cm")
        self.assertEqual(done.returncode, 1)
        self.assertIn("--lightmap", done.stderr)


if __name__ == "__main__":
    unittest.main()
