#include "cli/option_names.h"

#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace patchlight::former_names_test {
namespace {

using namespace cli;

PresentNames present(const std::vector<const char*>& words) {
  return with_present_names(static_cast<int>(words.size()), words.data());
}

TEST(FormerNames, GiveTheSameWordsAsThePresentOnes) {
  using Words = std::vector<std::string>;
  EXPECT_EQ(present({"patchlight", "verify", "a.obj", "--bar", "2%", "--checked=8"}).words,
            (Words{"patchlight", "crosscheck", "a.obj", "--margin", "2%", "--sample-patches=8"}));
  EXPECT_EQ(present({"patchlight", "solve", "--storage=tiles", "--storage", "rays", "--on-demand"}).words,
            (Words{"patchlight", "solve", "--method", "pairs", "--method", "rays", "--method", "on-demand"}));
  EXPECT_EQ(present({"patchlight", "solve", "--force", "sun", "--force", "closure", "--skip=closure"}).words,
            (Words{"patchlight", "solve", "--enable", "sun", "--no-closure"}));
  EXPECT_EQ(present({"patchlight", "check", "a.obj", "--vtk", "new"}).words,
            (Words{"patchlight", "check", "a.obj", "--problems", "new"}));
  EXPECT_EQ(present({"patchlight", "solve", "--colour-error", "2", "--skip", "colour", "--", "--force"}).words,
            (Words{"patchlight", "solve", "--color-error", "2", "--disable", "color", "--", "--force"}));
}

TEST(FormerNames, AreNamedInRemarks) {
  EXPECT_EQ(present({"patchlight", "new", "a.obj", "--keep-faces"}).remarks,
            (std::vector<std::string>{"new is now init", "--keep-faces is now --no-merge"}));
  EXPECT_EQ(present({"patchlight", "solve", "--storage", "tiles"}).remarks,
            (std::vector<std::string>{"--storage tiles is now --method pairs"}));
}

TEST(FormerNames, LeavePresentNamesAsTheyAre) {
  const std::vector<const char*> words = {"patchlight",   "solve", "new",    "--report-",   "--raw",
                                          "--time-limit", "30s",   "--json", "colour.json", "--bar"};
  EXPECT_EQ(present(words).words, std::vector<std::string>(words.begin(), words.end()));
  EXPECT_TRUE(present(words).remarks.empty());
  EXPECT_TRUE(present({}).words.empty());
}

}  // namespace
}  // namespace patchlight::former_names_test
