#pragma once

#include <memory>
#include <streambuf>

namespace patchlight::cli {

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
