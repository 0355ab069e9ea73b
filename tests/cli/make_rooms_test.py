"""scripts/make_rooms.py: the rooms are closed and have the right size, and their normals point inward."""
import collections
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "make_rooms.py"


def read_room(file):
    """Corner points of the polygons."""
    points, polygons = [], []
    for line in file.read_text().splitlines():
        words = line.split()
        if words and words[0] == "v":
            points.append(tuple(map(float, words[1:])))
        if words and words[0] == "f":
            polygons.append([points[int(w) - 1] for w in words[1:]])
    return polygons


def volume(polygons):
    """Volume of the region into which the normals point, by the divergence theorem."""
    total = 0
    for a, *others in polygons:
        for b, c in zip(others, others[1:]):
            cross = [b[k - 2] * c[k - 1] - b[k - 1] * c[k - 2] for k in range(3)]
            total -= sum(x * y for x, y in zip(a, cross)) / 6
    return total


class RoomsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([sys.executable, str(SCRIPT), folder], check=True, capture_output=True, timeout=600)
            cls.rooms = {file.stem: read_room(file) for file in pathlib.Path(folder).glob("*.obj")}

    def test_every_edge_is_walked_once_each_way(self):
        for name, polygons in self.rooms.items():
            edges = collections.Counter(e for p in polygons for e in zip(p, p[1:] + p[:1]))
            self.assertEqual([e for e, n in edges.items() if n != 1 or edges[e[::-1]] != 1], [], name)

    def test_the_room_with_two_blocks_has_its_size(self):
        # 6 walls of n^2 squares; the floor lacks 0.18 n^2, and the blocks have 1.08 + 0.18 and no bottoms: 7.08 n^2.
        for n in (10, 20, 40):
            polygons = self.rooms[f"closed_room_{n}"]
            self.assertEqual(len(polygons), round(2 * 7.08 * n * n))
            self.assertAlmostEqual(volume(polygons), 1 - 0.09 * 0.3 - 0.09 * 0.6, places=9)

    def test_the_room_with_boxes_holds_500(self):
        polygons = self.rooms["boxes_500"]
        ceilings = [p for p in polygons if all(x[2] == 3 for x in p)]
        self.assertEqual(len(ceilings), 1)
        # Only the top of a box faces up above the floor.
        tops = [p for p in polygons if len({x[2] for x in p}) == 1 and 0 < p[0][2] < 3 and turns_left(p)]
        self.assertEqual(len(tops), 500)
        self.assertLess(volume(polygons), 8 * 8 * 3)
        self.assertGreater(volume(polygons), 0.8 * 8 * 8 * 3)


def turns_left(polygon):
    a, b, c = polygon[:3]
    return (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]) > 0


if __name__ == "__main__":
    unittest.main()
