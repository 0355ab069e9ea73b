#include "patchlight/transport/exchange_areas.h"

#include "transport/tiles.h"

#include <cmath>
#include <gtest/gtest.h>

namespace patchlight::exchange_areas_test {
namespace {

double entry(PatchIndex i, PatchIndex j) { return i == j ? 0 : std::abs(std::sin(static_cast<double>(i * j + i + j))); }

// 150 patches: two whole blocks and a part of one.
constexpr PatchIndex size = 150;

ExchangeAreas filled() {
  ExchangeAreas S(size);
  for (PatchIndex i = 0; i < size; ++i) {
    for (PatchIndex j = i; j < size; ++j) S.set(i, j, static_cast<float>(entry(i, j)));
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

// Every pair with an entry is in one part, once.
TEST(ExchangeAreas, AreGoneThroughEntryByEntry) {
  const ExchangeAreas S = filled();
  Eigen::MatrixXd found = Eigen::MatrixXd::Zero(size, size);
  for (PatchIndex part = 0; part < entry_parts(S); ++part) {
    for_entries(S, part, [&](PatchIndex i, PatchIndex j, double value) {
      EXPECT_LT(i, j);
      EXPECT_EQ(found(i, j), 0);
      found(i, j) = value;
    });
  }
  const Eigen::MatrixXd both = found + found.transpose();
  EXPECT_EQ(both, full_matrix());
}

TEST(ExchangeAreas, AreChangedEntryByEntry) {
  const ExchangeAreas before = filled();
  const ExchangeAreas S = changed(before, [](PatchIndex i, PatchIndex j, double value) { return value * (i + j); });
  for (PatchIndex i = 0; i < size; ++i) {
    for (PatchIndex j = 0; j < size; ++j)
      EXPECT_EQ(S.at(i, j), narrow_toward_zero(static_cast<double>(before.at(i, j)) * (i + j)));
  }
}

TEST(NarrowTowardZero, NeverGrows) {
  for (double x = 1e-3; x < 10; x *= 1.0001) {
    EXPECT_LE(static_cast<double>(narrow_toward_zero(x)), x);
    EXPECT_GT(static_cast<double>(narrow_toward_zero(x)), x * (1 - 0x1p-23));
    EXPECT_EQ(narrow_toward_zero(-x), -narrow_toward_zero(x));
  }
}

}  // namespace
}  // namespace patchlight::exchange_areas_test
