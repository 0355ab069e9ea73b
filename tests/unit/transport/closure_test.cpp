#include "transport/closure.h"

#include <cmath>
#include <gtest/gtest.h>

namespace patchlight::closure_test {
namespace {

// An open scene whose raw entries have a large error for one patch: patch 0 of 0.5 m^2 has exchange areas that add up
// to 2 m^2. One of them is 1 m^2. The least change weights entries by their squares. It would take nearly all of the
// 1.5 m^2 from this entry, which would become negative. Entries without known errors have a standard error of 2 %.
// Patches 4 and 5 exceed their area by 3 %, which noise can cause: three standard errors are 6 %. Patches 6 and 8
// exceed it by 8 %.
TEST(CloseExchangeAreas, CutsRowSumsAtThreeStandardErrorsWhereTheLeastChangeIsNegative) {
  constexpr PatchIndex size = 102;
  ExchangeAreas raw(size);
  raw.set(0, 1, 1.0F);
  for (PatchIndex j = 2; j < size; ++j) raw.set(0, j, 0.01F);
  raw.set(2, 3, 0.3F);
  raw.set(4, 5, 1.03F);
  raw.set(6, 8, 1.08F);
  Eigen::VectorXd area = Eigen::VectorXd::Ones(size);
  area[0] = 0.5;
  area[1] = 10;
  const Eigen::VectorXd escaped = (1 - row_sums(raw).array() / area.array()).max(0.0).matrix();
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(size);

  const ClosedExchangeAreas closed = close_exchange_areas(raw, area, {escaped, zero, zero, 256});

  EXPECT_TRUE(closed.method.starts_with(cut_row_sums)) << closed.method;
  const ExchangeAreas& S = closed.exchange_areas;
  const double limit = 0.5 + 3 * 0.02 * std::sqrt(1 + 100 * 1e-4);
  EXPECT_NEAR(row_sums(S)[0], limit, 1e-6);
  EXPECT_NEAR(S.at(0, 1), limit / 2, 1e-6);  // every entry of the row by the same factor, and still symmetric
  EXPECT_NEAR(S.at(1, 0), limit / 2, 1e-6);
  EXPECT_NEAR(S.at(7, 0), 0.01 * limit / 2, 1e-8);
  EXPECT_EQ(S.at(2, 3), raw.at(2, 3));
  EXPECT_EQ(S.at(4, 5), raw.at(4, 5));
  EXPECT_NEAR(S.at(6, 8), 1.08 / 1.09 * (1 + 3 * 0.02 * std::hypot(1.08, 0.01)), 1e-6);  // and 0.01 of patch 0
  EXPECT_EQ(closed.remainder.cwiseAbs().maxCoeff(), 0);
}

TEST(KeepExchangeAreas, ChangesNothingAndSaysWhy) {
  ExchangeAreas raw(2);
  raw.set(0, 1, 0.3F);
  const ClosedExchangeAreas kept = keep_exchange_areas(raw, "not wanted");
  EXPECT_EQ(kept.exchange_areas.at(0, 1), 0.3F);
  EXPECT_EQ(kept.method, "none: not wanted");
}

}  // namespace
}  // namespace patchlight::closure_test
