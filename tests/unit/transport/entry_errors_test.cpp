#include "patchlight/transport/sampling_error.h"

#include <cmath>
#include <gtest/gtest.h>

namespace patchlight::entry_errors_test {
namespace {

// Half a step of a sixth of an octave, plus rounding.
const double resolution = std::exp2(1.0 / 12) - 1 + 1e-12;

TEST(EntryErrors, KeepEveryMagnitudeWithinTheirResolution) {
  const std::vector<double> area{4, 1e-6, 1};
  EntryErrors errors(area);
  for (double error = 4; error > 1e-12; error *= 0.7) {
    errors.set(0, 2, EntryKind::estimated, 0.5 * error);
    EXPECT_NEAR(errors.standard_error(0, 2), 0.5 * error, resolution * 0.5 * error);
    EXPECT_EQ(errors.standard_error(2, 0), errors.standard_error(0, 2));
  }
  // Patches of different size: the largest exchange area is that of the smaller.
  errors.set(1, 0, EntryKind::estimated, 1e-6);
  EXPECT_NEAR(errors.standard_error(1, 0), 1e-6, resolution * 1e-6);
}

TEST(EntryErrors, ThatAreTooSmallAreKeptAsTheSmallest) {
  EntryErrors errors(std::vector<double>{4, 1});
  for (const double error : {1e-14, 0.0, -1.0}) {
    errors.set(0, 1, EntryKind::estimated, error);
    EXPECT_NEAR(errors.standard_error(0, 1), 2 * std::exp2(-42), 1e-18);
    EXPECT_EQ(errors.kind(0, 1), EntryKind::estimated);
  }
}

TEST(EntryErrors, AreZeroWhereNothingIsEstimated) {
  EntryErrors errors(std::vector<double>(3, 1.0));
  EXPECT_EQ(errors.kind(0, 1), EntryKind::exact);
  EXPECT_EQ(errors.kind(1, 1), EntryKind::exact);
  errors.set(0, 1, EntryKind::all_visible);
  errors.set(2, 1, EntryKind::all_hidden);
  EXPECT_EQ(errors.kind(1, 0), EntryKind::all_visible);
  EXPECT_EQ(errors.kind(1, 2), EntryKind::all_hidden);
  EXPECT_EQ(errors.kind(0, 2), EntryKind::exact);
  for (PatchIndex i = 0; i < 3; ++i) {
    for (PatchIndex j = 0; j < 3; ++j) EXPECT_EQ(errors.standard_error(i, j), 0);
  }
  EXPECT_EQ(EntryErrors().size(), 0U);
}

// U times the error at the visible fraction S / U, with the maximum number of samples at the form factor U / A = 1/4,
// rounded twice.
TEST(EntryErrors, FollowFromTheUnoccludedValueAndTheAudit) {
  ExchangeAreas S(3);
  S.set(0, 1, 0.05F);
  S.set(1, 2, 0.4F);
  EntryErrors unoccluded(std::vector<double>(3, 2.0));
  unoccluded.set(0, 1, EntryKind::estimated, 0.5);
  unoccluded.set(1, 2, EntryKind::estimated, 0.5);
  unoccluded.set(0, 2, EntryKind::all_visible);
  SamplingError error;
  for (std::size_t bin = 0; bin < SamplingError::bins; ++bin)
    error.partial[sampling_efforts - 1][bin] = {100, static_cast<double>(bin + 1), 100};
  const EntryErrors errors = with_sampling_error(unoccluded, S, error, std::vector<double>(3, 2.0));
  const double twice = (1 + resolution) * (1 + resolution) - 1;
  EXPECT_NEAR(errors.standard_error(0, 1), 0.5 * 0.1, twice * 0.5 * 0.1);
  EXPECT_NEAR(errors.standard_error(1, 2), 0.5 * std::sqrt(0.07), twice * 0.5 * std::sqrt(0.07));
  EXPECT_EQ(errors.kind(0, 2), EntryKind::all_visible);
}

}  // namespace
}  // namespace patchlight::entry_errors_test
