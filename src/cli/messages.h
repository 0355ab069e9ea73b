#pragma once

#include <string>

namespace patchlight::cli {

/// How much the tool says.
enum class Verbosity { quiet, normal, verbose };

/// Prints one line "patchlight: KIND: TEXT" on stderr; line breaks in the text become spaces.
void print_message(const char* kind, const std::string& text);

}  // namespace patchlight::cli
