#include "base/near_match.h"

#include <gtest/gtest.h>

namespace patchlight::shell_word_test {
namespace {

TEST(ShellWord, IsAsItIsWhereNoShellTakesItApart) {
  for (const std::string word : {"room.obj", "--max-edge=0.1", "../a_b/c-d,e:f+g", "lamp.radiance=20,10,5"})
    EXPECT_EQ(shell_word(word), word);
}

TEST(ShellWord, IsInQuotesElsewhere) {
  EXPECT_EQ(shell_word("Ceiling Lamp"), "'Ceiling Lamp'");
  EXPECT_EQ(shell_word(""), "''");
  for (const char letter : std::string(" \t\n\"\\$`*?[]{}()<>|&;#~!^")) {
    const std::string word = std::string("a") + letter + "b";
    EXPECT_EQ(shell_word(word), "'" + word + "'");
  }
}

// What stands in quotes ends at the next one: '\'' ends it, adds a quote, and begins it again.
TEST(ShellWord, KeepsItsQuotes) {
  EXPECT_EQ(shell_word("Ann's lamp"), "'Ann'\\''s lamp'");
  EXPECT_EQ(shell_word("'"), "''\\'''");
}

}  // namespace
}  // namespace patchlight::shell_word_test
