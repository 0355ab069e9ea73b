#pragma once

#include "patchlight/scene/scene.h"

#include <memory>
#include <streambuf>
#include <string>
#include <string_view>
#include <vector>

namespace patchlight::cli {

/// The codes that the tool returns to the shell.
enum ExitCode : int {
  good = 0,
  usage_error = 1,        ///< the command line cannot be understood
  input_error = 2,        ///< the model or another input file cannot be used
  not_converged = 3,      ///< the solver did not reach the tolerance, or the error bars not the accuracy that was asked
                          ///< for; the results are written all the same
  out_of_memory = 4,      ///< the work would need more memory than there is
  validation_failed = 5,  ///< a result differs from the known or traced one by more than its error bar, or the bars are
                          ///< so wide that no difference could show
  output_error = 6,       ///< a result cannot be written
  internal_error = 70,    ///< a defect of patchlight
  signal_base = 128       ///< 128 + n: stopped by signal n, e.g. 130 by Ctrl-C; no file is half-written
};

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

using TextRow = std::vector<std::string>;

/// Rows as lines with columns, each as wide as its widest cell; all rows have as many cells as the first.
std::string text_table(const std::vector<TextRow>& rows);

/// Opens those of stdin, stdout and stderr that the caller has closed, so that no file of the program takes their
/// place. What is written to a closed stdout fails.
void open_standard_streams();

/// As long as this lives, what is written to std::cout is printable(), and no failure to write it is lost.
class StandardOutput {
 public:
  StandardOutput();
  ~StandardOutput();
  StandardOutput(const StandardOutput&) = delete;
  StandardOutput& operator=(const StandardOutput&) = delete;

  /// \throws OutputError when something could not be written.
  void finish();

 private:
  class Buffer;
  std::unique_ptr<Buffer> buffer_;
  std::streambuf* before_;
};

}  // namespace patchlight::cli
