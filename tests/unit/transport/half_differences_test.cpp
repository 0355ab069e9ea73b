#include "patchlight/transport/half_differences.h"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace patchlight::half_differences_test {
namespace {

// Half a step of a quarter of an octave, plus rounding.
const double resolution = std::exp2(1.0 / 8) - 1 + 1e-12;

TEST(HalfDifferences, KeepSignAndMagnitudeWithinTheirResolution) {
  const std::vector<double> area{4, 1e-6, 1};
  HalfDifferences differences(area);
  for (double size = 1; size > 1e-9; size *= 0.7) {
    for (const double sign : {-1.0, 1.0}) {
      const double expected = sign * 2 * size;
      differences.set(0, 2, expected);
      EXPECT_NEAR(differences.at(0, 2), expected, resolution * 2 * size);
      EXPECT_EQ(differences.at(2, 0), differences.at(0, 2));
    }
  }
  // Patches of different size: the largest exchange area is that of the smaller.
  differences.set(1, 0, 1e-6);
  EXPECT_NEAR(differences.at(1, 0), 1e-6, resolution * 1e-6);
}

TEST(HalfDifferences, AreZeroWhereNothingDiffers) {
  HalfDifferences differences(std::vector<double>{4, 1, 1});
  differences.set(0, 1, 0.5);
  for (const double none : {0.0, 1e-10, -1e-10}) {
    differences.set(0, 1, none);
    EXPECT_EQ(differences.at(0, 1), 0);
  }
  EXPECT_EQ(differences.at(1, 2), 0);
  EXPECT_EQ(differences.at(1, 1), 0);
  EXPECT_EQ(HalfDifferences().size(), 0U);
}

TEST(HalfDifferences, LargerThanBothPatchesCountAsThese) {
  HalfDifferences differences(std::vector<double>{4, 1});
  differences.set(0, 1, -100);
  EXPECT_DOUBLE_EQ(differences.at(0, 1), -2);
}

TEST(HalfDifferences, AreRestoredFromTheirCodes) {
  const std::vector<double> area{4, 1, 2};
  HalfDifferences differences(area);
  differences.set(0, 1, 0.3);
  differences.set(2, 1, -1e-5);
  const HalfDifferences restored(area, differences.codes());
  for (PatchIndex i = 0; i < 3; ++i)
    for (PatchIndex j = 0; j < 3; ++j) EXPECT_EQ(restored.at(i, j), differences.at(i, j));
}

}  // namespace
}  // namespace patchlight::half_differences_test
