#include "cli/commands.h"

#include <gtest/gtest.h>

namespace patchlight::cli {
namespace {

// One case whose value is 0.25 +- 0.01.
std::vector<ValidationCase> quarter(double exact) {
  return {{"quarter", exact, "a law", [](const Observer&) { return Measured{0.25, 0.01, "a guess"}; }}};
}

TEST(Selftest, AGoodTableEndsGood) {
  testing::internal::CaptureStdout();
  EXPECT_EQ(run(SelftestArguments{}, quarter(0.255)), good);
  const std::string table = testing::internal::GetCapturedStdout();
  EXPECT_NE(table.find("good"), std::string::npos);
  EXPECT_NE(table.find("1 cases, 0 outside"), std::string::npos);
}

TEST(Selftest, ACaseOutsideItsBarEndsWithFive) {
  testing::internal::CaptureStdout();
  const ExitCode code = run(SelftestArguments{}, quarter(0.27));
  EXPECT_EQ(code, validation_failed);
  EXPECT_EQ(int{code}, 5);
  EXPECT_NE(testing::internal::GetCapturedStdout().find("OUTSIDE"), std::string::npos);
}

TEST(Selftest, JsonSaysSoToo) {
  testing::internal::CaptureStdout();
  SelftestArguments arguments;
  arguments.json_on_stdout = true;
  EXPECT_EQ(run(arguments, quarter(0.27)), validation_failed);
  EXPECT_NE(testing::internal::GetCapturedStdout().find("\"sound\": false"), std::string::npos);
}

}  // namespace
}  // namespace patchlight::cli
