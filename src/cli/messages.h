#pragma once

#include "patchlight/scene/scene.h"

#include <memory>
#include <streambuf>
#include <string>
#include <string_view>
#include <vector>

namespace patchlight::cli {

/// Exit codes of the tool.
enum ExitCode : int {
  good = 0,
  usage_error = 1,        ///< the command line is invalid
  input_error = 2,        ///< the model or another input file is invalid
  not_converged = 3,      ///< the solver missed the tolerance, or the error bars the requested accuracy; results are
                          ///< written
  out_of_memory = 4,      ///< the work needs more memory than available
  validation_failed = 5,  ///< a result differs from the known or traced one by more than its error bar, or the bars are
                          ///< too wide for a test
  output_error = 6,       ///< a result cannot be written
  internal_error = 70,    ///< a bug in patchlight
  signal_base = 128       ///< 128 + n: stopped by signal n, e.g. 130 for Ctrl-C; no file is half-written
};

/// Prints "patchlight: KIND: TEXT" on stderr, with option names in place of library fields. Each "hint: " at the start
/// of a line keeps its own line; other line breaks become spaces.
void print_message(const char* kind, const std::string& text);

/// Prints "patchlight: KIND: CODE: TEXT" in the same way.
void print_diagnostic(const char* kind, const Diagnostic& diagnostic);

/// Prints a warning on stderr for each problem that can invalidate all results. Commands call it before the work
/// starts, even with --quiet.
void print_scene_warnings(const Scene& scene);

/// A text without characters that control a terminal. Control characters (C0, DEL and C1), except line breaks, become
/// \u001b as in JSON. Bytes that are not UTF-8 and may act as C1 become \x9b.
std::string printable(std::string_view text);

/// The displayed form of a file name or a name in a file: printable(), with line breaks as \u000a.
std::string shown_name(std::string_view name);

using TextRow = std::vector<std::string>;

/// Rows as lines with aligned columns. Each row has as many cells as the first.
std::string text_table(const std::vector<TextRow>& rows);

/// Opens those of stdin, stdout and stderr that the caller closed, so that no other file gets their number. Writing to
/// a closed stdout fails.
void open_standard_streams();

/// During its lifetime std::cout prints printable() text, and no write error is lost.
class StandardOutput {
 public:
  StandardOutput();
  ~StandardOutput();
  StandardOutput(const StandardOutput&) = delete;
  StandardOutput& operator=(const StandardOutput&) = delete;

  /// \throws OutputError when writing failed.
  void finish();

 private:
  class Buffer;
  std::unique_ptr<Buffer> buffer_;
  std::streambuf* before_;
};

}  // namespace patchlight::cli
