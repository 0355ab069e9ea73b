
#include "render/gathered_light.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

namespace patchlight::hemisphere_test {
namespace {

// A point at height 0 under a plane at height 1, whose radiosity is a linear function of x and y.
struct UnderAPlane {
  HemisphereIrradiance found;
  double mean_distance = 0;
};

double radiosity_at(const Point& point) { return 3 + 0.5 * point.x() - 0.25 * point.y(); }

UnderAPlane gathered_at(const Point& point) {
  const Hemisphere hemisphere(20000, Vector::UnitZ());
  const std::vector<Vector> directions = hemisphere.directions(7);
  Field radiosity(static_cast<Eigen::Index>(directions.size()), 1);
  std::vector<double> distances;
  for (std::size_t k = 0; k < directions.size(); ++k) {
    distances.push_back(1 / std::max(directions[k].z(), 0.05));
    radiosity(static_cast<Eigen::Index>(k), 0) = radiosity_at(point + distances.back() * directions[k]);
  }
  return {hemisphere.irradiance(radiosity, distances), hemisphere.harmonic_mean(distances)};
}

TEST(Hemisphere, FindsTheIrradianceOfALinearRadiosity) {
  // The radiosity straight above, by symmetry.
  const Point point(0.2, -0.4, 0);
  const UnderAPlane there = gathered_at(point);
  EXPECT_NEAR(there.found.irradiance[0], radiosity_at(point), 4 * std::sqrt(there.found.variance[0]) + 1e-3);
  // int 1/r = int cos: 2/3 over the hemisphere weighted by the cosine
  EXPECT_NEAR(there.mean_distance, 1.5, 0.01);
}

TEST(Hemisphere, FindsTheGradientOfALinearRadiosity) {
  const UnderAPlane there = gathered_at(Point(0, 0, 0));
  EXPECT_NEAR(there.found.gradient(0, 0), 0.5, 0.05);
  EXPECT_NEAR(there.found.gradient(1, 0), -0.25, 0.05);
  EXPECT_NEAR(there.found.gradient(2, 0), 0, 0.05);
}

TEST(Hemisphere, OfOneRadiosityHasThatAndNoGradient) {
  const Hemisphere hemisphere(300, Vector(1, 2, -2) / 3);
  const auto count = static_cast<Eigen::Index>(hemisphere.directions(1).size());
  const std::vector<double> distances(static_cast<std::size_t>(count), 2.0);
  const HemisphereIrradiance found = hemisphere.irradiance(Field::Constant(count, 2, 5), distances);
  EXPECT_NEAR(found.irradiance[1], 5, 1e-12);
  EXPECT_EQ(found.variance[0], 0);
  EXPECT_EQ(found.gradient.abs().maxCoeff(), 0);
}

IrradianceRecord record_of_linear(const Point& point, double radius) {
  Field gradient(3, 1);
  gradient << 0.5, -0.25, 0;
  return {point, Vector::UnitZ(), radius, Spectrum::Constant(1, radiosity_at(point)), gradient, 0.1};
}

TEST(IrradianceCache, InterpolatesALinearIrradianceExactly) {
  IrradianceCache cache(Eigen::VectorXd::Ones(1));
  cache.add(record_of_linear(Point(0, 0, 0), 1));
  cache.add(record_of_linear(Point(0.7, 0.2, 0), 0.8));
  const Point between(0.4, 0.1, 0);
  const auto found = cache.at(between, Vector::UnitZ());
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->irradiance[0], radiosity_at(between), 1e-12);
  // Two records that agree have a smaller error than each.
  EXPECT_LT(found->deviation, 0.1);
  EXPECT_GT(found->deviation, 0.05);
}

TEST(IrradianceCache, GradesRadii) {
  IrradianceCache cache(Eigen::VectorXd::Ones(1));
  cache.add_graded({record_of_linear(Point(0, 0, 0), 1)});
  cache.add_graded({record_of_linear(Point(0.5, 0, 0), 0.1)});
  // The radius of the first is now 0.1 + 0.4 * 0.5.
  EXPECT_GT(cache.weight_at(Point(0, 0.29, 0), Vector::UnitZ()), 0);
  EXPECT_EQ(cache.weight_at(Point(0, 0.31, 0), Vector::UnitZ()), 0);
}

TEST(IrradianceCache, ServesOneSideOfOneSurfaceUpToARadius) {
  IrradianceCache cache(Eigen::VectorXd::Ones(1));
  cache.add(record_of_linear(Point(0, 0, 0), 1));
  EXPECT_NEAR(cache.weight_at(Point(0.25, 0, 0), Vector::UnitZ()), 0.75, 1e-12);
  EXPECT_FALSE(cache.at(Point(1.01, 0, 0), Vector::UnitZ()));
  EXPECT_FALSE(cache.at(Point(0.1, 0, 0), -Vector::UnitZ()));
  EXPECT_FALSE(cache.at(Point(0.1, 0, -0.3), Vector::UnitZ()));
}

}  // namespace
}  // namespace patchlight::hemisphere_test
