#include "light/spectra.h"

#include "light/photometry.h"

#include <array>
#include <gtest/gtest.h>
#include <numeric>

namespace patchlight::spectra_test {
namespace {

Eigen::Vector2d chromaticity(const SampledSpectrum& light) {
  const Eigen::Vector3d xyz = xyz_of_cells(in_cells(light, Beyond::zero));
  return xyz.head<2>() / xyz.sum();
}

// CIE 15:2004, table T.3: x and y to five digits, from tables of every nm. Here the values between the knots of 5 nm
// are interpolated.
TEST(Illuminants, HaveTheChromaticitiesOfCie) {
  EXPECT_LT((chromaticity(*illuminant_d65_spectrum()) - Eigen::Vector2d(0.31272, 0.32903)).norm(), 5e-5);
  EXPECT_LT((chromaticity(*illuminant_a_spectrum()) - Eigen::Vector2d(0.44758, 0.40745)).norm(), 5e-5);
}

// The tabulated values of A are rounded from the formula.
TEST(Illuminants, AIsItsFormula) {
  const SampledSpectrum a = *illuminant_a_spectrum();
  EXPECT_NEAR(a.values[180], 100, 1e-12);  // 560 nm
  EXPECT_NEAR(a.values[0], 9.795100, 5e-7);
  EXPECT_NEAR(a.values[400], 241.675, 5e-4);
}

// D65 is the daylight of 6504 K. Its table is rounded to six digits, from a formula with rounded factors M_1 and M_2.
// The table is linear between multiples of 10 nm by definition: CIE 15:2004, 3.1, note 4.
TEST(Illuminants, DaylightOfD65IsD65) {
  const Cells tabled = in_cells(*illuminant_d65_spectrum(), Beyond::zero);
  const Cells computed = in_cells(*daylight_spectrum(6504), Beyond::zero);
  EXPECT_LT((tabled - computed).abs().maxCoeff(), 0.06);
  EXPECT_GT((tabled - in_cells(*daylight_spectrum(5500), Beyond::zero)).abs().maxCoeff(), 5);
}

TEST(Primaries, SumUpToOneWithin0And1) {
  const std::array<Cells, 3>& primaries = reflectances_of_primaries();
  EXPECT_LT((primaries[0] + primaries[1] + primaries[2] - 1).abs().maxCoeff(), 1e-15);
  for (const Cells& primary : primaries) {
    EXPECT_GE(primary.minCoeff(), 0);
    EXPECT_LE(primary.maxCoeff(), 1);
  }
}

// Their defining property, up to the twelve digits of their table.
TEST(Primaries, HaveTheirColoursUnderD65) {
  const Cells d65 = in_cells(*illuminant_d65_spectrum(), Beyond::zero);
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d rgb =
        rgb_from_xyz() * xyz_of_cells(d65 * reflectances_of_primaries()[k]) / luminance_of_cells(d65);
    EXPECT_LT((rgb - Eigen::Vector3d::Unit(static_cast<Eigen::Index>(k))).norm(), 1e-9) << k;
  }
}

TEST(SampledSpectra, AreLinearBetweenTheirValues) {
  const SampledSpectrum spectrum{"", {400, 410, 500}, {1, 2, 0}};
  const Cells zero = in_cells(spectrum, Beyond::zero), end = in_cells(spectrum, Beyond::end);
  EXPECT_EQ(zero[0], 0);
  EXPECT_EQ(end[0], 1);
  EXPECT_DOUBLE_EQ(zero[20], 1.05);
  EXPECT_DOUBLE_EQ(zero[74], 2 * (1 - 44.5 / 90));
  EXPECT_EQ(zero[200], 0);
  EXPECT_EQ(end[200], 0);
  EXPECT_TRUE((in_cells({"", {550}, {0.3}}, Beyond::end) == 0.3).all());
}

TEST(SampledSpectra, OfWhiteHaveRgbOfOne) {
  EXPECT_LT((rgb_of_reflectance({"", {550}, {1}}) - 1).abs().maxCoeff(), 1e-12);
  const Spectrum d65 = rgb_of_light(*illuminant_d65_spectrum());
  EXPECT_LT((d65 - 1).abs().maxCoeff(), 5e-4);  // Rec. 709 rounds its luminances to four digits
  EXPECT_NEAR(luminance(rgb_of_light(*planckian_spectrum(1800))), luminous_efficacy, 1e-9);
}

}  // namespace
}  // namespace patchlight::spectra_test
