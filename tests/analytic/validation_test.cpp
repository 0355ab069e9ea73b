// The table of `patchlight validate`.
#include "validate/validate.h"

#include <cmath>
#include <gtest/gtest.h>

namespace patchlight::validation_test {
namespace {

TEST(Validation, EveryCaseLiesWithinItsBar) {
  for (const ValidationResult& result : validate(validation_cases())) {
    EXPECT_TRUE(within_bar(result)) << result.name << ": " << result.measured.value << " instead of " << result.exact
                                    << " +- " << result.measured.error_bar;
    // A bar that allows for everything would say nothing: an error of two in a hundred must show.
    EXPECT_LT(result.measured.error_bar, 0.02 * std::abs(result.exact)) << result.name;
  }
}

}  // namespace
}  // namespace patchlight::validation_test
