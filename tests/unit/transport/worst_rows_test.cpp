#include "transport/closure.h"

#include <gtest/gtest.h>

namespace patchlight::worst_rows_test {
namespace {

// Defects times area: 0.1, 0.3, 0.3, 0. A large defect of a small patch is last but one.
TEST(WorstRows, AreThoseWithTheLargestDefectTimesArea) {
  const Eigen::Vector4d row_sum(0.5, 1.25, 0.75, 0.5);
  const Eigen::Vector4d area(0.25, 1.5, 1.5, 8);
  const LostShare lost{Eigen::Vector4d(0, 0.05, 0, 0.25), Eigen::Vector4d(0.1, 0, 0.05, 0.25), Eigen::Vector4d::Zero(),
                       16};
  const std::vector<RowDefect> worst = worst_rows(row_sum, lost, area, 3);
  ASSERT_EQ(worst.size(), 3U);
  EXPECT_EQ(worst[0].patch, 1U);
  EXPECT_EQ(worst[1].patch, 2U);
  EXPECT_EQ(worst[2].patch, 0U);
  EXPECT_EQ(worst[0].row_sum, 1.25);
  EXPECT_DOUBLE_EQ(worst[0].expected, 0.95);
  EXPECT_DOUBLE_EQ(worst[2].expected, 0.9);
}

TEST(WorstRows, OfEqualsTheFirstAndNoMoreThanThereAre) {
  const Eigen::Vector3d row_sum(0.75, 1.25, 0.75);
  const LostShare lost{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), 16};
  const std::vector<RowDefect> worst = worst_rows(row_sum, lost, Eigen::Vector3d::Ones(), 5);
  ASSERT_EQ(worst.size(), 3U);
  for (PatchIndex i = 0; i < 3; ++i) EXPECT_EQ(worst[i].patch, i);
  EXPECT_TRUE(worst_rows({}, {}, {}, 5).empty());
}

}  // namespace
}  // namespace patchlight::worst_rows_test
