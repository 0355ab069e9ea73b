#pragma once

#include <string>
#include <string_view>

namespace patchlight::cli {

/// How much the tool says.
enum class Verbosity { quiet, normal, verbose };

/// Prints one line "patchlight: KIND: TEXT" on stderr; line breaks in the text become spaces, names of fields of the
/// library those of options.
void print_message(const char* kind, const std::string& text);

/// A text in which no character acts on a terminal: control characters (C0, DEL and C1) but for line breaks are written
/// as \u001b, as in JSON, and bytes that are no UTF-8 and may act as C1 as \x9b.
std::string printable(std::string_view text);

/// A name of a file or in a file as it is shown: printable(), and line breaks written as \u000a.
std::string shown_name(std::string_view name);

}  // namespace patchlight::cli
