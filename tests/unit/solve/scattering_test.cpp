#include "solve/scattering.h"

#include "patchlight/solve/solve.h"

#include "base/vectors.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>

namespace patchlight::scattering_test {

constexpr Eigen::Index size = 6;

Scattering grey_and_coloured() {
  Scattering scattering{Field(size, 2)};
  scattering.reflectance << 0.5, 0.25, 0, 1, 1, 0, 0.75, 0.75, 0.125, 0, 0, 0.5;
  return scattering;
}

const Eigen::VectorXd areas = Eigen::VectorXd::LinSpaced(size, 1, 2);

// The first two patches are the sides of a sheet, and so are the last two. Nothing lies behind the others.
Scattering with_sheets() {
  Scattering scattering = grey_and_coloured();
  scattering.reflectance.row(1) << 0.1, 0.5;
  scattering.other_side = {1, 0, 2, 3, 5, 4};
  scattering.transmittance = Field::Zero(size, 2);
  for (const Eigen::Index i : {0, 1, 4, 5}) {
    const auto j = static_cast<Eigen::Index>(scattering.other_side[static_cast<std::size_t>(i)]);
    const double both = std::min(areas[i], areas[j]) / areas[i];
    scattering.transmittance.row(i) << (i < 2 ? 0.4 : 0.875) * both, (i < 2 ? 0.5 : 0.25) * both;
  }
  return scattering;
}

Eigen::ArrayXd product(const Field& x, const Field& y) {
  return ((x * y).colwise() * areas.array()).colwise().sum().transpose();
}

// <R x, y> = <x, R* y>.
TEST(Scattering, TheAdjointGivesTheSameProducts) {
  for (const Scattering& R : {grey_and_coloured(), with_sheets()}) {
    const Field x = Field::Random(size, 2);
    const Field y = Field::Random(size, 2);
    EXPECT_TRUE(((product(R.reflect(x), y) - product(x, R.adjoint(y))).abs() < 1e-14).all());
  }
}

// For known errors it equals R. Unknown errors have no effect where nothing is scattered.
TEST(Scattering, WhatScattersNothingHasNoErrorThatIsNotKnown) {
  constexpr double unknown = std::numeric_limits<double>::infinity();
  for (const Scattering& R : {grey_and_coloured(), with_sheets()}) {
    const Field error = Field::Random(size, 2).abs();
    EXPECT_TRUE(((reflected_error(R, error) - R.reflect(error)).abs() < 1e-15).all());
    const Field of_unknown = reflected_error(R, Field::Constant(size, 2, unknown));
    const Field share = R.reflect(Field::Ones(size, 2));
    EXPECT_TRUE(((share > 0).select(of_unknown == unknown, of_unknown == 0)).all());
  }
}

TEST(Scattering, NoFieldGrowsByMoreThanTheBound) {
  for (const Scattering& R : {grey_and_coloured(), with_sheets()}) {
    for (int k = 0; k < 20; ++k) {
      const Field x = Field::Random(size, 2);
      EXPECT_TRUE((area_norm(R.reflect(x), areas) <= R.norm_bound() * area_norm(x, areas) * (1 + 1e-14)).all());
    }
  }
}

TEST(Scattering, WhatIsNotReflectedIsAbsorbed) {
  const Scattering R = grey_and_coloured();
  const Field H = Field::Random(size, 2).abs();
  EXPECT_TRUE(((R.reflect(H) + absorb(R, H) - H).abs() < 1e-15).all());
}

// A sheet sends some of it out of the other side: the flux is the same.
TEST(Scattering, OfSheetsWhatIsNotScatteredIsAbsorbed) {
  const Scattering R = with_sheets();
  const Field H = Field::Random(size, 2).abs();
  const Field ones = Field::Ones(size, 2);
  EXPECT_TRUE(((product(R.reflect(H) + absorb(R, H), ones) - product(H, ones)).abs() < 1e-14).all());
  EXPECT_TRUE((absorb(R, H) >= -1e-15).all());
  EXPECT_TRUE((reflect_even(R, Eigen::Array2d(2, 3)) == R.reflect(scaled(ones, Eigen::Array2d(2, 3)))).all());
  EXPECT_TRUE(((reflected_square(R, H, areas) - product(H, R.reflect(H))).abs() < 1e-14).all());
}

// |dH| does not exceed the bound from |dB| = R |dH|.
TEST(Scattering, ErrorsOfIrradianceAreBoundedByThoseOfRadiosity) {
  const Scattering R = with_sheets();
  for (int k = 0; k < 20; ++k) {
    const Field off = Field::Random(size, 2).abs();
    const Field bound = irradiance_errors(R, R.reflect(off));
    const auto scatters = R.reflectance > 0 || R.transmittance > 0;
    EXPECT_TRUE((!scatters || bound >= off * (1 - 1e-14)).all());
  }
}

TEST(Scattering, VariancesOfBothSidesOfASheetAddUp) {
  const Scattering R = with_sheets();
  Field one = Field::Zero(size, 2);
  one.row(4).setOnes();
  EXPECT_TRUE(((reflected_variance(R, one) - R.reflect(one).square()).abs() < 1e-15).all());
}

TEST(Scattering, TheIrradianceIsFoundFromWhatItIsReflectedTo) {
  const Scattering R = grey_and_coloured();
  const Field H = Field::Random(size, 2).abs();
  const Field other = Field::Constant(size, 2, 7);
  const Field found = irradiance_behind(R, R.reflect(H), other);
  EXPECT_TRUE((R.reflectance > 0).select((found - H).abs() < 1e-15, found == other).all());
}

// D T = R. The plain norm of T h equals the area-weighted norm of R^1/2 h.
TEST(Scattering, TheSymmetricRootIsOfR) {
  const Scattering R = grey_and_coloured();
  const SymmetricRoot root(R, areas);
  const Field h = Field::Random(size, 2);
  EXPECT_TRUE(((root.radiosity_of(root.of_irradiance(h)) - R.reflect(h)).abs() < 1e-15).all());
  const Eigen::ArrayXd square = root.of_irradiance(h).square().colwise().sum().transpose();
  EXPECT_TRUE(((square - reflected_square(R, h, areas)).abs() < 1e-14).all());
  EXPECT_TRUE((root.of_irradiance(Field::Ones(size, 2)) == root.of_even_irradiance()).all());
}

TEST(Scattering, BandsCanBeTakenApart) {
  const Scattering R = grey_and_coloured();
  const Scattering twice = of_bands(R, {1, 1, 0});
  EXPECT_TRUE(same_in_bands(twice, 0, 1));
  EXPECT_FALSE(same_in_bands(twice, 1, 2));
  EXPECT_TRUE((twice.reflectance.col(2) == R.reflectance.col(0)).all());
  const Scattering sheets = of_bands(with_sheets(), {1, 0, 0});
  EXPECT_TRUE(same_in_bands(sheets, 1, 2));
  EXPECT_FALSE(same_in_bands(sheets, 0, 1));
  EXPECT_TRUE((sheets.transmittance.col(0) == with_sheets().transmittance.col(1)).all());
}

}  // namespace patchlight::scattering_test
