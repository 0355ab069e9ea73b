
#include "base/sampling.h"
#include "form_factor/point_polygon.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>

namespace patchlight::solid_angle_test {
namespace {

using Square = std::array<Point, 4>;

const Square ceiling{Point(0, 0, 1), Point(0, 1, 1), Point(1, 1, 1), Point(1, 0, 1)};

double mean_weight(const Point& from, const Vector& normal, const Square& polygon) {
  double sum = 0;
  const auto points = scrambled_sobol(4096, 3);
  for (const auto& point : points) sum += sample_solid_angle(from, normal, polygon, point[0], point[1]).weight;
  return sum / static_cast<double>(points.size());
}

TEST(SampleSolidAngle, MeanWeightIsTheFormFactor) {
  // 4096 scrambled Sobol points integrate a smooth bounded weight to a few times 1e-4 at worst.
  const Vector up = Vector::UnitZ();
  EXPECT_NEAR(mean_weight(Point(0.5, 0.5, 0), up, ceiling), point_to_polygon(Point(0.5, 0.5, 0), up, ceiling), 3e-4);
  EXPECT_NEAR(mean_weight(Point(3, 0.2, 0), up, ceiling), point_to_polygon(Point(3, 0.2, 0), up, ceiling), 1e-4);
  // Very near, where area sampling has infinite variance, and partly below the horizon.
  EXPECT_NEAR(mean_weight(Point(0.3, 0.7, 0.999), up, ceiling), point_to_polygon(Point(0.3, 0.7, 0.999), up, ceiling),
              1e-3);
  const Vector tilted = Vector(1, 0, 0.2).normalized();
  EXPECT_NEAR(mean_weight(Point(0.5, 0.5, 0.5), tilted, ceiling),
              point_to_polygon(Point(0.5, 0.5, 0.5), tilted, ceiling), 1e-3);
}

// A strip seen almost edge on, from 0.5 to 2 m away: 6e-5 sr. Most of that comes from its near end, though most of its
// area is far. In meters, and rotated in millimeters. Weights vary by 4^3, so the mean of 4096 is accurate to a few
// times 1e-3.
TEST(SampleSolidAngle, MeanWeightOfASliverIsTheFormFactor) {
  const Square strip{Point(0.5, -0.1, 2e-4), Point(0.5, 0.1, 2e-4), Point(2, 0.1, 2e-4), Point(2, -0.1, 2e-4)};
  for (const double size : {1.0, 1e-3}) {
    const Eigen::AngleAxisd turn(size == 1 ? 0.0 : 0.7, Vector(1, 2, 3).normalized());
    Square placed = strip;
    for (Point& corner : placed) corner = size * (turn * corner);
    const Vector normal = turn * Vector::UnitX();
    const double exact = point_to_polygon(Point::Zero(), normal, placed);
    EXPECT_GT(exact, 1e-6);
    EXPECT_NEAR(mean_weight(Point::Zero(), normal, placed), exact, 5e-3 * exact) << size;
  }
}

TEST(SampleSolidAngle, PointsAreUniformInSolidAngle) {
  // The fraction of points in a part of the polygon is that part's fraction of the solid angle.
  const Point from(0.2, 0.1, 0.4);
  const auto solid_angle = [&](double x) {
    return -signed_solid_angle(from, Point(0, 0, 1), Point(0, 1, 1), Point(x, 1, 1)) -
           signed_solid_angle(from, Point(0, 0, 1), Point(x, 1, 1), Point(x, 0, 1));
  };
  int left = 0;
  const auto points = scrambled_sobol(4096, 8);
  for (const auto& point : points) {
    left += sample_solid_angle(from, Vector::UnitZ(), ceiling, point[0], point[1]).point.x() < 0.3;
  }
  EXPECT_NEAR(left / 4096.0, solid_angle(0.3) / solid_angle(1), 5e-3);
}

TEST(SampleSolidAngle, PointsLieOnThePolygon) {
  for (const auto& point : scrambled_sobol(1024, 8)) {
    const PolygonSample sample = sample_solid_angle(Point(0.5, 0.5, 0), Vector::UnitZ(), ceiling, point[0], point[1]);
    EXPECT_NEAR(sample.point.z(), 1, 1e-12);
    EXPECT_GE(sample.point.head<2>().minCoeff(), -1e-9);
    EXPECT_LE(sample.point.head<2>().maxCoeff(), 1 + 1e-9);
  }
}

TEST(SampleSolidAngle, FromBehindThereIsNothing) {
  EXPECT_EQ(sample_solid_angle(Point(0.5, 0.5, 2), -Vector::UnitZ(), ceiling, 0.5, 0.5).weight, 0);
  EXPECT_EQ(sample_solid_angle(Point(0.5, 0.5, 0), -Vector::UnitZ(), ceiling, 0.5, 0.5).weight, 0);
}

}  // namespace
}  // namespace patchlight::solid_angle_test
