// Faces whose outlines have many more corners than patches are asked for, as lids of round rooms.
#include "patchlight/simulate.h"

#include "mesh/mesher.h"
#include "support/scenes.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <tuple>

namespace patchlight::round_faces_test {
namespace {

using namespace test;

constexpr double radius = 4;

// On a circle or, where `depth` is not 0, on waves around it, so that the outline turns inward as often as outward.
std::vector<Point> outline(int corners, double z, double depth = 0) {
  std::vector<Point> points;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * k / corners;
    const double r = radius * (1 + depth * std::cos(7 * angle));
    points.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return points;
}

// A ring: its hole's outline runs the other way and hangs on the outer one by a seam.
std::vector<Point> ring(int corners) {
  std::vector<Point> points = outline(corners, 0);
  points.push_back(points.front());
  const std::vector<Point> outer = outline(corners, 0);
  for (int k = 0; k <= corners; ++k) points.push_back(0.5 * outer[static_cast<std::size_t>((corners - k) % corners)]);
  return points;
}

// A closed room with a round floor and ceiling and as many walls as these have corners.
Scene round_room(int corners, double reflectance, double exitance) {
  Scene scene = empty_scene({grey(reflectance, exitance)});
  const std::vector<Point> floor = outline(corners, 0);
  std::vector<Point> ceiling = outline(corners, 3);
  for (std::size_t k = 0; k < floor.size(); ++k) {
    const std::size_t next = (k + 1) % floor.size();
    scene = with_quad(std::move(scene), {floor[next], floor[k], ceiling[k], ceiling[next]});
  }
  std::reverse(ceiling.begin(), ceiling.end());
  return with_polygon(with_polygon(std::move(scene), floor), ceiling);
}

Eigen::Affine3d turned(double metres) {
  return Eigen::Scaling(metres) * Eigen::AngleAxisd(0.7, Vector(1, -2, 0.5).normalized()) *
         Eigen::Translation3d(10, -20, 5);
}

PatchMesh meshed(const std::vector<Point>& corners, double metres, double edge) {
  const Scene scene = moved(with_polygon(empty_scene({grey(0.5)}), corners), turned(metres));
  return tessellate(scene, kept_sides(scene, Sides::front), metres * edge);
}

class RoundFace : public testing::TestWithParam<std::tuple<int, double>> {};

// n corners take n - 2 triangles by themselves. The lattice adds a point for four corners, two triangles each: half as
// many again, and some at its rim. No area is lost: that of the patches is the polygon's, to rounding.
TEST_P(RoundFace, TakesNoMoreThanHalfAsManyPatchesAgainAsItsOutline) {
  const auto [corners, metres] = GetParam();
  for (const double depth : {0.0, 0.1}) {
    const std::vector<Point> points = outline(corners, 0, depth);
    const PatchMesh mesh = meshed(points, metres, 3.5);
    EXPECT_LE(static_cast<double>(mesh.size()), 1.55 * corners) << depth;
    const double area = area_vector(points).norm() * metres * metres;
    double sum = 0;
    for (const double one : mesh.area) {
      EXPECT_GT(one, 0);
      sum += one;
    }
    EXPECT_NEAR(sum, area, 1e-9 * area) << depth;
  }
}

INSTANTIATE_TEST_SUITE_P(Corners, RoundFace,
                         testing::Combine(testing::Values(40, 200, 400, 2500), testing::Values(1.0, 0.001)));

TEST(RoundFace, OfARingTakesNoMoreEither) {
  const std::vector<Point> points = ring(200);
  const PatchMesh mesh = meshed(points, 1, 3.5);
  EXPECT_LE(static_cast<double>(mesh.size()), 1.55 * static_cast<double>(points.size()));
  double sum = 0;
  for (const double one : mesh.area) sum += one;
  EXPECT_NEAR(sum, area_vector(points).norm(), 1e-9 * sum);
}

// Where small patches are asked for the outline does not matter: as many as of a square with that area, to a fifth, and
// none longer than asked.
TEST(RoundFace, IsCutFinelyWhereThatIsAskedFor) {
  const PatchMesh mesh = meshed(outline(200, 0), 1, 0.3);
  const double of_triangles = std::numbers::pi * radius * radius / (std::sqrt(3.0) / 4 * 0.3 * 0.3);
  EXPECT_GT(static_cast<double>(mesh.size()), of_triangles);
  EXPECT_LT(static_cast<double>(mesh.size()), 1.9 * of_triangles);
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const PatchCorners corners = mesh.corner_points(i);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_LE((corners.points[(k + 1) % 3] - corners.points[k]).norm(), 0.3 * (1 + 1e-8));
  }
}

// Furnace: E = 1 - rho in a closed room has B = 1, also where slivers of the lid meet narrow walls. Row sums are closed
// to 1e-10 of the area, which 1 / (1 - rho) = 10 raises; 1e-8 as in other rooms.
TEST(RoundFace, IsTheLidOfAFurnace) {
  for (const double metres : {1.0, 0.001}) {
    const Scene scene = moved(round_room(120, 0.9, 0.1), turned(metres));
    Request request;
    request.patches = 60;
    request.tolerance = 1e-10;
    request.sides = Sides::front;
    const Simulation simulation = simulate(scene, request);
    ASSERT_LE(simulation.mesh.size(), 2U * 186 + 120);
    ASSERT_TRUE(simulation.solution.converged);
    EXPECT_LT((simulation.solution.radiosity - 1).abs().maxCoeff(), 1e-8) << metres;
    EXPECT_TRUE(std::any_of(simulation.plan.notes.begin(), simulation.plan.notes.end(), [](const std::string& note) {
      return note.find("outline of up to 120 corners") != std::string::npos;
    }));
  }
}

}  // namespace
}  // namespace patchlight::round_faces_test
