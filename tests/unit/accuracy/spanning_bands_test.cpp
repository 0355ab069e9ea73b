#include "accuracy/errors.h"

#include <cmath>
#include <gtest/gtest.h>

namespace patchlight::spanning_bands_test {
namespace {

constexpr Eigen::Index patches = 50;
constexpr Eigen::Index bands = 12;

Eigen::VectorXd areas() { return Eigen::VectorXd::LinSpaced(patches, 0.5, 2); }

// Two kinds of light, whose strengths differ much from band to band, and `more` of a third.
Field of_two_lights(double more) {
  Field field(patches, bands);
  for (Eigen::Index i = 0; i < patches; ++i) {
    for (Eigen::Index b = 0; b < bands; ++b) {
      const double strength = std::pow(10.0, static_cast<double>(b % 5) - 2);
      const double x = static_cast<double>(i);
      const double y = static_cast<double>(b);
      field(i, b) = strength * (2 + std::sin(x) * std::cos(y) + more * std::sin(x * y + x * x));
    }
  }
  return field;
}

Eigen::ArrayXd norms(const Field& field) {
  return (field.square().colwise() * areas().array()).colwise().sum().sqrt().transpose();
}

// Two bands span a field of two degrees of freedom. They also span dark bands.
TEST(SpanningBands, AreAsManyAsThereAreDegreesOfFreedom) {
  const Field field = of_two_lights(0);
  const SpanningBands spanning = spanning_bands(field, areas(), 1e-6);
  EXPECT_EQ(spanning.bands.size(), 2U);
  EXPECT_FALSE(spanning.spans_all());
  const Field all = spanning.all_bands(spanning.of(field));
  EXPECT_TRUE((norms(all - field) <= 1e-6 * norms(field)).all());
}

// The omitted part of a band is below the tolerance of its norm. Smaller tolerances take more bands.
TEST(SpanningBands, TellEveryBandToTheTolerance) {
  const Field field = of_two_lights(1e-2);
  std::size_t before = 0;
  for (const double tolerance : {0.1, 1e-2, 1e-3}) {
    const SpanningBands spanning = spanning_bands(field, areas(), tolerance);
    const Field all = spanning.all_bands(spanning.of(field));
    EXPECT_TRUE((norms(all - field) <= 1.01 * tolerance * norms(field)).all()) << tolerance;
    EXPECT_GE(spanning.bands.size(), before);
    before = spanning.bands.size();
  }
  EXPECT_GT(before, 2U);
}

TEST(SpanningBands, OfThreeBandsAreThemselves) {
  const Field field = of_two_lights(0).leftCols(3);
  const SpanningBands spanning = spanning_bands(field, areas(), 0.1);
  EXPECT_TRUE(spanning.spans_all());
  EXPECT_TRUE((spanning.all_bands(spanning.of(field)) == field).all());
}

TEST(SpanningBands, OfNoLightAreNone) {
  Field field = of_two_lights(0);
  field.col(4) = 0;
  const SpanningBands spanning = spanning_bands(field, areas(), 1e-6);
  EXPECT_TRUE((spanning.all_bands(spanning.of(field)).col(4) == 0).all());
  const SpanningBands none = spanning_bands(Field::Zero(patches, bands), areas(), 1e-6);
  EXPECT_TRUE(none.bands.empty());
  EXPECT_TRUE((none.all_bands(none.of(Field::Zero(patches, bands))) == Field::Zero(patches, bands)).all());
}

}  // namespace
}  // namespace patchlight::spanning_bands_test
