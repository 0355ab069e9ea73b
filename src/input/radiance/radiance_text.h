#pragma once

#include "patchlight/base/error.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace patchlight {

/// A statement of a Radiance scene file: a primitive, or a line that starts a program.
struct RadiancePrimitive {
  std::string modifier;
  std::string kind;  ///< "polygon"; "alias", whose only word is the name it stands for; "!" for a program
  std::string name;
  std::vector<std::string> words;  ///< its string arguments; of a program, the line without "!"
  std::vector<double> numbers;     ///< its real arguments
  std::uint32_t line = 0;          ///< where it begins
};

/// The primitives of a Radiance scene file, one after the other. Words are separated by white space, may be in quotes,
/// and what follows a word that begins with # is a comment.
class RadianceText {
 public:
  /// The text has to live as long as this.
  RadianceText(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

  /// True when there is another primitive.
  bool has_more();

  /// The next one. \throws InputError naming the line: the file ends within it, or what should be a number is none.
  RadiancePrimitive next();

 private:
  std::string_view word(const std::string& what);
  std::size_t count(const std::string& what);
  std::string_view command();
  [[noreturn]] void refuse(const std::string& message) const;

  std::string_view text_;
  std::string file_;
  std::size_t at_ = 0;
  std::uint32_t line_ = 1;       // at `at_`
  std::uint32_t word_line_ = 1;  // of the last word
};

/// The programs of a line, each with its words, quotes taken off; a pipe leads from one to the next. An empty list
/// where a shell would do more with it: lists of programs, variables, patterns.
std::vector<std::vector<std::string>> piped_commands(std::string_view command);

}  // namespace patchlight
