#include "solve/bounds.h"

#include <cmath>
#include <gtest/gtest.h>

namespace patchlight::bounds_test {
namespace {

// Two patches that see only each other, with form factors that are not declared reciprocal. Counts its applications.
class Pair : public TransportOperator {
 public:
  PatchIndex size() const override { return 2; }
  Field apply(const FieldView& radiosity) const override {
    ++applications;
    return radiosity.colwise().reverse();
  }
  bool is_reciprocal() const override { return false; }

  mutable int applications = 0;
};

RadiosityProblem reflecting(double reflectance) {
  return {{Field::Constant(2, 1, reflectance), {}, {}}, Field::Constant(2, 1, 1), Eigen::VectorXd::Ones(2)};
}

// The n-th bounce between them is rho^n. The weights v are found when it is below 3/4, after ln(3/4) / ln(rho)
// applications. The last bounce is the difference of g = v - K v from 1.
TEST(PatchWeights, AreFoundWhileTheBouncesFallInTime) {
  for (const double reflectance : {0.3, 0.9, 0.98}) {
    const Pair pair;
    const auto weights = patch_weights(pair, reflecting(reflectance));
    ASSERT_TRUE(weights) << "reflectance " << reflectance;
    EXPECT_EQ(pair.applications, std::ceil(std::log(0.75) / std::log(reflectance)));
    EXPECT_EQ(weights->applications, pair.applications);
    EXPECT_GT(weights->g.minCoeff(), 0);
    // g is v - K v for this v.
    EXPECT_LT((weights->v * (1 - reflectance) - weights->g).abs().maxCoeff(), 1e-12);
  }
}

// With 0.998 three quarters remain after 143 bounces, more than the limit. A few bounces show that, and bound the
// errors as well as all of them. Without losses there is no bound.
TEST(PatchWeights, AreGivenUpAsSoonAsTheyWillNotBeFound) {
  const Pair slow;
  const auto weights = patch_weights(slow, reflecting(0.998));
  EXPECT_LE(slow.applications, 6);
  ASSERT_TRUE(weights);
  EXPECT_LT((weights->v / weights->g - 1 / 0.002).abs().maxCoeff(), 1e-9 / 0.002);
  const Pair endless;
  EXPECT_FALSE(patch_weights(endless, reflecting(1)));
  EXPECT_LE(endless.applications, 6);
}

// Two lamps that keep all of their light. In the other cases one absorbs some of it, or nothing shines.
TEST(TrappedLight, IsThatOfLampsBetweenPatchesThatLoseNothing) {
  const Pair pair;
  EXPECT_FALSE(trapped_light(pair, reflecting(1)).empty());
  EXPECT_TRUE(trapped_light(pair, reflecting(0.99)).empty());
  RadiosityProblem one_absorbs = reflecting(1);
  one_absorbs.scattering.reflectance(1, 0) = 0.99;
  EXPECT_TRUE(trapped_light(pair, one_absorbs).empty());
  RadiosityProblem dark = reflecting(1);
  dark.exitance.setZero();
  EXPECT_TRUE(trapped_light(pair, dark).empty());
}

}  // namespace
}  // namespace patchlight::bounds_test
