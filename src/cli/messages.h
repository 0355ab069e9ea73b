#pragma once

#include "patchlight/scene/scene.h"

#include <string>
#include <string_view>

namespace patchlight::cli {

/// How much the tool says.
enum class Verbosity { quiet, normal, verbose };

/// Prints "patchlight: KIND: TEXT" on stderr, with the names of options in place of fields of the library. Each part of
/// the text that begins with "hint: " on a new line has a line of its own; other line breaks become spaces.
void print_message(const char* kind, const std::string& text);

/// Prints "patchlight: KIND: CODE: TEXT" in the same way.
void print_diagnostic(const char* kind, const Diagnostic& diagnostic);

/// Prints a warning on stderr for each problem that can make all results wrong. Commands call it before the work
/// begins, also when they are quiet.
void print_scene_warnings(const Scene& scene);

/// A text in which no character acts on a terminal: control characters (C0, DEL and C1) but for line breaks are written
/// as \u001b, as in JSON, and bytes that are no UTF-8 and may act as C1 as \x9b.
std::string printable(std::string_view text);

/// A name of a file or in a file as it is shown: printable(), and line breaks written as \u000a.
std::string shown_name(std::string_view name);

}  // namespace patchlight::cli
