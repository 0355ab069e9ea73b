#include "support/meshes.h"

#include "patchlight/input/read_scene.h"
#include "patchlight/scene/sides.h"

#include "support/diagnostics_of.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace patchlight::meshes_test {
namespace {

// Coordinates in the files are exact to 0.05 mm. Areas are sums of a few of their products, so the only error is
// rounding.
constexpr double rounding = 1e-12;

Scene mesh(const std::string& name) { return read_scene(mesh_folder() / (name + ".obj")); }

int count(const std::vector<std::uint8_t>& kept) { return static_cast<int>(std::count(kept.begin(), kept.end(), 1)); }

TEST(Meshes, EveryModelIsReadWithoutRemarks) {
  for (const char* name : {"cornell_box", "furnace_cube", "parallel_squares", "perpendicular_squares", "two_rooms"}) {
    EXPECT_TRUE(test::notes_of(mesh(name)).empty()) << name;
  }
}

TEST(Meshes, TheCornellBoxHasTheMeasuredSizes) {
  const Scene scene = mesh("cornell_box");
  EXPECT_EQ(bounds(scene).min(), Point(0, 0, 0));
  EXPECT_EQ(bounds(scene).max(), Point(0.5528, 0.5488, 0.5592));
  double lamp = 0;
  double upper = 0;  // ceiling and lamp
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const Vector area = area_vector(corner_points(scene, p));
    if (is_lamp(scene, p)) lamp += -area.y();
    if (scene.vertices[scene.polygons[p].corners[0]].y() == 0.5488 && area.y() < 0) upper += -area.y();
  }
  EXPECT_NEAR(lamp, 0.130 * 0.105, rounding);
  EXPECT_NEAR(upper, 0.5528 * 0.5592, rounding) << "the lamp fills the hole in the ceiling";
}

// The vector areas of a closed surface add up to zero. Those of the Cornell box add up to that of its open front plus
// the missing bottoms of the blocks. Every polygon faces the open front or away from a block.
TEST(Meshes, TheCornellBoxFacesItsInside) {
  const Scene scene = mesh("cornell_box");
  Vector room = Vector::Zero();
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (scene.groups[scene.polygons[p].group].find("block") == std::string::npos) {
      room += area_vector(corner_points(scene, p));
    }
  }
  EXPECT_NEAR((room - Vector(0, 0, -0.5528 * 0.5488)).norm(), 0, rounding);
}

TEST(Meshes, TheFurnaceIsClosedAndItsRadiosityIsOne) {
  const Scene scene = mesh("furnace_cube");
  const Material& wall = scene.materials[0];
  // B = E / (1 - rho). Ke has 17 digits, and pi Ke is rounded once.
  for (int band = 0; band < 3; ++band) EXPECT_NEAR(wall.exitance[band] / (1 - wall.reflectance[band]), 1, 1e-15);
  const KeptSides kept = kept_sides(scene, Sides::automatic);
  EXPECT_EQ(count(kept.front), 6);
  EXPECT_EQ(count(kept.back), 0);
}

TEST(Meshes, TheSquaresFaceEachOtherAndEmitOneWattPerSquareMetre) {
  for (const char* name : {"parallel_squares", "perpendicular_squares"}) {
    const Scene scene = mesh(name);
    ASSERT_EQ(scene.polygons.size(), 2U);
    EXPECT_TRUE(is_lamp(scene, 0));
    EXPECT_FALSE(is_lamp(scene, 1));
    EXPECT_NEAR(scene.materials[scene.polygons[0].material].exitance[1], 1, 1e-15);
    const Point middle_0 = area_centroid(corner_points(scene, 0));
    const Point middle_1 = area_centroid(corner_points(scene, 1));
    EXPECT_GT(front_normal(scene, 0).dot(middle_1 - middle_0), 0);
    EXPECT_GT(front_normal(scene, 1).dot(middle_0 - middle_1), 0);
    EXPECT_EQ(area_vector(corner_points(scene, 0)).norm(), 1);
    EXPECT_EQ(area_vector(corner_points(scene, 1)).norm(), 1);
  }
}

TEST(Meshes, TheTwoRoomsAreOneClosedShellWithOneFloorUnderTheDividingWall) {
  const Scene scene = mesh("two_rooms");
  EXPECT_GE(scene.polygons.size(), 200U);
  const KeptSides kept = kept_sides(scene, Sides::automatic);
  int lamps = 0;
  int floors = 0;
  Vector shell = Vector::Zero();
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    lamps += is_lamp(scene, p);
    if (scene.groups[scene.polygons[p].group] != "shell") continue;
    shell += area_vector(corner_points(scene, p));
    EXPECT_TRUE(kept.front[p] && !kept.back[p]) << "only the inside of the shell is lit";
    const Material& material = scene.materials[scene.polygons[p].material];
    floors += material.name == "floor_oak";
  }
  EXPECT_EQ(lamps, 2);
  EXPECT_EQ(floors, 1);
  EXPECT_NEAR(shell.norm(), 0, rounding);
}

// No furniture intersects a wall or other furniture. Apart from the shell and the wall, the boxes of the groups are
// disjoint and inside their room.
TEST(Meshes, TheFurnitureOfTheTwoRoomsStandsFree) {
  const Scene scene = mesh("two_rooms");
  std::vector<Box> boxes(scene.groups.size());
  for (const Polygon& polygon : scene.polygons) {
    for (const std::uint32_t corner : polygon.corners) boxes[polygon.group].extend(scene.vertices[corner]);
  }
  const Box room_a(Point(0, 0, 0), Point(4.0, 3.0, 2.7));
  const Box room_b(Point(4.1, 0, 0), Point(7.1, 3.0, 2.7));
  for (std::size_t g = 0; g < boxes.size(); ++g) {
    if (scene.groups[g] == "shell" || scene.groups[g] == "dividing_wall") continue;
    EXPECT_TRUE(room_a.contains(boxes[g]) || room_b.contains(boxes[g])) << scene.groups[g];
    for (std::size_t h = 0; h < g; ++h) {
      if (scene.groups[h] == "shell" || scene.groups[h] == "dividing_wall") continue;
      EXPECT_FALSE(boxes[g].intersects(boxes[h])) << scene.groups[g] << " and " << scene.groups[h];
    }
  }
}

}  // namespace
}  // namespace patchlight::meshes_test
