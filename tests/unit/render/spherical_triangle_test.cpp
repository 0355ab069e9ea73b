#include "base/sampling.h"
#include "form_factor/point_polygon.h"
#include "render/light_samples.h"

#include <gtest/gtest.h>
#include <numbers>

namespace patchlight::spherical_triangle_test {
namespace {

constexpr double pi = std::numbers::pi;

TEST(SphericalTriangle, OfAnOctantHasAnEighthOfTheSphere) {
  for (const auto& corners : {std::array<Point, 3>{Point(2, 0, 0), Point(0, 1, 0), Point(0, 0, 3)},
                              std::array<Point, 3>{Point(2, 0, 0), Point(0, 0, 3), Point(0, 1, 0)}}) {
    const SphericalTriangle octant(Point(0, 0, 0), corners);
    EXPECT_NEAR(octant.solid_angle(), pi / 2, 1e-12);
    EXPECT_TRUE(octant.contains(Vector(1, 1, 1)));
    EXPECT_FALSE(octant.contains(Vector(1, 1, -0.1)));
    EXPECT_FALSE(octant.contains(Vector(-1, -1, -1)));
  }
}

TEST(SphericalTriangle, IsEmptySeenFromItsEdge) {
  const SphericalTriangle flat(Point(0, 0, 0), {Point(1, 0, 0), Point(1, 1, 0), Point(2, 0.5, 0)});
  EXPECT_NEAR(flat.solid_angle(), 0, 1e-12);
}

TEST(SphericalTriangle, DirectionsAreUniformInItsSolidAngle) {
  // The mean of the cosine to an axis is pi F / omega. The mean of a part's indicator is its fraction of the solid
  // angle.
  const Point from(0.3, -0.2, 0);
  const std::array<Point, 3> corners{Point(-1, 1, 0.5), Point(1.5, 1, 0.4), Point(0.2, 0.6, 2)};
  const SphericalTriangle triangle(from, corners);
  const Point half = 0.5 * (corners[0] + corners[1]);
  const SphericalTriangle part(from, {corners[0], half, corners[2]});
  const SphericalTriangle rest(from, {half, corners[1], corners[2]});
  EXPECT_NEAR(part.solid_angle() + rest.solid_angle(), triangle.solid_angle(), 1e-12);
  constexpr int count = 1 << 14;
  double cosines = 0, inside = 0;
  for (const auto& u : scrambled_sobol(count, 3)) {
    const Vector direction = triangle.direction(u[0], u[1]);
    EXPECT_NEAR(direction.norm(), 1, 1e-12);
    cosines += direction.z() / count;
    inside += part.contains(direction) ? 1.0 / count : 0;
  }
  // Owen-scrambled points: errors of discontinuous functions fall as n^-3/4, with a constant of about 1.
  EXPECT_NEAR(inside, part.solid_angle() / triangle.solid_angle(), 1e-3);
  const std::array<Point, 3> seen{corners[0], corners[2], corners[1]};
  const double form_factor =
      point_to_polygon(from, Vector::UnitZ(), seen) + point_to_polygon(from, Vector::UnitZ(), corners);
  EXPECT_NEAR(cosines, pi * form_factor / triangle.solid_angle(), 1e-4);
}

TEST(SphericalTriangle, OfSmallSizeKeepsItsDirections) {
  // 1 mm at 10 m
  const SphericalTriangle small(Point(0, 0, 0), {Point(10, 0, 0), Point(10, 1e-3, 0), Point(10, 0, 1e-3)});
  EXPECT_NEAR(small.solid_angle(), 5e-9, 1e-14);
  for (const auto& u : scrambled_sobol(64, 1)) {
    const Vector direction = small.direction(u[0], u[1]);
    EXPECT_GT(direction.x(), 1 - 1e-8);
  }
}

}  // namespace
}  // namespace patchlight::spherical_triangle_test
