// The names and severities of all codes.
#include "patchlight/base/diagnostics.h"

#include <gtest/gtest.h>
#include <set>

namespace patchlight::diagnostics_test {
namespace {

std::vector<DiagnosticCode> all_codes() {
  std::vector<DiagnosticCode> codes;
  for (int k = 0; k <= static_cast<int>(DiagnosticCode::checkpoint); ++k) codes.push_back(DiagnosticCode(k));
  return codes;
}

TEST(DiagnosticCode, HasANameOfItsOwnThatIsRead) {
  std::set<std::string> names;
  for (const DiagnosticCode code : all_codes()) {
    const std::string name = name_of(code);
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_EQ(name.find_first_not_of("abcdefghijklmnopqrstuvwxyz_"), std::string::npos) << name;
    EXPECT_EQ(diagnostic_code(name), code) << name;
  }
  EXPECT_FALSE(diagnostic_code("none"));
  EXPECT_EQ(name_of(DiagnosticCode::doubtful_sensor), "doubtful_sensor");
  EXPECT_EQ(name_of(DiagnosticCode::fine_outline), "fine_outline");
}

TEST(DiagnosticCode, IsNoGraverThanThoseBefore) {
  EXPECT_EQ(severity_of(DiagnosticCode::no_lamp), Severity::warning);
  Severity before = Severity::error;
  for (const DiagnosticCode code : all_codes()) {
    if (code == DiagnosticCode::no_lamp) continue;
    EXPECT_GE(severity_of(code), before) << name_of(code);
    before = severity_of(code);
    EXPECT_TRUE(!makes_results_wrong(code) || before == Severity::warning) << name_of(code);
  }
  EXPECT_EQ(severity_of(DiagnosticCode::covered_lamp), Severity::error);
  EXPECT_EQ(severity_of(DiagnosticCode::non_planar), Severity::warning);
  EXPECT_EQ(severity_of(DiagnosticCode::welded_vertices), Severity::remark);
  EXPECT_STREQ(name_of(severity_of(DiagnosticCode::checkpoint)), "note");
}

TEST(Diagnostics, AreSortedByCodeAndKeepTheirOrderWithinOne) {
  const Diagnostics sorted = worst_first({{DiagnosticCode::welded_vertices, "a"},
                                          {DiagnosticCode::non_planar, "b"},
                                          {DiagnosticCode::no_lamp, "c"},
                                          {DiagnosticCode::non_planar, "d"}});
  EXPECT_EQ(texts_of(sorted), (std::vector<std::string>{"c", "b", "d", "a"}));
}

TEST(Diagnostics, AreMergedInTheirOrder) {
  const Diagnostics first = {{DiagnosticCode::non_planar, "a"}};
  const Diagnostics second = {{DiagnosticCode::no_lamp, "b"}, {DiagnosticCode::no_lamp, "c"}};
  EXPECT_EQ(texts_of(merged({first, {}, second})), (std::vector<std::string>{"a", "b", "c"}));
}

}  // namespace
}  // namespace patchlight::diagnostics_test
