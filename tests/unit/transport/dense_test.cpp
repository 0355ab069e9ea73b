#include "base/parallel.h"
#include "transport/closure.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <utility>

namespace patchlight::dense_test {
namespace {

double entry(PatchIndex i, PatchIndex j) { return i == j ? 0 : std::abs(std::sin(static_cast<double>(i * j + i + j))); }

// Symmetric exchange areas in [0, 1], and remainders large enough to notice.
ExchangeAreas filled(PatchIndex size) {
  ExchangeAreas S(size);
  for (PatchIndex i = 0; i < size; ++i) {
    for (PatchIndex j = i; j < size; ++j) S.set(i, j, static_cast<float>(entry(i, j)));
  }
  return S;
}

Eigen::VectorXd remainders(PatchIndex size) { return Eigen::VectorXd::LinSpaced(size, 0.5, 0.1); }

// Areas for which every row of F sums to 1, so that values in [0, 1] stay there.
Eigen::VectorXd areas(PatchIndex size) { return row_sums(filled(size)) + remainders(size); }

std::unique_ptr<RowTransport> transport(PatchIndex size) {
  return dense_transport({filled(size), remainders(size), "test"}, areas(size));
}

// F with the remainders, entry by entry.
Eigen::MatrixXd full_matrix(PatchIndex size) {
  Eigen::MatrixXd S = remainders(size).asDiagonal();
  for (PatchIndex i = 0; i < size; ++i) {
    for (PatchIndex j = 0; j < size; ++j) S(i, j) += static_cast<double>(static_cast<float>(entry(i, j)));
  }
  return areas(size).cwiseInverse().asDiagonal() * S;
}

// Values in [0, 1] that differ from patch to patch and from band to band.
Field radiosity(PatchIndex size, int bands) {
  Field B(size, bands);
  for (PatchIndex i = 0; i < size; ++i) {
    for (int band = 0; band < bands; ++band) B(i, band) = std::abs(std::cos(0.7 * i + 1.3 * band));
  }
  return B;
}

double difference(const Field& a, const Field& b) { return (a - b).abs().maxCoeff(); }

bool same_bits(const Field& a, const Field& b) { return a.rows() == b.rows() && (a == b).all(); }

// F B in two orders of summation: each sum has about `size` roundings. Its terms are positive and add up to at most 1.
double rounding(PatchIndex size) { return 2 * (size + 10) * std::numeric_limits<double>::epsilon(); }

// Blocks have 64 patches: less than one, one, slightly more, and a partial last one. 700 fill more blocks than there
// are stripes.
constexpr PatchIndex sizes[] = {1, 5, 64, 65, 150, 700};

TEST(DenseTransport, AppliesTheFullMatrixToAnyNumberOfBands) {
  for (const PatchIndex size : sizes) {
    const auto F = transport(size);
    const Eigen::MatrixXd matrix = full_matrix(size);
    for (int bands = 1; bands <= 7; ++bands) {
      const Field B = radiosity(size, bands);
      const Field expected = (matrix * B.matrix()).array();
      EXPECT_LT(difference(F->apply(B), expected), rounding(size)) << size << ' ' << bands;
    }
  }
}

TEST(DenseTransport, ItsFourViewsAgree) {
  constexpr PatchIndex size = 150;
  const auto F = transport(size);
  const Field B = radiosity(size, 3);
  const Field whole = F->apply(B);
  const PatchRange range{60, 135};
  EXPECT_LT(difference(F->gather(range, B), whole.middleRows(60, 75)), rounding(size));

  Field only = Field::Zero(size, 3);
  only.middleRows(60, 75) = B.middleRows(60, 75);
  EXPECT_LT(difference(F->shoot(range, B.middleRows(60, 75)), F->apply(only)), rounding(size));

  const Eigen::MatrixXd block = F->form_factors(range, {0, size});
  // The exported form factors omit the remainder: F_ii of a flat patch is 0.
  const Field own = (B.colwise() * (remainders(size).array() / areas(size).array())).middleRows(60, 75);
  const Field seen = (block * B.matrix()).array() + own;
  EXPECT_LT(difference(seen, whole.middleRows(60, 75)), rounding(size));
}

TEST(DenseTransport, KeepsReciprocity) {
  constexpr PatchIndex size = 150;
  const Eigen::MatrixXd factors = transport(size)->form_factors({0, size}, {0, size});
  const Eigen::MatrixXd exchange = areas(size).asDiagonal() * factors;
  EXPECT_LT((exchange - exchange.transpose()).cwiseAbs().maxCoeff(), 1e-15);
}

// A relaxation that uses all of its arguments. B stays in [0, 1]: own form factors sum to at most 1, and no block
// starts above 700.
Relax mixed(double from_others) {
  return [from_others](const SweptPatches& patches) -> Field {
    const Field own = (patches.own_form_factors * patches.radiosity.matrix()).array();
    return from_others * patches.irradiance + 0.2 * own + 0.1 * patches.radiosity +
           1e-4 * static_cast<double>(patches.range.begin);
  };
}

// Differences from rounding are passed on with a factor of at most 0.9: together ten times as large.
double carried_rounding(PatchIndex size) { return 10 * rounding(size); }

// Law: for each block, one pass over the matrix equals gathering and relaxing.
TEST(DenseSweep, IsTheSweepThatGathers) {
  const Relax there = mixed(0.6);
  const Relax back = mixed(0.5);
  for (const PatchIndex size : sizes) {
    const auto F = transport(size);
    for (const int bands : {1, 3, 5}) {
      const Sweep start{radiosity(size, bands), {}, {}};
      for (const Relax& second : {Relax(), back}) {
        const Field expected = F->RowTransport::sweep(start, there, second).radiosity;
        const Field swept = F->sweep(start, there, second).radiosity;
        EXPECT_LT(difference(swept, expected), carried_rounding(size)) << size << ' ' << bands;
      }
    }
  }
}

// The newest radiosities are used. Without them a second block would differ far beyond rounding.
TEST(DenseSweep, TakesTheNewestRadiosities) {
  constexpr PatchIndex size = 150;
  const auto F = transport(size);
  const Field B = radiosity(size, 2);
  const Relax gathering = [](const SweptPatches& patches) -> Field { return 0.8 * patches.irradiance; };
  const Field swept = F->sweep({B, {}, {}}, gathering, {}).radiosity;
  const Field at_once = 0.8 * F->apply(B);
  EXPECT_LT(difference(swept.topRows(64), at_once.topRows(64)), rounding(size));
  EXPECT_GT(difference(swept.middleRows(64, 64), at_once.middleRows(64, 64)), 1e-3);
}

TEST(DenseSweep, FindsTheIrradianceOfWhatItStartsFrom) {
  for (const PatchIndex size : sizes) {
    const auto F = transport(size);
    for (const int bands : {1, 3, 5}) {
      const Relax relax = mixed(0.6);
      const Sweep first = F->sweep({radiosity(size, bands), {}, {}}, relax, {});
      // The first sweep has no irradiance of its start.
      EXPECT_EQ(first.irradiance.size(), 0);
      const Sweep second = F->sweep(first, relax, {});
      ASSERT_EQ(second.irradiance.rows(), size);
      EXPECT_LT(difference(second.irradiance, F->apply(first.radiosity)), rounding(size)) << size << ' ' << bands;
      // It is not that of the later radiosities, and not a rest of the previous sweep.
      EXPECT_GT(difference(second.irradiance, F->apply(second.radiosity)), 1e-6);
      const Sweep third = F->sweep(second, relax, {});
      EXPECT_LT(difference(third.irradiance, F->apply(second.radiosity)), rounding(size));
    }
  }
}

TEST(DenseTransport, HasTheSameBitsForAnyNumberOfThreads) {
  constexpr PatchIndex size = 700;
  const auto F = transport(size);
  const Field B = radiosity(size, 3);
  const auto results = [&](int threads) {
    const ThreadLimit limit(threads);
    const Sweep first = F->sweep({B, {}, {}}, mixed(0.6), {});
    const Sweep second = F->sweep(first, mixed(0.6), {});
    const Field there_and_back = F->sweep({B, {}, {}}, mixed(0.6), mixed(0.5)).radiosity;
    Field all(5 * size, 3);
    all << F->apply(B), first.radiosity, second.radiosity, second.irradiance, there_and_back;
    return all;
  };
  const Field one = results(1);
  EXPECT_TRUE(same_bits(results(2), one));
  EXPECT_TRUE(same_bits(results(2), one));
  EXPECT_TRUE(same_bits(results(3), one));
}

}  // namespace
}  // namespace patchlight::dense_test
