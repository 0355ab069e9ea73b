#include "base/vectors.h"

#include "base/parallel.h"

#include <gtest/gtest.h>
#include <vector>

namespace patchlight::vectors_test {

Field two_bands() {
  Field x(3, 2);
  x << 1, -2, 3, 4, 5, 0.5;
  return x;
}

TEST(Vectors, SumsAreOverPatchesAndOnePerBand) {
  const Field x = two_bands();
  const Eigen::Vector3d area(2, 1, 0.5);
  EXPECT_TRUE((sum_over_patches(x) == Eigen::Array2d(9, 2.5)).all());
  EXPECT_TRUE((area_sum(x, area) == Eigen::Array2d(7.5, 0.25)).all());
  EXPECT_TRUE((dot(x, x) == Eigen::Array2d(35, 20.25)).all());
  EXPECT_TRUE((inner_product(x, x, area) == Eigen::Array2d(23.5, 24.125)).all());
  EXPECT_TRUE((highest(x) == Eigen::Array2d(5, 4)).all());
}

// A band has the same sums as alone, to rounding: the set of bands solved together does not matter.
TEST(Vectors, BandsDoNotMix) {
  const Field x = Field::Random(1000, 5);
  const Field y = Field::Random(1000, 5);
  const Eigen::ArrayXd all = dot(x, y);
  for (Eigen::Index band = 0; band < x.cols(); ++band) {
    EXPECT_NEAR(dot(x.col(band), y.col(band))[0], all[band], 1e-12);
    EXPECT_EQ(highest(x.col(band))[0], highest(x)[band]);
  }
}

// More patches than one block holds.
TEST(Vectors, SeveralFieldsAtOnceAreAsOneAfterTheOther) {
  constexpr Eigen::Index patches = 5000;
  const Eigen::VectorXd area = Eigen::VectorXd::Random(patches).cwiseAbs();
  const Field x = Field::Random(patches, 3);
  const std::vector<Field> fields{Field::Random(patches, 3), Field::Random(patches, 3)};
  const Eigen::ArrayXXd products = inner_products(x, fields, area);
  ASSERT_EQ(products.rows(), 2);
  Field sum = x;
  for (Eigen::Index k = 0; k < 2; ++k) {
    const Field& field = fields[static_cast<std::size_t>(k)];
    EXPECT_TRUE(products.row(k).isApprox(inner_product(x, field, area).transpose(), 1e-12));
    sum += scaled(field, products.row(k).transpose());
  }
  EXPECT_TRUE(plus_combination(x, fields, products).isApprox(sum, 1e-12));
}

TEST(Vectors, SeveralFieldsGiveTheSameBitsOnAnyNumberOfThreads) {
  const Eigen::VectorXd area = Eigen::VectorXd::Random(20000).cwiseAbs();
  const std::vector<Field> fields{Field::Random(20000, 2), Field::Random(20000, 2)};
  const auto products = [&](int threads) {
    const ThreadLimit limit(threads);
    return inner_products(fields[0], fields, area);
  };
  EXPECT_TRUE((products(1) == products(2)).all());
}

TEST(Vectors, AQuotientByNothingIsNothing) {
  EXPECT_TRUE((quotient(Eigen::Array2d(3, 1), Eigen::Array2d(2, 0)) == Eigen::Array2d(1.5, 0)).all());
  EXPECT_TRUE((scaled(two_bands(), Eigen::Array2d(0, 2)).col(1) == 2 * two_bands().col(1)).all());
}

}  // namespace patchlight::vectors_test
