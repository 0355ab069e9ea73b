#include "solve/scattering.h"

#include <gtest/gtest.h>

namespace patchlight::scattering_test {

constexpr Eigen::Index size = 6;

Scattering grey_and_coloured() {
  Scattering scattering{Field(size, 2)};
  scattering.reflectance << 0.5, 0.25, 0, 1, 1, 0, 0.75, 0.75, 0.125, 0, 0, 0.5;
  return scattering;
}

const Eigen::VectorXd areas = Eigen::VectorXd::LinSpaced(size, 1, 2);

Eigen::ArrayXd product(const Field& x, const Field& y) {
  return ((x * y).colwise() * areas.array()).colwise().sum().transpose();
}

// <R x, y> = <x, R* y>.
TEST(Scattering, TheAdjointGivesTheSameProducts) {
  const Scattering R = grey_and_coloured();
  const Field x = Field::Random(size, 2);
  const Field y = Field::Random(size, 2);
  EXPECT_TRUE(((product(R.reflect(x), y) - product(x, R.adjoint(y))).abs() < 1e-14).all());
}

TEST(Scattering, NoFieldGrowsByMoreThanTheBound) {
  const Scattering R = grey_and_coloured();
  for (int k = 0; k < 20; ++k) {
    const Field x = Field::Random(size, 2);
    EXPECT_TRUE((area_norm(R.reflect(x), areas) <= R.norm_bound() * area_norm(x, areas) * (1 + 1e-14)).all());
  }
}

TEST(Scattering, WhatIsNotReflectedIsAbsorbed) {
  const Scattering R = grey_and_coloured();
  const Field H = Field::Random(size, 2).abs();
  EXPECT_TRUE(((R.reflect(H) + absorb(R, H) - H).abs() < 1e-15).all());
}

TEST(Scattering, TheIrradianceIsFoundFromWhatItIsReflectedTo) {
  const Scattering R = grey_and_coloured();
  const Field H = Field::Random(size, 2).abs();
  const Field other = Field::Constant(size, 2, 7);
  const Field found = irradiance_behind(R, R.reflect(H), other);
  EXPECT_TRUE((R.reflectance > 0).select((found - H).abs() < 1e-15, found == other).all());
}

// D T = R, and T h is measured by the plain norm as R^1/2 h is by that weighted by area.
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
}

}  // namespace patchlight::scattering_test
