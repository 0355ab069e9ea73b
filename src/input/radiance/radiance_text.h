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
  std::string kind;  ///< "polygon"; "alias", whose only word is its target; "!" for a program
  std::string name;
  std::vector<std::string> words;  ///< string arguments; for a program, the line without "!"
  std::vector<double> numbers;     ///< real arguments
  std::uint32_t line = 0;          ///< first line
};

/// Reads the primitives of a Radiance scene file. White space separates words, quotes enclose them, and a word that
/// begins with # starts a comment.
class RadianceText {
 public:
  /// `text` must outlive this object.
  RadianceText(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

  /// True when there is another primitive.
  bool has_more();

  /// The next primitive. \throws InputError naming the line at a premature end, or for an invalid number.
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

/// The programs of a pipe, each with its words without quotes. Empty if the line needs a shell: lists of programs,
/// variables, patterns.
std::vector<std::vector<std::string>> piped_commands(std::string_view command);

}  // namespace patchlight
