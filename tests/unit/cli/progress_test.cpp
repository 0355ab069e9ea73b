#include "cli/progress.h"

#include <cstdlib>
#include <gtest/gtest.h>
#include <regex>
#include <string>
#include <vector>

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
            "patchlight: form factors, 10 % of this stage\npatchlight: form factors, 20 % of this stage\n");
}

TEST(Progress, IsNothingWhenNothingIsToBeShown) { EXPECT_EQ(told(ProgressShown::nothing, {0, 10, 20}), ""); }

TEST(Progress, IsALineThatIsErased) {
  const std::string text = told(ProgressShown::line, {0, 10});
  EXPECT_EQ(text.find("\rform factors, 0 %"), 0);
  EXPECT_NE(text.find("\rform factors, 10 %"), std::string::npos);
  EXPECT_EQ(text.back(), '\r');
}

const std::vector<Stage> stages = {Stage::read, Stage::mesh, Stage::form_factors, Stage::error_bars, Stage::gather};

TEST(Progress, NamesTheMesh) {
  testing::internal::CaptureStderr();
  {
    ProgressLine line(ProgressShown::line);
    line.expect(stages);
    line.show({.stage = Stage::form_factors}, 0);
    line.next_mesh(std::exp2(2.0 / 3), 1);  // half of the work is done
    line.show({.stage = Stage::form_factors}, 1);
  }
  const std::string text = testing::internal::GetCapturedStderr();
  const std::size_t first = text.find("mesh 1: form factors, ");
  ASSERT_NE(first, text.npos);
  EXPECT_NE(text.find("mesh 2: form factors, ", first), text.npos);
}

// Stages come more than once in a mesh, and meshes more than once in a run.
TEST(Progress, TheShareOfTheRunNeverFalls) {
  RunShare run;
  run.expect(stages, 0.2);
  double last = 0;
  for (const double done : {0.4, 0.7, 1.0}) {
    for (const Stage stage : {Stage::mesh, Stage::form_factors, Stage::error_bars, Stage::form_factors}) {
      for (const double fraction : {0.0, 0.5, 1.0, 0.0, 1.0}) {
        const double share = run.after({.stage = stage, .fraction = fraction});
        EXPECT_GE(share, last);
        last = share;
      }
    }
    EXPECT_LT(last, done);
    run.next_mesh(done, done + 0.3);
  }
  EXPECT_EQ(run.mesh_of(Stage::form_factors), 4);
  EXPECT_GT(run.after({.stage = Stage::gather, .fraction = 0.1}), 0.85);
  EXPECT_EQ(run.mesh_of(Stage::direct_light), 0) << "that of sensors";
  EXPECT_LE(run.after({.stage = Stage::gather, .fraction = 1}), 1);
}

TEST(Progress, TheTargetGivesTheShareOfTheMeshes) {
  EXPECT_EQ(share_of_meshes(0.5, std::nullopt), 1);
  EXPECT_EQ(share_of_meshes(0.01, 0.02), 1);
  EXPECT_NEAR(share_of_meshes(0.08, 0.02), 0.125, 1e-12);
}

// The seconds of all "N s left" and "N min M s left" of a text.
std::vector<int> seconds_left(const std::string& text) {
  static const std::regex left("(?:(\\d+) min )?(\\d+) s left");
  std::vector<int> all;
  for (std::sregex_iterator found(text.begin(), text.end(), left), end; found != end; ++found)
    all.push_back((*found)[1].matched ? 60 * std::stoi((*found)[1]) + std::stoi((*found)[2]) : std::stoi((*found)[2]));
  return all;
}

// Form factors of 25 % of the work take a tenth of the time here: the first estimate is far too small.
TEST(Progress, TheTimeLeftDoesNotJump) {
  testing::internal::CaptureStderr();
  {
    ProgressLine line(ProgressShown::line);
    line.expect({Stage::form_factors, Stage::error_bars});
    for (int tenth = 0; tenth <= 1000; ++tenth) {
      const double now = tenth / 10.0;
      if (now < 10)
        line.show({.stage = Stage::form_factors, .fraction = now / 10}, now);
      else
        line.show({.stage = Stage::error_bars, .fraction = (now - 10) / 90}, now);
    }
  }
  const std::vector<int> left = seconds_left(testing::internal::GetCapturedStderr());
  ASSERT_GT(left.size(), 900);
  for (std::size_t k = 1; k < left.size(); ++k) EXPECT_LE(std::abs(left[k] - left[k - 1]), 2) << k;
}

TEST(Progress, ALimitOnTheTimeSetsTheTimeLeft) {
  testing::internal::CaptureStderr();
  {
    ProgressLine line(ProgressShown::line);
    line.expect(stages, 0.2, 40);
    for (const double now : {0.0, 10.0, 20.0}) line.show({.stage = Stage::mesh}, now);
  }
  const std::vector<int> left = seconds_left(testing::internal::GetCapturedStderr());
  ASSERT_EQ(left.size(), 2);
  EXPECT_EQ(left[0], 30);
  EXPECT_EQ(left[1], 20);
}

}  // namespace
}  // namespace patchlight::progress_test
