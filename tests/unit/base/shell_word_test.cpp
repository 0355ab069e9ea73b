#include "base/words.h"

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

// A quoted string ends at the next quote: '\'' ends it, adds a quote, and starts the next one.
TEST(ShellWord, KeepsItsQuotes) {
  EXPECT_EQ(shell_word("Ann's lamp"), "'Ann'\\''s lamp'");
  EXPECT_EQ(shell_word("'"), "''\\'''");
}

}  // namespace
}  // namespace patchlight::shell_word_test
