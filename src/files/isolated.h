#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace patchlight {

/// Limits of a child process. A house of 2 MB takes 0.1 s and 0.1 GB; a damaged number may make a library read forever.
struct ChildLimits {
  unsigned seconds = 10;                          ///< processor time, in addition to 1 s for each 100 kB of the file
  std::uint64_t bytes = std::uint64_t{1} << 30U;  ///< memory, in addition to 300 bytes for each byte of the file
};

/// Runs `read` in a child process and returns its bytes. Libraries for complex formats can crash on damaged files. Then
/// only the child ends, and its output does not reach the terminal. \throws InputError as `read`, or naming `file` when
/// the child crashed, threw another exception or exceeded a limit.
std::string bytes_isolated(const std::string& file, const std::function<std::string()>& read,
                           const ChildLimits& limits = {});

/// A program for a child process without environment variables.
struct Program {
  std::vector<std::string> command;             ///< program file and arguments
  std::vector<std::filesystem::path> readable;  ///< readable folders in addition to those of the system
};

/// The standard output of a program that reads `input` from its standard input, under the same limits. It opens no
/// connections, writes no files and reads no other folders. \throws InputError naming `file` when the program fails,
/// writes nothing or exceeds a limit.
std::string output_isolated(const std::string& file, const Program& program, const std::string& input,
                            const ChildLimits& limits = {});

}  // namespace patchlight
