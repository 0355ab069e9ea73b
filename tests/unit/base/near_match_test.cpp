#include "base/words.h"

#include <gtest/gtest.h>
#include <vector>

namespace patchlight::near_match_test {
namespace {

const std::vector<std::string> words = {"reflectance", "radiance", "unit", "up"};

TEST(NearMatch, FindsTheWordAtMostTwoLettersAway) {
  EXPECT_EQ(near_match("refletance", words), "reflectance");
  EXPECT_EQ(near_match("radience", words), "radiance");
  EXPECT_EQ(near_match("units", words), "unit");
  EXPECT_EQ(near_match("reflxxxance", words), "");
}

TEST(NearMatch, IsNoneWhereHalfOfTheWordWouldChange) {
  EXPECT_EQ(near_match("ax", words), "");
  EXPECT_EQ(near_match("ip", words), "");
  EXPECT_EQ(near_match("anything", {}), "");
}

TEST(Suggestion, IsASentenceOrNothing) {
  EXPECT_EQ(suggestion("units", words), "; did you mean 'unit'?");
  EXPECT_EQ(suggestion("zzz", words), "");
}

}  // namespace
}  // namespace patchlight::near_match_test
