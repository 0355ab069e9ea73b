// Pairs of patches that are coplanar, straddle each other's plane or are half hidden.
#include "patchlight/transport/assemble.h"

#include "form_factor/patch_shape.h"
#include "mesh/mesher.h"
#include "support/scenes.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

namespace patchlight::pairs_test {
namespace {

using namespace test;

Scene two_polygons(const std::vector<Point>& first, const std::vector<Point>& second) {
  return with_polygon(with_polygon(empty_scene({grey(0.5)}), first), second);
}

// Exchange area between the first two polygons of a scene.
double exchange_between(const Scene& scene, double max_edge, const AssemblyOptions& options = {}) {
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), max_edge);
  const ExchangeAreas S = assemble_exchange_areas(mesh, Occluder(scene), options).exchange_areas;
  const PatchRange firsts = mesh.patches_on(0, Side::front);
  const PatchRange seconds = mesh.patches_on(1, Side::front);
  double sum = 0;
  for (PatchIndex i = firsts.begin; i < firsts.end; ++i) {
    for (PatchIndex j = seconds.begin; j < seconds.end; ++j) sum += static_cast<double>(S.at(i, j));
  }
  return sum;
}

const std::vector<Point> square{Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)};

std::vector<Point> placed(std::vector<Point> polygon, const Eigen::Affine3d& motion) {
  for (Point& corner : polygon) corner = motion * corner;
  return polygon;
}

// Different polygons in one plane exchange exactly nothing, near or far, for any orientation and distance from the
// origin, although rounding lifts corners out of the plane.
TEST(CoplanarPolygons, ExchangeExactlyNothing) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 20; ++k) {
    Eigen::Affine3d motion(
        Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized());
    motion.translation() = 1e4 * Vector(normal(random), normal(random), normal(random));
    for (const double shift : {1.0, 1.5, 20.0}) {
      const Eigen::Affine3d aside(Eigen::Translation3d(shift, 0.3, 0));
      const Scene scene = two_polygons(placed(square, motion), placed(square, motion * aside));
      EXPECT_EQ(exchange_between(scene, 0.5001), 0);
      EXPECT_EQ(exchange_between(scene, 2), 0);
    }
  }
}

// Patches that cross each other's plane exchange the same as their fine subdivision, whose pieces lie almost all on one
// side. The cases are near and far pairs in which one patch or both straddle.
TEST(StraddlingPatches, AgreeWithFineSubdivision) {
  for (const double distance : {0.6, 1.5, 5.0, 12.0}) {
    for (const double tilt : {-0.4, 0.2, 0.6}) {
      for (const double drop : {-0.2, -0.5, -0.75}) {
        // The second square is turned to face the first one and then lowered through its plane.
        const Eigen::Affine3d motion = Eigen::Translation3d(distance + 0.5, 0.2, drop) *
                                       Eigen::AngleAxisd(-tilt, Vector::UnitY()) *
                                       Eigen::AngleAxisd(-M_PI / 2, Vector::UnitY());
        const Scene scene = two_polygons(square, placed(square, motion));
        const auto shapes = patch_shapes(tessellate(scene, kept_sides(scene, Sides::front), 2));
        ASSERT_EQ(orientation(shapes[0], shapes[1]), Orientation::straddling) << distance << " " << tilt << " " << drop;
        const double fine = exchange_between(scene, 1.0 / 12 + 1e-6);
        EXPECT_NEAR(exchange_between(scene, 2), fine, 1e-3 * fine) << distance << " " << tilt << " " << drop;
      }
    }
  }
}

// Two opposed unit squares at distance 1 with a right triangle halfway between them that covers half of the cross
// section. It hides half of the exchange, by symmetry under a half turn about the line through their middles.
Scene half_hidden(int rotation, bool turned_over) {
  std::vector<Point> triangle{Point(0, 0, 0.5), Point(1, 0, 0.5), Point(1, 1, 0.5)};
  std::rotate(triangle.begin(), triangle.begin() + rotation, triangle.end());
  if (turned_over) std::reverse(triangle.begin(), triangle.end());
  const std::vector<Point> ceiling{Point(0, 0, 1), Point(0, 1, 1), Point(1, 1, 1), Point(1, 0, 1)};
  return with_polygon(two_polygons(square, ceiling), triangle);
}

constexpr double half = 0.5 * 0.19982489569838732;  // Howell's catalog, C-11

// The triangle blocks the same rays for any first corner and either orientation.
TEST(HalfHiddenSquares, DoNotDependOnTheTrianglesFirstCorner) {
  const AssemblyOptions options{256, 1};
  const double expected = exchange_between(half_hidden(0, false), 2, options);
  for (int rotation = 0; rotation < 3; ++rotation) {
    for (const bool turned_over : {false, true}) {
      EXPECT_EQ(exchange_between(half_hidden(rotation, turned_over), 2, options), expected);
    }
  }
}

// n = 4 x `samples` independent rays, as the pair is near, give the half with a relative error of 1 / sqrt(n): the
// hidden fraction has the variance 1/4 / n, and the weights vary little. Stratified samples are no worse.
TEST(HalfHiddenSquares, ExchangeHalf) {
  // 1. Each seed is within three of these standard errors, and with 4,096 samples within 1e-3 of a form factor.
  // 2. The mean over the seeds is within three of its own standard errors, so the estimate is unbiased.
  for (const int samples : {16, 64, 256, 4096}) {
    const int seeds = samples == 4096 ? 8 : 128;
    double sum = 0;
    double squares = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
      const double value = exchange_between(half_hidden(0, false), 2, {samples, static_cast<std::uint64_t>(seed)});
      EXPECT_NEAR(value, half, 3 * half / std::sqrt(4.0 * samples)) << samples << " samples, seed " << seed;
      if (samples == 4096) {
        EXPECT_NEAR(value, half, 1e-3) << seed;
      }
      sum += value;
      squares += value * value;
    }
    const double mean = sum / seeds;
    const double standard_error = std::sqrt(std::max(0.0, squares / seeds - mean * mean) / (seeds - 1));
    EXPECT_GT(standard_error, 0);
    EXPECT_LT(std::abs(mean - half), 3 * standard_error) << samples;
  }
}

}  // namespace
}  // namespace patchlight::pairs_test
