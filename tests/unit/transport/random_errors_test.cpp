#include "transport/random_errors.h"

#include "base/parallel.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

namespace patchlight::random_errors_test {
namespace {

// 24 patches of 1/4 m^2 with invented differences.
HalfDifferences invented() {
  HalfDifferences differences(std::vector<double>(24, 0.25));
  for (PatchIndex i = 0; i < 24; ++i) {
    for (PatchIndex j = i + 1; j < 24; ++j) {
      const double size = 0.01 + 0.001 * ((i + j) % 7);
      differences.set(i, j, (i + j) % 3 == 0 ? -size : size);
    }
  }
  return differences;
}

Field values(double phase) {
  Field x(24, 1);
  for (PatchIndex i = 0; i < 24; ++i) x(i, 0) = 1 + std::sin(i + phase);
  return x;
}

// Sums of 24 terms of at most 0.04 in double.
constexpr double rounding = 24 * 0.04 * std::numeric_limits<double>::epsilon();

TEST(RandomErrors, AreZeroWithoutDifferences) {
  const HalfDifferences none(std::vector<double>(24, 0.25));
  EXPECT_TRUE((random_errors(none, values(0), 32, 1) == 0).all());
}

TEST(RandomErrors, AreLinearAndSymmetric) {
  Field x(24, 3);
  x << values(0), values(1), 2 * values(0) - values(1);
  const Field D = random_errors(invented(), x, 8, 1);
  ASSERT_EQ(D.cols(), 24);
  for (Eigen::Index draw = 0; draw < 8; ++draw) {
    const auto of = [&](Eigen::Index column) { return D.col(3 * draw + column); };
    EXPECT_LT((of(2) - (2 * of(0) - of(1))).abs().maxCoeff(), 4 * rounding);
    // y^T D x = x^T D y; sums of 24 products with values up to 2.
    EXPECT_NEAR((x.col(1) * of(0)).sum(), (x.col(0) * of(1)).sum(), 24 * 2 * rounding);
  }
}

// E (D x)_i^2 = sum_j D_ij^2 x_j^2. The fourth moment of a sum with random signs is at most three times the square
// of its second. So the mean over N draws has a relative standard error of at most sqrt(2 / N).
TEST(RandomErrors, HaveTheVarianceOfTheEntries) {
  const HalfDifferences differences = invented();
  const Field x = values(0);
  constexpr int draws = 32;
  constexpr int seeds = 100;
  Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(24);
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    squares += random_errors(differences, x, draws, seed).square().rowwise().sum();
  }
  squares /= draws * seeds;
  for (PatchIndex i = 0; i < 24; ++i) {
    double expected = 0;
    for (PatchIndex j = 0; j < 24; ++j) expected += std::pow(differences.at(i, j) * x(j, 0), 2);
    EXPECT_NEAR(squares[i] / expected, 1, 5 * std::sqrt(2.0 / (draws * seeds))) << i;
  }
}

TEST(ByVariances, IsTheProductWithTheSquares) {
  const HalfDifferences differences = invented();
  Field x(24, 2);
  x << values(0), values(1);
  Eigen::MatrixXd variances(24, 24);
  for (PatchIndex i = 0; i < 24; ++i) {
    for (PatchIndex j = 0; j < 24; ++j) variances(i, j) = std::pow(differences.at(i, j), 2);
  }
  const Field expected = (variances * x.matrix()).array();
  EXPECT_GT(expected.minCoeff(), 0);
  EXPECT_LT((by_variances(differences, x) / expected - 1).abs().maxCoeff(), 24 * 1e-16 * 4);
}

TEST(RandomErrors, SameBitsWithAnyNumberOfThreads) {
  const auto drawn = [&](int threads) {
    const ThreadLimit limit(threads);
    return random_errors(invented(), values(0), 8, 3);
  };
  EXPECT_TRUE((drawn(1) == drawn(2)).all());
}

}  // namespace
}  // namespace patchlight::random_errors_test
