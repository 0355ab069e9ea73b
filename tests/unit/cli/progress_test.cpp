#include "cli/progress.h"

#include <gtest/gtest.h>
#include <string>

namespace patchlight::progress_test {
namespace {

using namespace cli;

std::string told(ProgressShown shown, const std::initializer_list<double>& times) {
  testing::internal::CaptureStderr();
  {
    ProgressLine line(shown);
    for (const double time : times) line.show({.stage = Stage::form_factors, .fraction = time / 100}, time);
  }
  return testing::internal::GetCapturedStderr();
}

TEST(Progress, IsALogOfALineEveryTenSeconds) {
  EXPECT_EQ(told(ProgressShown::log, {0, 5, 9.9}), "");
  EXPECT_EQ(told(ProgressShown::log, {0, 5, 10, 15, 20, 25}),
            "patchlight: form factors 10 %, 1 min 30 s left\npatchlight: form factors 20 %, 1 min 20 s left\n");
}

TEST(Progress, IsNothingWhenNothingIsToBeShown) { EXPECT_EQ(told(ProgressShown::nothing, {0, 10, 20}), ""); }

TEST(Progress, IsALineThatIsErased) {
  const std::string text = told(ProgressShown::line, {0, 10});
  EXPECT_EQ(text.find("\rform factors 0 %"), 0);
  EXPECT_NE(text.find("\rform factors 10 %"), std::string::npos);
  EXPECT_EQ(text.back(), '\r');
}

}  // namespace
}  // namespace patchlight::progress_test
