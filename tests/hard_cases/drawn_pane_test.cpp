// Panes drawn on uncut walls: a clear face opens the wall that it covers.
#include "patchlight/simulate.h"

#include "scene/repair.h"
#include "support/scenes.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <utility>
#include <vector>

namespace patchlight::drawn_pane_test {
namespace {

using namespace test;

const Eigen::Affine3d turned_a_little(Eigen::AngleAxisd(0.7, Vector(0.3, 1, -2).normalized()));

// A room of 4 x 3 x 2.5 m under an overcast sky, with panes of transmittance 1 in the wall at high x. Each pane has a
// range in y and one in z.
struct Pane {
  double from_y, to_y, from_z, to_z;
};

Quad quad_of(const Pane& pane) {
  return {Point(4, pane.from_y, pane.from_z), Point(4, pane.from_y, pane.to_z), Point(4, pane.to_y, pane.to_z),
          Point(4, pane.to_y, pane.from_z)};
}

Scene room_under_the_sky() {
  Material clear = grey(0);
  clear.transmittance = Spectrum::Ones(1);
  Scene scene = empty_scene({grey(0.5), clear});
  Sky sky;
  sky.kind = SkyKind::cie_overcast;
  sky.horizontal_irradiance = Spectrum::Constant(1, 100);
  scene.sky = sky;
  return scene;
}

Scene with_panes_drawn(const std::vector<Pane>& panes) {
  Scene scene = with_box(room_under_the_sky(), Point(0, 0, 0), Point(4, 3, 2.5), true);
  for (const Pane& pane : panes) scene = with_quad(std::move(scene), quad_of(pane), 1);
  return scene;
}

// The same room with the wall made of strips around the panes, which stand side by side at one height.
Scene with_wall_cut(const std::vector<Pane>& panes) {
  Scene scene = room_under_the_sky();
  const std::vector<Quad> faces = box_faces(Point(0, 0, 0), Point(4, 3, 2.5), true);
  for (std::size_t k = 0; k < faces.size(); ++k) {
    if (k != 3) scene = with_quad(std::move(scene), faces[k]);
  }
  const double low = panes[0].from_z;
  const double high = panes[0].to_z;
  if (low > 0) scene = with_quad(std::move(scene), quad_of({0, 3, 0, low}));
  scene = with_quad(std::move(scene), quad_of({0, 3, high, 2.5}));
  double y = 0;
  for (const Pane& pane : panes) {
    scene = with_quad(with_quad(std::move(scene), quad_of({y, pane.from_y, low, high})), quad_of(pane), 1);
    y = pane.to_y;
  }
  return with_quad(std::move(scene), quad_of({y, 3, low, high}));
}

// Mean irradiance of the floor, W/m^2.
double floor_irradiance(Scene scene, Sides sides, const Eigen::Affine3d& placing, double metres_per_unit) {
  scene = repair(moved(std::move(scene), placing));
  scene.up = (placing.linear() * Vector::UnitZ()).normalized();
  Request request;
  request.mesh.max_edge = 0.4 * metres_per_unit;
  request.mesh.sides = sides;
  const Simulation simulation = simulate(scene, request);
  double flux = 0;
  double area = 0;
  for (PatchIndex i = 0; i < simulation.mesh.size(); ++i) {
    if (simulation.mesh.polygon[i] != 0 || simulation.mesh.side[i] != Side::front) continue;
    flux += simulation.problem.area[i] * simulation.solution.irradiance(i, 0);
    area += simulation.problem.area[i];
  }
  return flux / area;
}

// The noise of the sky in two independent means over about 80 patches is well below 1 %. The meshes of the walls
// differ.
void expect_opened(const std::vector<Pane>& panes) {
  const double expected = floor_irradiance(with_wall_cut(panes), Sides::front, Eigen::Affine3d::Identity(), 1);
  ASSERT_GT(expected, 1);
  for (const Sides sides : {Sides::automatic, Sides::front}) {
    EXPECT_NEAR(floor_irradiance(with_panes_drawn(panes), sides, Eigen::Affine3d::Identity(), 1) / expected, 1, 0.02);
    const Eigen::Affine3d placing = turned_a_little * Eigen::Scaling(0.001);
    EXPECT_NEAR(floor_irradiance(with_panes_drawn(panes), sides, placing, 0.001) / expected, 1, 0.02);
  }
}

TEST(DrawnPane, OpensTheWall) { expect_opened({{1, 2, 0.8, 1.8}}); }

TEST(DrawnPane, SeveralInOneWallOpenIt) {
  expect_opened({{0.3, 0.9, 0.8, 1.8}, {1.1, 1.7, 0.8, 1.8}, {2, 2.8, 0.8, 1.8}});
}

TEST(DrawnPane, OneThatReachesTheFloorOpensTheWall) { expect_opened({{1, 2, 0, 2}}); }

// The wall with a seamed hole, and the pane in it, form a closed surface with an opening.
TEST(DrawnPane, LeavesTheRoomClosed) {
  const Scene scene = repair(with_panes_drawn({{0.3, 0.9, 0.8, 1.8}, {2, 2.8, 0.8, 1.8}}));
  EXPECT_EQ(scene.polygons.size(), 8U);
  const KeptSides dark = kept_sides(scene, Sides::automatic);
  EXPECT_TRUE(dark.dark_solids.empty());
  Scene by_night = scene;
  by_night.sky.reset();
  by_night.luminaires.resize(1);
  by_night.luminaires[0].position = {2, 1.5, 2};
  EXPECT_EQ(kept_sides(by_night, Sides::automatic).notes.size(), 0U)
      << "light gets out: no outer side is left out for it";
}

// A pane with the corners of the wall, in either order and orientation.
TEST(DrawnPane, OfTheWallsSizeTakesItsPlace) {
  const Pane whole{0, 3, 0, 2.5};
  for (const bool turned : {false, true}) {
    Scene scene = with_panes_drawn({whole});
    if (turned) std::reverse(scene.polygons[6].corners.begin(), scene.polygons[6].corners.end());
    for (const bool pane_first : {false, true}) {
      if (pane_first) std::swap(scene.polygons[3], scene.polygons[6]);
      const Scene repaired = repair(scene);
      ASSERT_EQ(repaired.polygons.size(), 6U);
      EXPECT_EQ(repaired.polygons[3].material, 1U);
      EXPECT_FALSE(repaired.polygons[3].back_material);
    }
  }
}

// The wall consists of two triangles, each smaller than the pane over both, or of two quads, one of which is larger.
TEST(DrawnPane, OpensAWallInPiecesSmallerThanItself) {
  const auto in_pieces = [](const Pane& pane, const std::vector<std::vector<Point>>& pieces) {
    Scene scene = with_panes_drawn({pane});
    scene = with_polygon(std::move(scene), pieces[1]);
    const Scene first = with_polygon(scene, pieces[0]);
    scene.vertices = first.vertices;
    scene.polygons[3].corners = first.polygons.back().corners;
    return scene;
  };
  const Quad wall = quad_of({0, 3, 0, 2.5});
  const Quad low = quad_of({0, 2.2, 0, 2.5});
  const Quad high = quad_of({2.2, 3, 0, 2.5});
  const std::vector<std::vector<std::vector<Point>>> walls{
      {{wall[0], wall[1], wall[2]}, {wall[2], wall[3], wall[0]}},
      {{low[0], low[1], low[2], low[3]}, {high[0], high[1], high[2], high[3]}}};
  const Pane pane{0.3, 2.7, 0.3, 2.2};
  const double expected = floor_irradiance(with_wall_cut({pane}), Sides::front, Eigen::Affine3d::Identity(), 1);
  ASSERT_GT(expected, 1);
  for (const auto& pieces : walls) {
    for (const Sides sides : {Sides::automatic, Sides::front}) {
      const Scene scene = in_pieces(pane, pieces);
      EXPECT_NEAR(floor_irradiance(scene, sides, Eigen::Affine3d::Identity(), 1) / expected, 1, 0.02);
      const Eigen::Affine3d placing = turned_a_little * Eigen::Scaling(0.001);
      EXPECT_NEAR(floor_irradiance(scene, sides, placing, 0.001) / expected, 1, 0.02);
    }
  }
}

// A bar that reaches beyond the pane stays. So does a large panel that overhangs the edge of the pane.
TEST(DrawnPane, DoesNotOpenBarsAndPanelsThatReachBeyondIt) {
  for (const Pane& upon : {Pane{0.4, 2.6, 1.2, 1.25}, Pane{0.4, 2.6, 1.2, 2.05}}) {
    const Scene with_pane = with_panes_drawn({{0.5, 2.5, 0.5, 2}});
    const Scene scene = repair(with_quad(with_pane, quad_of(upon), 0));
    ASSERT_EQ(scene.polygons.size(), 8U);
    const Polygon& last = scene.polygons.back();
    EXPECT_EQ(last.material, 0U);
    EXPECT_NEAR(area_vector(corner_points(scene, 7)).norm(), (upon.to_y - upon.from_y) * (upon.to_z - upon.from_z),
                1e-9);
  }
}

// A small opaque sticker on a large pane stays.
TEST(DrawnPane, DoesNotOpenWhatLiesOverIt) {
  Scene scene = with_panes_drawn({{0.5, 2.5, 0.5, 2}});
  scene = repair(with_quad(std::move(scene), quad_of({1, 1.2, 1, 1.2}), 0));
  EXPECT_EQ(scene.polygons.size(), 8U);
  EXPECT_EQ(scene.polygons[7].corners.size(), 4U);
}

}  // namespace
}  // namespace patchlight::drawn_pane_test
