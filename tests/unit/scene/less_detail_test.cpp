#include "scene/less_detail.h"

#include "scene/repair.h"
#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace patchlight::less_detail_test {
namespace {

using namespace test;

// A closed cylinder along z of `sides` faces, with its caps.
Scene with_cylinder(Scene scene, const Point& base, double radius, double height, std::uint32_t sides,
                    MaterialIndex material = 0) {
  const auto begin = static_cast<std::uint32_t>(scene.vertices.size());
  for (const double z : {0.0, height}) {
    for (std::uint32_t k = 0; k < sides; ++k) {
      const double angle = 2 * std::numbers::pi * k / sides;
      scene.vertices.push_back(base + Vector(radius * std::cos(angle), radius * std::sin(angle), z));
    }
  }
  Polygon bottom{.corners = {}, .material = material}, top = bottom;
  for (std::uint32_t k = 0; k < sides; ++k) {
    const std::uint32_t next = (k + 1) % sides;
    scene.polygons.push_back(
        {.corners = {begin + k, begin + next, begin + sides + next, begin + sides + k}, .material = material});
    bottom.corners.push_back(begin + sides - 1 - k);
    top.corners.push_back(begin + sides + k);
  }
  scene.polygons.push_back(bottom);
  scene.polygons.push_back(top);
  return scene;
}

Scene room() { return with_box(empty_scene({grey(0.5), grey(0.2)}), Point(0, 0, 0), Point(4, 3, 2.5), true); }

Scene in_triangles(Scene scene) {
  const std::size_t quads = scene.polygons.size();
  for (std::size_t p = 0; p < quads; ++p) {
    const std::vector<std::uint32_t> c = scene.polygons[p].corners;
    scene.polygons.push_back(scene.polygons[p]);
    scene.polygons.back().corners = {c[0], c[2], c[3]};
    scene.polygons[p].corners = {c[0], c[1], c[2]};
  }
  return scene;
}

TEST(LessDetail, LeavesOutWhatIsSmaller) {
  const Scene scene = with_box(room(), Point(1, 1, 1), Point(1.04, 1.03, 1.02), false);
  EXPECT_EQ(with_less_detail(scene, 0.05).polygons.size(), 6u);
  EXPECT_EQ(with_less_detail(scene, 0.03).polygons.size(), 12u);
}

TEST(LessDetail, ATurnedRodIsABoxThatHoldsIt) {
  const Scene scene = with_cylinder(room(), Point(1, 1, 0.5), 0.02, 1, 24, 1);
  const Scene less = with_less_detail(scene, 0.05);
  ASSERT_EQ(less.polygons.size(), 12u);
  Box box;
  double area = 0;
  Vector flux = Vector::Zero();
  for (PolygonIndex p = 6; p < 12; ++p) {
    EXPECT_EQ(less.polygons[p].material, 1u);
    for (const Point& corner : corner_points(less, p)) box.extend(corner);
    area += area_vector(corner_points(less, p)).norm();
    flux += area_vector(corner_points(less, p));
    EXPECT_GT(area_vector(corner_points(less, p)).dot(corner_points(less, p)[0] - Point(1, 1, 1)), 0);  // outward
  }
  EXPECT_LT(flux.norm(), 1e-12);
  EXPECT_NEAR(box.sizes().z(), 1, 1e-9);
  EXPECT_LT(box.sizes().x(), 2 * 0.02 * std::numbers::sqrt2);
  EXPECT_GT(area, 4 * 0.04 * std::cos(std::numbers::pi / 24));
  EXPECT_FALSE(less.diagnostics.empty());
}

// A closed frame around an opening is near its bounding box everywhere, but is no box.
TEST(LessDetail, AFrameStaysOpen) {
  Scene scene = room();
  const auto begin = static_cast<std::uint32_t>(scene.vertices.size());
  const Eigen::Vector2d outer[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  const Eigen::Vector2d inner[4] = {{0.04, 0.04}, {0.96, 0.04}, {0.96, 0.96}, {0.04, 0.96}};
  for (const double z : {1.0, 1.04}) {
    for (const auto& ring : {outer, inner}) {
      for (int k = 0; k < 4; ++k) scene.vertices.emplace_back(1 + ring[k].x(), 1 + ring[k].y(), z);
    }
  }
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::uint32_t next = (k + 1) % 4;
    const auto o = [&](std::uint32_t v) { return begin + v; };
    scene.polygons.push_back({.corners = {o(next), o(k), o(4 + k), o(4 + next)}});
    scene.polygons.push_back({.corners = {o(8 + k), o(8 + next), o(12 + next), o(12 + k)}});
    scene.polygons.push_back({.corners = {o(k), o(next), o(8 + next), o(8 + k)}});
    scene.polygons.push_back({.corners = {o(4 + next), o(4 + k), o(12 + k), o(12 + next)}});
  }
  EXPECT_EQ(with_less_detail(scene, 0.05).polygons.size(), scene.polygons.size());
}

TEST(LessDetail, ARoomAColumnALampAndAPaneStay) {
  Scene scene = with_cylinder(room(), Point(1, 1, 0), 0.5, 2.5, 24);
  EXPECT_EQ(with_less_detail(scene, 0.05).polygons.size(), scene.polygons.size());
  scene = room();
  scene.materials.push_back(grey(0.5, 10));
  scene = with_cylinder(scene, Point(1, 1, 1), 0.02, 1, 24, 2);
  EXPECT_EQ(with_less_detail(scene, 0.1).polygons.size(), scene.polygons.size());
}

// A room in triangles is a box with contents.
TEST(LessDetail, ARoomOfTrianglesStays) {
  const Scene scene = in_triangles(with_box(room(), Point(1, 1, 1), Point(1.8, 1.8, 1.8), false));
  EXPECT_EQ(with_less_detail(repair(scene), 0.05).polygons.size(), 12u + 6u);  // the box inside is one of six faces
}

TEST(LessDetail, AnEmptyRoomStays) {
  EXPECT_EQ(with_less_detail(repair(in_triangles(room())), 0.1).polygons.size(), 12u);
}

// A tiled strip is no body.
TEST(LessDetail, AFlatStripStays) {
  Scene scene = room();
  const auto begin = static_cast<std::uint32_t>(scene.vertices.size());
  for (int x = 0; x <= 8; ++x) {
    scene.vertices.emplace_back(1 + 0.1 * x, 1, 1);
    scene.vertices.emplace_back(1 + 0.1 * x, 1.05, 1);
  }
  for (std::uint32_t x = 0; x < 8; ++x) {
    const std::uint32_t a = begin + 2 * x;
    scene.polygons.push_back({.corners = {a, a + 2, a + 3, a + 1}});
  }
  EXPECT_EQ(with_less_detail(scene, 0.1).polygons.size(), scene.polygons.size());
}

// A slab of 5 x 0.2 x 3 m with a window no larger than a rim of the detail's width: its hole stays.
TEST(LessDetail, AWallWithAWindowStaysOpen) {
  Scene scene = empty_scene({grey(0.5)});
  const Eigen::Vector2d outer[4] = {{0, 0}, {5, 0}, {5, 3}, {0, 3}};
  const Eigen::Vector2d inner[4] = {{2, 1}, {2.7, 1}, {2.7, 1.8}, {2, 1.8}};
  for (const double y : {0.0, 0.2}) {
    for (const auto& ring : {outer, inner}) {
      for (int k = 0; k < 4; ++k) scene.vertices.emplace_back(ring[k].x(), y, ring[k].y());
    }
  }
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::uint32_t next = (k + 1) % 4;
    scene.polygons.push_back({.corners = {next, k, 8 + k, 8 + next}});
    scene.polygons.push_back({.corners = {4 + k, 4 + next, 12 + next, 12 + k}});
    scene.polygons.push_back({.corners = {k, next, 4 + next, 4 + k}});
    scene.polygons.push_back({.corners = {8 + next, 8 + k, 12 + k, 12 + next}});
  }
  EXPECT_EQ(with_less_detail(scene, 0.05).polygons.size(), scene.polygons.size());
}

TEST(LessDetail, OfTwoMaterialsABoxHasTheMean) {
  Scene scene = with_cylinder(room(), Point(1, 1, 0.5), 0.02, 1, 24);
  for (PolygonIndex p = 6; p < 18; ++p) scene.polygons[p].material = 1;
  const Scene less = with_less_detail(scene, 0.05);
  ASSERT_EQ(less.polygons.size(), 12u);
  const double mean = less.materials[less.polygons[6].material].reflectance[0];
  EXPECT_GT(mean, 0.2);
  EXPECT_LT(mean, 0.5);
}

}  // namespace
}  // namespace patchlight::less_detail_test
