#include "patchlight/scene/contact_lines.h"

#include "support/scenes.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

namespace patchlight::contact_lines_test {
namespace {

using namespace test;

// A floor of 4 x 4 m at z = 0, its front upward: polygon 0.
Scene floor_scene() {
  return with_quad(empty_scene({grey(0.5)}), {Point(0, 0, 0), Point(4, 0, 0), Point(4, 4, 0), Point(0, 4, 0)});
}

KeptSides front_sides(const Scene& scene) {
  const std::size_t count = scene.polygons.size();
  return {std::vector<std::uint8_t>(count, 1), std::vector<std::uint8_t>(count, 0), {}, {}};
}

std::vector<ContactLine> lines_on_floor(const Scene& scene) {
  const ContactLines found = find_contact_lines(scene, front_sides(scene));
  return found.on.empty() ? std::vector<ContactLine>() : found.on[0];
}

double length_of(const std::vector<ContactLine>& lines) {
  double length = 0;
  for (const ContactLine& line : lines) length += (line.to - line.from).norm();
  return length;
}

Scene with_cube_at(Scene scene, double height) {
  return with_box(std::move(scene), Point(1, 1, height), Point(2, 2, height + 1), false);
}

// A side face and the bottom have each edge.
TEST(ContactLines, RunAroundABlockThatStands) {
  const std::vector<ContactLine> lines = lines_on_floor(with_cube_at(floor_scene(), 0));
  EXPECT_NEAR(length_of(lines), 2 * 4, 1e-12);
  for (const ContactLine& line : lines) {
    EXPECT_EQ(line.gap, 0);
    EXPECT_EQ(line.from.z(), 0);
    EXPECT_TRUE(line.from.x() == line.to.x() || line.from.y() == line.to.y());
  }
}

TEST(ContactLines, RunUnderABlockThatIsClose) {
  const std::vector<ContactLine> lines = lines_on_floor(with_cube_at(floor_scene(), 0.02));
  EXPECT_NEAR(length_of(lines), 2 * 4, 1e-12);
  for (const ContactLine& line : lines) {
    EXPECT_NEAR(line.gap, 0.02, 1e-12);
    EXPECT_NEAR(line.from.z(), 0, 1e-12);
  }
  EXPECT_TRUE(lines_on_floor(with_cube_at(floor_scene(), 1)).empty());
}

// A block that extends through the floor, with no edge in its plane.
TEST(ContactLines, RunWhereFacesCross) {
  const std::vector<ContactLine> lines = lines_on_floor(with_cube_at(floor_scene(), -0.4));
  EXPECT_NEAR(length_of(lines), 4, 1e-12);
}

// Objects on the side of the floor without patches cause no lines on the other side.
TEST(ContactLines, AreOfKeptSidesOnly) { EXPECT_TRUE(lines_on_floor(with_cube_at(floor_scene(), -1.1)).empty()); }

TEST(ContactLines, LeaveOutEdgesOfThePolygonItself) {
  Scene room = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(4, 3, 2), true);
  EXPECT_EQ(length_of(lines_on_floor(room)), 0);
}

// The triangles of a disc close over the floor end only at its rim.
TEST(ContactLines, LeaveOutEdgesOverWhichAFaceGoesOn) {
  Scene scene = floor_scene();
  constexpr int count = 24;
  const auto rim = [](int k) {
    const double angle = 2 * std::numbers::pi * k / count;
    return Point(2 + std::cos(angle), 2 + std::sin(angle), 0.01);
  };
  const auto centre = static_cast<std::uint32_t>(scene.vertices.size());
  scene.vertices.emplace_back(2, 2, 0.01);
  for (int k = 0; k < count; ++k) scene.vertices.push_back(rim(k));
  for (std::uint32_t k = 0; k < count; ++k)
    scene.polygons.push_back(
        {.corners = {centre, centre + 1 + (k + 1) % count, centre + 1 + k}, .material = 0, .group = 0, .line = 0});
  EXPECT_NEAR(length_of(lines_on_floor(scene)), count * 2 * std::sin(std::numbers::pi / count), 1e-9);
}

// They are the same lines after rotation, motion and scaling.
TEST(ContactLines, FollowTheScene) {
  const Scene scene = with_cube_at(with_box(floor_scene(), Point(3, 3, 0.03), Point(3.5, 3.5, 1), false), -0.4);
  const Eigen::Affine3d motion =
      Eigen::Translation3d(5, -6, 7) * Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized()) * Eigen::Scaling(0.01);
  const std::vector<ContactLine> here = lines_on_floor(scene);
  const std::vector<ContactLine> there = lines_on_floor(moved(scene, motion));
  ASSERT_EQ(here.size(), there.size());
  EXPECT_GT(here.size(), 8U);
  for (std::size_t k = 0; k < here.size(); ++k) {
    EXPECT_LT((motion * here[k].from - there[k].from).norm(), 1e-12);
    EXPECT_LT((motion * here[k].to - there[k].to).norm(), 1e-12);
    EXPECT_NEAR(0.01 * here[k].gap, there[k].gap, 1e-12);
  }
}

// 3,000 squares about one point cross each other in millions of lines.
TEST(ContactLines, AreNotLookedForWhereFacesCrossEverywhere) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  Scene scene = empty_scene({grey(0.5)});
  for (int k = 0; k < 3000; ++k) {
    const Eigen::Quaterniond turn(normal(random), normal(random), normal(random), normal(random));
    Quad quad{Point(-1, -1, 0), Point(1, -1, 0), Point(1, 1, 0), Point(-1, 1, 0)};
    for (Point& corner : quad) corner = turn.normalized() * corner;
    scene = with_quad(std::move(scene), quad);
  }
  const ContactLines lines = find_contact_lines(scene, front_sides(scene));
  EXPECT_TRUE(lines.everywhere);
  EXPECT_EQ(number_of(lines), 0U);
}

}  // namespace
}  // namespace patchlight::contact_lines_test
