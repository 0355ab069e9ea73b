#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace patchlight {

/// Limits of a child process. A house of 2 MB takes 0.1 s and 0.1 GB; after a damaged number assimp may read on
/// without end.
struct ChildLimits {
  unsigned seconds = 60;                          ///< of processor time
  std::uint64_t bytes = std::uint64_t{1} << 30U;  ///< of memory, besides 300 for each byte of the file
};

/// The bytes that `read` returns in a child process. Libraries that read rich formats can crash on damaged files; then
/// only the child ends, and nothing that they print reaches the terminal. \throws InputError as `read` does, and naming
/// `file` when the child crashed, threw anything else or exceeded a limit.
std::string bytes_isolated(const std::string& file, const std::function<std::string()>& read,
                           const ChildLimits& limits = {});

/// A program that runs in a child process, without any environment variables.
struct Program {
  std::vector<std::string> command;             ///< its file and its arguments
  std::vector<std::filesystem::path> readable;  ///< folders that it reads, besides those of the system
};

/// The standard output of a program that reads `input` from its standard input, under the same limits. It opens no
/// connections, writes no files and reads no other folders. \throws InputError naming `file` when the program fails,
/// writes nothing or exceeds a limit.
std::string output_isolated(const std::string& file, const Program& program, const std::string& input,
                            const ChildLimits& limits = {});

}  // namespace patchlight
