// Faces whose outlines have many more corners than the requested number of patches, e.g. lids of round rooms.
#include "patchlight/simulate.h"
#include "patchlight/transport/assemble.h"

#include "base/parallel.h"
#include "mesh/mesher.h"
#include "scene/repair.h"
#include "support/diagnostics_of.h"
#include "support/scenes.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <tuple>

namespace patchlight::round_faces_test {
namespace {

using namespace test;

constexpr double radius = 4;

// An outline on a circle or, for a nonzero `depth`, on waves around it, so that it turns inward as often as outward.
std::vector<Point> outline(int corners, double z, double depth = 0) {
  std::vector<Point> points;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * k / corners;
    const double r = radius * (1 + depth * std::cos(7 * angle));
    points.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return points;
}

// A ring: the outline of its hole runs the other way and is joined to the outer one by a seam.
std::vector<Point> ring(int corners) {
  std::vector<Point> points = outline(corners, 0);
  points.push_back(points.front());
  const std::vector<Point> outer = outline(corners, 0);
  for (int k = 0; k <= corners; ++k) points.push_back(0.5 * outer[static_cast<std::size_t>((corners - k) % corners)]);
  return points;
}

// A closed room with a round floor and ceiling, and one wall per corner of these.
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

// n corners alone need n - 2 triangles. The lattice adds one point, so two triangles, for each four corners: half as
// many again, and a few at its rim. There are fewer if corners are left out. The area of the patches equals that of the
// polygon up to rounding.
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

// The request is 60 patches per side; the full outline would need half as many again as its corners. The edge is that
// of 60 equal triangles and follows the circle with 2 pi r / sqrt(8 r 0.005 edge) = 54 chords. With one inner point for
// four chords, n chords give 1.5 n triangles.
TEST(RoundFace, OfManyCornersTakesAboutThePatchesAskedFor) {
  for (const int corners : {200, 1000, 10000}) {
    const Scene scene = with_polygon(empty_scene({grey(0.5, 1)}), outline(corners, 0));
    Request request;
    request.mesh.patches = 60;
    request.mesh.sides = Sides::front;
    const Plan plan = make_plan(scene, request);
    EXPECT_LE(tessellate(scene, plan.sides, plan.max_edge).size(), 82U) << corners;
    EXPECT_TRUE(has(plan.notes, DiagnosticCode::fine_outline)) << corners;
  }
}

// Two discs on one axis at distance r: Howell's C-41 gives F = (3 - sqrt(5)) / 2. Patches lie between the circles of r
// (1 +- d), where d covers the stated deviation of outlines and the deviation of 2,000 corners from a circle. Exchange
// areas grow with either disc. Neither disc loses area, so the error is of second order in d, and d is below 1 %.
TEST(RoundFace, HasTheFormFactorOfADisc) {
  const auto exchange_area = [](double r1, double r2) {
    const double h = radius;
    const double sum = r1 * r1 + r2 * r2 + h * h;
    return std::numbers::pi / 2 * (sum - std::sqrt(sum * sum - 4 * r1 * r1 * r2 * r2));
  };
  std::vector<Point> above = outline(2000, radius);
  std::reverse(above.begin(), above.end());
  const Scene scene = with_polygon(with_polygon(empty_scene({grey(0.5)}), outline(2000, 0)), above);
  const KeptSides sides = kept_sides(scene, Sides::front);
  const double exact = exchange_area(radius, radius);
  for (const double edge : {3.0, 1.5, 0.8}) {
    const PatchMesh mesh = tessellate(scene, sides, edge);
    ASSERT_LT(mesh.size(), 1000U);
    const ExchangeAreas S = assemble_exchange_areas(mesh, Occluder(scene)).exchange_areas;
    double sum = 0;
    for (PatchIndex i = 0; i < mesh.first_patch[2]; ++i) {
      for (PatchIndex j = mesh.first_patch[2]; j < mesh.size(); ++j) sum += static_cast<double>(S.at(i, j));
    }
    const double d = 0.01 * edge / radius + 2e-6;
    EXPECT_GE(sum, exchange_area(radius * (1 - d), radius * (1 - d)));
    EXPECT_LE(sum, exchange_area(radius * (1 + d), radius * (1 + d)));
    EXPECT_NEAR(sum, exact, (d * d + 1e-5) * exact) << edge;
  }
}

// For small requested patches the outline does not matter. The number of patches is that of a square of equal area,
// within a fifth, and no patch is longer than requested.
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

// Furnace: E = 1 - rho in a closed room gives B = 1, even if slivers of the lid meet narrow walls. Row sums are exact
// to 1e-10 of the area, which 1 / (1 - rho) = 10 amplifies; the limit is 1e-8 as in other rooms.
TEST(RoundFace, IsTheLidOfAFurnace) {
  for (const double metres : {1.0, 0.001}) {
    const Scene scene = moved(round_room(120, 0.9, 0.1), turned(metres));
    Request request;
    request.mesh.patches = 60;
    request.solver.relative_error = 1e-10;
    request.mesh.sides = Sides::front;
    const Simulation simulation = simulate(scene, request);
    ASSERT_LE(simulation.mesh.size(), 2U * 186 + 120);
    ASSERT_TRUE(simulation.solution.converged);
    EXPECT_LT((simulation.solution.radiosity - 1).abs().maxCoeff(), 1e-8) << metres;
    EXPECT_TRUE(has(simulation.plan.notes, DiagnosticCode::fine_outline));
  }
}

// The same with a round plate of 1,000 corners that hangs in a cubic room and emits on both sides, and a lamp of 500
// corners in a round hole of the ceiling. The error is that of closure, independent of the approximation of the
// outlines.
TEST(RoundFace, InARoomIsPartOfAFurnace) {
  Scene scene = empty_scene({grey(0.9, 0.1)});
  const std::vector<Quad> faces = box_faces(Point(-6, -6, -1), Point(6, 6, 5), true);
  for (std::size_t k = 0; k < faces.size(); ++k) {
    if (k != 1) scene = with_quad(std::move(scene), faces[k]);
  }
  std::vector<Point> lamp = outline(500, 5);
  std::reverse(lamp.begin(), lamp.end());
  std::vector<Point> ceiling = {Point(6, 6, 5), Point(6, -6, 5), Point(-6, -6, 5), Point(-6, 6, 5), Point(6, 6, 5)};
  for (std::size_t k = 0; k <= lamp.size(); ++k) ceiling.push_back(lamp[(2 * lamp.size() - 1 - k) % lamp.size()]);
  scene = with_polygon(with_polygon(std::move(scene), lamp), ceiling);
  std::vector<Point> plate = outline(1000, 2);
  scene = with_polygon(std::move(scene), plate);
  std::reverse(plate.begin(), plate.end());
  scene = repair(with_polygon(std::move(scene), plate));
  Request request;
  request.mesh.patches = 400;
  request.solver.relative_error = 1e-10;
  request.mesh.sides = Sides::front;
  std::vector<Simulation> runs;
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    runs.push_back(simulate(scene, request));
    ASSERT_LE(runs.back().mesh.size(), 600U);
    ASSERT_TRUE(runs.back().solution.converged);
    EXPECT_LT((runs.back().solution.radiosity - 1).abs().maxCoeff(), 1e-8);
  }
  EXPECT_TRUE((runs[0].solution.radiosity == runs[1].solution.radiosity).all());
}

}  // namespace
}  // namespace patchlight::round_faces_test
