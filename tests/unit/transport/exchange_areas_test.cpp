#include "patchlight/transport/exchange_areas.h"

#include "patchlight/transport/dense.h"

#include "transport/narrow.h"

#include <cmath>
#include <gtest/gtest.h>

namespace patchlight {
namespace {

constexpr PatchIndex edge = ExchangeAreas::edge;

double entry(PatchIndex i, PatchIndex j) { return i == j ? 0 : std::abs(std::sin(static_cast<double>(i * j + i + j))); }

// 150 patches: two whole blocks and a part of one.
constexpr PatchIndex size = 150;

ExchangeAreas filled() {
  ExchangeAreas S(size);
  for (PatchIndex i = 0; i < size; ++i) {
    for (PatchIndex j = 0; j < size; ++j) {
      if (i / edge > j / edge) continue;
      const std::size_t slot = static_cast<std::size_t>(i % edge) * edge + j % edge;
      S.tile(i / edge, j / edge)[slot] = static_cast<float>(entry(i, j));
    }
  }
  return S;
}

Eigen::MatrixXd full_matrix() {
  Eigen::MatrixXd matrix(size, size);
  for (PatchIndex i = 0; i < size; ++i) {
    for (PatchIndex j = 0; j < size; ++j) matrix(i, j) = static_cast<double>(static_cast<float>(entry(i, j)));
  }
  return matrix;
}

Field radiosity() {
  Field B(size, 3);
  for (Eigen::Index i = 0; i < size; ++i) B.row(i) << std::cos(static_cast<double>(i)), 1, 0.1 * static_cast<double>(i);
  return B;
}

Eigen::VectorXd areas() { return Eigen::VectorXd::LinSpaced(size, 1, 2); }

// Remainders large enough to notice.
Eigen::VectorXd remainders() { return Eigen::VectorXd::LinSpaced(size, 0.5, 0.1); }

std::unique_ptr<RowTransport> transport() { return dense_transport({filled(), remainders(), "test"}, areas()); }

// Sums of 150 products in another order: 150 roundings of terms up to 15.
constexpr double rounding = 1e-11;

TEST(ExchangeAreas, MultiplyLikeAFullMatrix) {
  const Field expected = (full_matrix() * radiosity().matrix()).array();
  EXPECT_LT((multiply(filled(), radiosity()) - expected).abs().maxCoeff(), rounding);
  // Squares are rounded to float: 1e-7 of sums of up to 150 terms of up to 15.
  const Field squared = (full_matrix().cwiseAbs2() * radiosity().matrix()).array();
  EXPECT_LT((multiply(filled(), radiosity(), 2) - squared).abs().maxCoeff(), 150 * 15 * 1e-7);
}

TEST(ExchangeAreas, AreReadBackSymmetrically) {
  const ExchangeAreas S = filled();
  EXPECT_EQ(S.at(3, 140), static_cast<float>(entry(3, 140)));
  EXPECT_EQ(S.at(140, 3), S.at(3, 140));
  EXPECT_EQ(ExchangeAreas::bytes(size), 6 * 64 * 64 * sizeof(float));
}

TEST(DenseTransport, ItsFourViewsAgree) {
  const auto F = transport();
  const Field whole = F->apply(radiosity());
  const Eigen::MatrixXd with_remainder = full_matrix() + Eigen::MatrixXd(remainders().asDiagonal());
  const Field expected = (with_remainder * radiosity().matrix()).array().colwise() / areas().array();
  EXPECT_LT((whole - expected).abs().maxCoeff(), rounding);

  const PatchRange range{60, 135};
  EXPECT_LT((F->gather(range, radiosity()) - whole.middleRows(60, 75)).abs().maxCoeff(), rounding);

  Field only = Field::Zero(size, 3);
  only.middleRows(60, 75) = radiosity().middleRows(60, 75);
  EXPECT_LT((F->shoot(range, radiosity().middleRows(60, 75)) - F->apply(only)).abs().maxCoeff(), rounding);

  const Eigen::MatrixXd block = F->form_factors(range, {0, size});
  // The exported form factors leave the remainder out: F_ii of a flat patch is 0.
  const Field own = (radiosity().colwise() * (remainders().array() / areas().array())).middleRows(60, 75);
  const Field seen = (block * radiosity().matrix()).array() + own;
  EXPECT_LT((seen - whole.middleRows(60, 75)).abs().maxCoeff(), rounding);
}

TEST(DenseTransport, KeepsReciprocity) {
  const auto F = transport();
  const Eigen::MatrixXd factors = F->form_factors({0, size}, {0, size});
  const Eigen::MatrixXd exchange = areas().asDiagonal() * factors;
  EXPECT_LT((exchange - exchange.transpose()).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(NarrowTowardZero, NeverGrows) {
  for (double x = 1e-3; x < 10; x *= 1.0001) {
    EXPECT_LE(static_cast<double>(narrow_toward_zero(x)), x);
    EXPECT_GT(static_cast<double>(narrow_toward_zero(x)), x * (1 - 0x1p-23));
    EXPECT_EQ(narrow_toward_zero(-x), -narrow_toward_zero(x));
  }
}

}  // namespace
}  // namespace patchlight
