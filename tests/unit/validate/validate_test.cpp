#include "validate/validate.h"

#include "patchlight/base/error.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
#include <set>

namespace patchlight::validate_test {
namespace {

ValidationCase one_case(double exact, const Measured& measured) {
  return {"a case", exact, "a law", [measured](const Observer&) { return measured; }};
}

bool verdict(double exact, const Measured& measured) {
  const std::vector<ValidationCase> cases{one_case(exact, measured)};
  return within_bar(validate(cases).front());
}

TEST(Validation, TheVerdictIsTheBar) {
  EXPECT_TRUE(verdict(0.5, {0.5, 0, "nothing"}));
  EXPECT_TRUE(verdict(0.5, {0.5078125, 0.0078125, "half of it"}));
  EXPECT_FALSE(verdict(0.5, {0.5078125, 0.0078124, "a little less"}));
  EXPECT_FALSE(verdict(0.5, {0.49, 0.009, "below"}));
}

TEST(Validation, WhatIsNotANumberIsNotWithinItsBar) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(verdict(0.5, {nan, 1, "nan"}));
  EXPECT_FALSE(verdict(0.5, {0.5, nan, "nan"}));
}

// A case of the table passes. With a wrong exact value it fails: a hundredth more is flagged.
TEST(Validation, AWrongExactValueIsFlagged) {
  std::vector<ValidationCase> cases = validation_cases();
  cases.resize(1);
  EXPECT_TRUE(within_bar(validate(cases).front()));
  cases[0].exact *= 1.01;
  EXPECT_FALSE(within_bar(validate(cases).front()));
}

TEST(Validation, EveryCaseHasItsOwnNameAndASource) {
  std::set<std::string> names;
  for (const ValidationCase& one : validation_cases()) {
    EXPECT_TRUE(names.insert(one.name).second) << one.name << " is there twice";
    EXPECT_FALSE(one.source.empty()) << one.name;
  }
  EXPECT_GE(names.size(), 30U);
}

TEST(Validation, CanBeStopped) {
  const std::vector<ValidationCase> cases{one_case(1, {1, 0, ""})};
  EXPECT_THROW(validate(cases, [](const Progress&) { return false; }), Canceled);
}

}  // namespace
}  // namespace patchlight::validate_test
