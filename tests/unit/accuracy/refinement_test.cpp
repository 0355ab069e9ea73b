#include "accuracy/refinement.h"

#include "support/direct_solution.h"
#include "support/made_up_room.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

namespace patchlight::refinement_test {
namespace {

const Eigen::VectorXd effects = (Eigen::VectorXd(9) << 3, 0.5, 8, 1, 0, 2.5, 0.2, 4, 1).finished();

// Remaining fraction of an effect after its parent is cut: the size of the patches halves.
const double left_by_a_cut = std::pow(0.5, 2 * mesh_order);

double left_after(const std::vector<std::uint8_t>& marks) {
  double left = 0;
  for (Eigen::Index g = 0; g < effects.size(); ++g)
    left += (marks[static_cast<std::size_t>(g)] != 0 ? left_by_a_cut : 1) * effects[g];
  return left;
}

// The smallest number of parents, found by trying all sets.
int least_cuts(double wanted) {
  int least = std::numeric_limits<int>::max();
  for (unsigned set = 0; set < 1U << effects.size(); ++set) {
    std::vector<std::uint8_t> marks;
    for (Eigen::Index g = 0; g < effects.size(); ++g) marks.push_back(set >> g & 1U);
    if (left_after(marks) <= wanted) least = std::min(least, std::popcount(set));
  }
  return least;
}

TEST(ParentsToCut, AreTheFewestThatDo) {
  const double all = effects.sum();
  for (const double factor : {1.01, 1.1, 1.2, 1.5, 1.8}) {
    const std::vector<std::uint8_t> marks = parents_to_cut(effects, {.factor = factor});
    const double wanted = all / (factor * factor);
    EXPECT_LE(left_after(marks), wanted);
    EXPECT_EQ(std::count(marks.begin(), marks.end(), 1), least_cuts(wanted)) << factor;
  }
}

TEST(ParentsToCut, AreNoneWhenNothingHasToFall) {
  for (const double factor : {1.0, 0.5}) {
    const std::vector<std::uint8_t> marks = parents_to_cut(effects, {.factor = factor});
    EXPECT_EQ(std::count(marks.begin(), marks.end(), 0), effects.size());
  }
}

// A cut of all parents reduces the error by 2^mesh_order at most. Beyond that, the fewest with nine tenths of the
// effect are cut.
TEST(ParentsToCut, HaveNineTenthsWhereCuttingAllWouldNotDo) {
  const std::vector<std::uint8_t> marks = parents_to_cut(effects, {.factor = 100});
  const double all = effects.sum();
  const double wanted = all - 0.9 * all * (1 - left_by_a_cut);
  EXPECT_LE(left_after(marks), wanted * (1 + 1e-15));
  EXPECT_EQ(std::count(marks.begin(), marks.end(), 1), least_cuts(wanted));
  EXPECT_EQ(marks[4], 0);
}

TEST(ParentsToCut, AreTheMostEffectiveOnesWhenThereIsALimit) {
  EXPECT_EQ(parents_to_cut(effects, {.factor = 100, .most = 3}),
            (std::vector<std::uint8_t>{1, 0, 1, 0, 0, 0, 0, 1, 0}));
  EXPECT_EQ(parents_to_cut(effects, {.factor = 100, .most = 0}), std::vector<std::uint8_t>(9, 0));
}

// The first parent alone reduces the error enough. A parent without an effect is not cut to reach the number.
TEST(ParentsToCut, AreAtLeastSoMany) {
  EXPECT_EQ(parents_to_cut(effects, {.factor = 1.01, .least = 3}),
            (std::vector<std::uint8_t>{1, 0, 1, 0, 0, 0, 0, 1, 0}));
  EXPECT_EQ(parents_to_cut(effects, {.factor = 1.01, .least = 9}),
            (std::vector<std::uint8_t>{1, 1, 1, 1, 0, 1, 1, 1, 1}));
}

// A cut leaves more of noise than of a mesh error, so noise takes more cuts.
TEST(ParentsToCut, DependOnWhatACutLeaves) {
  // Four fifths of the largest effect slightly exceed the required reduction.
  const double factor = 0.999 * std::sqrt(1 / (1 - 0.8 * 8 / effects.sum()));
  EXPECT_EQ(parents_to_cut(effects, {.factor = factor, .left = 0.2}),
            (std::vector<std::uint8_t>{0, 0, 1, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(parents_to_cut(effects, {.factor = factor, .left = 0.25}),
            (std::vector<std::uint8_t>{0, 0, 1, 0, 0, 0, 0, 1, 0}));
}

// <interest, B>_A = <psi, E>_A holds for the solution of B = E + R F B and of the adjoint equation. psi is solved to 5
// %: ||d(R psi)||_A <= 0.05 ||R (psi - interest)||_A. The error of psi is F times that, of no larger norm. The patches
// of interest reflect a third as much as the others, so psi = interest + R F psi would fail.
TEST(Importance, IsReciprocal) {
  constexpr PatchIndex size = 60;
  test::Room room = test::made_up(size, 0.9);
  RadiosityProblem& problem = room.problem;
  problem.scattering.reflectance = Field::Constant(size, 1, 0.9);
  problem.exitance = Field(size, 1);
  Eigen::VectorXd interest(size);
  for (PatchIndex i = 0; i < size; ++i) {
    problem.exitance(i, 0) = 1 + std::sin(3.0 * i);
    interest[i] = i % 3 == 0 ? 1 : 0;
    if (i % 3 == 0) problem.scattering.reflectance(i, 0) = 0.3;
    if (i % 3 == 1) problem.scattering.reflectance(i, 0) = 0.1;
  }
  const Eigen::VectorXd psi = importance(*room.transport, problem, interest);
  const Eigen::ArrayXd A = problem.area.array();
  const Eigen::ArrayXd B = test::direct_solution(*room.transport, problem).col(0);
  const Eigen::ArrayXd E = problem.exitance.col(0);
  const double seen = (A * interest.array() * B).sum();
  const double by_importance = (A * psi.array() * E).sum();
  const double off =
      0.06 * area_norm(problem.scattering.reflectance.colwise() * (psi - interest).array(), problem.area)[0];
  const double tolerance = off * area_norm(problem.exitance, problem.area)[0];
  EXPECT_NEAR(by_importance, seen, tolerance);
  // The reflected part is many times the tolerance.
  EXPECT_GT(seen - (A * interest.array() * E).sum(), 5 * tolerance);
}

TEST(Importance, IsInterestWhereNothingReflects) {
  test::Room room = test::made_up(20, 0);
  Eigen::VectorXd interest = Eigen::VectorXd::Zero(20);
  interest[3] = 1;
  interest[7] = 1;
  // Patches see the patches of interest directly: psi = interest + F R psi, and R = 0.
  EXPECT_EQ(importance(*room.transport, room.problem, interest), interest);
}

}  // namespace
}  // namespace patchlight::refinement_test
