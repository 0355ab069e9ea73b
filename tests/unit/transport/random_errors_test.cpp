#include "transport/random_errors.h"

#include "base/parallel.h"
#include "mesh/mesher.h"
#include "support/scenes.h"
#include "support/tiny_scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>

namespace patchlight::random_errors_test {
namespace {

// A cube of 24 patches with invented kinds of entries.
struct Entries {
  PatchMesh mesh;
  Eigen::VectorXd area;
  EntryErrors errors;
  SamplingError sampling;
};

Entries cube(EntryKind kind) {
  const Scene scene = test::cube_room(0.5, 0.5);
  Entries entries{tessellate(scene, tiny::front_sides(scene), 0.5), {}, {}, {}};
  entries.area = Eigen::Map<const Eigen::VectorXd>(entries.mesh.area.data(), entries.mesh.size());
  entries.errors = EntryErrors(entries.mesh.area);
  for (PatchIndex i = 0; i < entries.mesh.size(); ++i) {
    for (PatchIndex j = i + 1; j < entries.mesh.size(); ++j) {
      entries.errors.set(i, j, kind, 0.01 + 0.001 * ((i + j) % 7));
    }
  }
  for (std::size_t effort = 0; effort < sampling_efforts; ++effort) {
    const double falling = 1.0 / static_cast<double>(1 + effort);
    entries.sampling.visible.audited[effort] = {100, 0.03 * falling, 100};
    entries.sampling.occluded.audited[effort] = {100, 0.28 * falling, 100};
  }
  return entries;
}

ErrorsOfEntries view(const Entries& entries) { return {entries.mesh, entries.area, entries.errors, entries.sampling}; }

Field values(PatchIndex size, double phase) {
  Field x(size, 1);
  for (PatchIndex i = 0; i < size; ++i) x(i, 0) = 1 + std::sin(i + phase);
  return x;
}

// Sums of 24 terms of at most 0.04 in double.
constexpr double rounding = 24 * 0.04 * std::numeric_limits<double>::epsilon();

TEST(RandomErrors, AreZeroWhereNothingIsSampled) {
  const Entries entries = cube(EntryKind::exact);
  EXPECT_TRUE((random_errors(view(entries), values(24, 0), 32, 1) == 0).all());
}

TEST(RandomErrors, AreLinearAndSymmetric) {
  const Entries entries = cube(EntryKind::estimated);
  Field x(24, 3);
  x << values(24, 0), values(24, 1), 2 * values(24, 0) - values(24, 1);
  const Field D = random_errors(view(entries), x, 8, 1);
  ASSERT_EQ(D.cols(), 24);
  for (Eigen::Index draw = 0; draw < 8; ++draw) {
    const auto of = [&](Eigen::Index column) { return D.col(3 * draw + column); };
    EXPECT_LT((of(2) - (2 * of(0) - of(1))).abs().maxCoeff(), 4 * rounding);
    // y^T D x = x^T D y; sums of 24 products with values up to 2.
    EXPECT_NEAR((x.col(1) * of(0)).sum(), (x.col(0) * of(1)).sum(), 24 * 2 * rounding);
  }
}

// E (D x)_i^2 = sum_j sigma_ij^2 x_j^2. The fourth moment of a sum with random signs is at most three times the square
// of its second. So the mean over N draws has a relative standard error of at most sqrt(2 / N).
TEST(RandomErrors, HaveTheVarianceOfTheEntries) {
  const Entries entries = cube(EntryKind::estimated);
  const Field x = values(24, 0);
  constexpr int draws = 32;
  constexpr int seeds = 100;
  Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(24);
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    squares += random_errors(view(entries), x, draws, seed).square().rowwise().sum();
  }
  squares /= draws * seeds;
  for (PatchIndex i = 0; i < 24; ++i) {
    double expected = 0;
    for (PatchIndex j = 0; j < 24; ++j) {
      const double sigma = entries.errors.standard_error(i, j);
      expected += sigma * sigma * x(j, 0) * x(j, 0);
    }
    EXPECT_NEAR(squares[i] / expected, 1, 5 * std::sqrt(2.0 / (draws * seeds))) << i;
  }
}

TEST(ByVariances, IsTheProductWithTheSquares) {
  const Entries entries = cube(EntryKind::estimated);
  Field x(24, 2);
  x << values(24, 0), values(24, 1);
  Eigen::MatrixXd variances(24, 24);
  for (PatchIndex i = 0; i < 24; ++i) {
    for (PatchIndex j = 0; j < 24; ++j) variances(i, j) = std::pow(entries.errors.standard_error(i, j), 2);
  }
  const Field expected = (variances * x.matrix()).array();
  EXPECT_GT(expected.minCoeff(), 0);
  EXPECT_LT((by_variances(view(entries), x) / expected - 1).abs().maxCoeff(), 24 * 1e-16 * 4);
}

// Two patches of 1 m^2, 3 m apart: U = 1 / (9 pi), the value from centroid to centroid.
TEST(RandomErrors, OfRaysThatAgreedFollowFromTheAudit) {
  using namespace test;
  Scene scene = empty_scene({grey(0.5)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)});
  scene = with_quad(std::move(scene), {Point(0, 0, 3), Point(0, 1, 3), Point(1, 1, 3), Point(1, 0, 3)});
  const double U = 1 / (9 * std::numbers::pi);
  for (const EntryKind kind : {EntryKind::all_visible, EntryKind::all_hidden}) {
    Entries entries = cube(kind);
    entries.mesh = tessellate(scene, tiny::front_sides(scene), 1);
    entries.area = Eigen::Vector2d(1, 1);
    entries.errors = EntryErrors(std::vector<double>{1, 1});
    entries.errors.set(0, 1, kind);
    const SamplingError& sampling = entries.sampling;
    // A form factor of 0.035 gets the maximum number of samples.
    const auto& unanimous = kind == EntryKind::all_visible ? sampling.visible : sampling.occluded;
    const double share = standard_error(unanimous, most_effort);
    ASSERT_GT(share, 0);
    const Field D = random_errors(view(entries), Eigen::Array2d(2, 5), 32, 1);
    EXPECT_LT((D.row(0).abs() / (5 * share * U) - 1).abs().maxCoeff(), 1e-14);
    EXPECT_LT((D.row(1).abs() / (2 * share * U) - 1).abs().maxCoeff(), 1e-14);
    // Both signs occur.
    EXPECT_LT(D.minCoeff(), 0);
    EXPECT_GT(D.maxCoeff(), 0);
  }
}

TEST(RandomErrors, SameBitsWithAnyNumberOfThreads) {
  const Entries entries = cube(EntryKind::estimated);
  const auto drawn = [&](int threads) {
    const ThreadLimit limit(threads);
    return random_errors(view(entries), values(24, 0), 8, 3);
  };
  EXPECT_TRUE((drawn(1) == drawn(2)).all());
}

}  // namespace
}  // namespace patchlight::random_errors_test
