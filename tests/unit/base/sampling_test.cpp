#include "base/sampling.h"

#include <boost/random/sobol.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <set>

namespace patchlight::sampling_test {
namespace {

TEST(ScrambledSobol, EveryPowerOfTwoPrefixIsStratified) {
  // A (0, m, 1) net in every dimension: of 2^m points exactly one lies in each interval of width 2^-m.
  const auto points = scrambled_sobol(256, 7);
  for (std::size_t count = 1; count <= 256; count *= 2) {
    for (std::size_t d = 0; d < 4; ++d) {
      std::set<int> intervals;
      for (std::size_t k = 0; k < count; ++k)
        intervals.insert(static_cast<int>(points[k][d] * static_cast<double>(count)));
      EXPECT_EQ(intervals.size(), count) << "dimension " << d;
    }
  }
}

TEST(ScrambledSobol, FirstTwoDimensionsFormANet) {
  // A (0, 4, 2) net: 16 points, one in each cell of every 2^a x 2^b grid with a + b = 4.
  const auto points = scrambled_sobol(16, 3);
  for (int a = 0; a <= 4; ++a) {
    std::set<std::pair<int, int>> cells;
    for (const auto& point : points) cells.insert({std::ldexp(point[0], a), std::ldexp(point[1], 4 - a)});
    EXPECT_EQ(cells.size(), 16U);
  }
}

// Boost's engine omits the zero point.
TEST(ScrambledSobol, IsSobolsSequenceScrambled) {
  for (const std::uint32_t seed : {1U, 7U}) {
    const auto points = scrambled_sobol(1U << 16U, seed);
    boost::random::sobol_engine<std::uint32_t, 32> engine(4);
    std::size_t differing = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      for (std::uint32_t d = 0; d < 4; ++d) {
        const std::uint32_t coordinate = k == 0 ? 0 : engine();
        differing += points[k][d] != (owen_scramble(coordinate, hash({seed, d})) + 0.5) * 0x1p-32 ? 1 : 0;
      }
    }
    EXPECT_EQ(differing, 0U);
  }
}

TEST(ScrambledSobol, SeedsDiffer) { EXPECT_NE(scrambled_sobol(1, 1)[0], scrambled_sobol(1, 2)[0]); }

TEST(OwenScramble, IsAPermutationThatKeepsCommonPrefixes) {
  // Numbers that agree in their first k bits still agree in these after scrambling, and then differ.
  for (int k = 0; k < 32; ++k) {
    const std::uint32_t a = 0x12345678U;
    const std::uint32_t b = a ^ (0x80000000U >> k);
    const std::uint32_t difference = owen_scramble(a, 99) ^ owen_scramble(b, 99);
    EXPECT_EQ(__builtin_clz(difference), k);
  }
}

TEST(SquareToTriangle, MapsEqualAreasToEqualAreas) {
  // The triangle b1 + b2 <= h has the fraction h^2 of the area. 2^12 stratified points reproduce it to a few times
  // 2^-12.
  const auto points = scrambled_sobol(4096, 5);
  for (const double h : {0.25, 0.5, 0.75}) {
    int inside = 0;
    for (const auto& point : points) {
      const Eigen::Vector2d b = square_to_triangle(point[0], point[1]);
      EXPECT_GE(b.minCoeff(), 0);
      inside += b.sum() <= h;
    }
    EXPECT_NEAR(inside / 4096.0, h * h, 2 / 4096.0);
  }
}

TEST(SquareToQuad, HasTheAreaCentroidAsMean) {
  const std::array<Point, 4> kite{Point(0, 0, 0), Point(3, 0, 0), Point(2, 2, 0), Point(0, 1, 0)};
  Vector mean = Vector::Zero();
  const auto points = scrambled_sobol(1 << 14, 5);
  for (const auto& point : points)
    mean += square_to_quad(kite, point[0], point[1]) / static_cast<double>(points.size());
  // Scrambled Sobol points integrate a Lipschitz function to about size / points.
  EXPECT_LT((mean - area_centroid(kite)).norm(), 3.0 / (1 << 10));
}

// Single precision rounds coordinates just below 1 to 1, the far edge of the triangle and of the quadrilateral.
TEST(SquareToQuad, StaysInItAtTheEndOfTheSquare) {
  const std::array<Point, 4> triangle{Point(0, 0, 0), Point(2, 0, 0), Point(0, 1, 0), Point(0, 1, 0)};
  EXPECT_LT((square_to_quad(triangle, 1, 0.5) - Point(1, 0.5, 0)).norm(), 1e-15);
  const std::array<Point, 4> square{Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)};
  EXPECT_LT((square_to_quad(square, 1, 0.5) - Point(0.5, 1, 0)).norm(), 1e-15);
}

// Probabilities that are sums of powers of two, so that the bounds between them are exact.
TEST(Chooser, SharesOutTheUnitIntervalInOrder) {
  const std::vector<double> probabilities{0, 0.25, 0, 0.5, 0.25, 0};
  const Chooser chooser(probabilities);
  const auto expect = [&](double u, std::size_t index, double rest) {
    EXPECT_EQ(chooser.at(u).index, index) << u;
    EXPECT_EQ(chooser.at(u).rest, rest) << u;
  };
  expect(0, 1, 0);
  expect(0.125, 1, 0.5);
  expect(0.25, 3, 0);
  expect(0.5, 3, 0.5);
  expect(0.75, 4, 0);
  expect(1, 4, 1);  // single precision rounds numbers just below 1 to 1
}

TEST(Chooser, KnowsTheProbabilityOfEachIndex) {
  const std::vector<double> probabilities{0, 0.25, 0, 0.5, 0.25, 0};
  const Chooser chooser(probabilities);
  for (std::size_t k = 0; k < 8; ++k) EXPECT_EQ(chooser.probability_of(k), k < 6 ? probabilities[k] : 0) << k;
  EXPECT_EQ(chooser.alternatives().size(), 3U);
  EXPECT_EQ(chooser.alternatives_from(2).size(), 2U);
  EXPECT_TRUE(chooser.alternatives_from(5).empty());
  EXPECT_TRUE(Chooser().empty());
}

TEST(SquareToCosineHemisphere, HasItsDensity) {
  // P(cos theta > c) = 1 - c^2; and the density integrates to 1 over the hemisphere (midpoint rule in cos theta).
  const auto points = scrambled_sobol(4096, 11);
  int above = 0;
  for (const auto& point : points) {
    const Vector direction = square_to_cosine_hemisphere(point[0], point[1]);
    EXPECT_NEAR(direction.norm(), 1, 1e-12);
    above += direction.z() > 0.6;
  }
  EXPECT_NEAR(above / 4096.0, 0.64, 2 / 4096.0);
}

}  // namespace
}  // namespace patchlight::sampling_test
