#include "patchlight/solve/problem.h"

#include <cmath>
#include <gtest/gtest.h>

namespace patchlight::relative_error_test {
namespace {

// Two patches of 1 and 4 m^2, two bands; the first patch emits 10 W/m^2 in the first band.
struct RelativeError : testing::Test {
  RadiosityProblem problem{{Field::Constant(2, 2, 0.5)}, Field::Zero(2, 2), Eigen::Vector2d(1, 4)};
  Field reference = Field::Zero(2, 2);
  RelativeError() {
    problem.exitance(0, 0) = 10;
    reference << 13, 0, 2, 0;  // reflected: sqrt(1 x 3^2 + 4 x 2^2) = 5 in the first band, nothing in the second
  }
};

TEST_F(RelativeError, IsRelativeToWhatIsReflected) {
  Field B = reference;
  EXPECT_EQ(relative_error(reference, B, problem), 0);
  B(1, 0) += 1;  // sqrt(4 x 1^2) = 2
  EXPECT_DOUBLE_EQ(relative_error(reference, B, problem), 0.4);
  EXPECT_DOUBLE_EQ(relative_error(reference, problem.exitance, problem), 1);
}

TEST_F(RelativeError, IsThatOfTheWorstBand) {
  problem.exitance.col(1).setConstant(1);
  reference.col(1).setConstant(2);  // reflected: sqrt(1 + 4)
  Field B = reference;
  B(0, 0) += 1;  // 1 of 5
  B(0, 1) += 2;  // 2 of sqrt(5)
  EXPECT_DOUBLE_EQ(relative_error(reference, B, problem), 2 / std::sqrt(5.0));
}

TEST_F(RelativeError, OfWhatIsNotThere) {
  Field B = reference;
  B(0, 1) = 1e-3;
  EXPECT_TRUE(std::isinf(relative_error(reference, B, problem)));
  B(0, 0) = std::nan("");
  EXPECT_TRUE(std::isnan(relative_error(reference, B, problem)));
}

}  // namespace
}  // namespace patchlight::relative_error_test
