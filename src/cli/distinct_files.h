#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace patchlight::cli {

/// A file that is written, with the option that asks for it.
struct OutputFile {
  std::string option;
  std::filesystem::path file;  ///< empty when it is not wanted
};

/// Two names are of one file when device and inode say so, all links followed; of a file that is not there yet, the
/// folder and the last part of the name. \throws UsageError when two outputs are one file.
void require_distinct(const std::vector<OutputFile>& outputs);

/// \throws UsageError when an output is one of these files that were read.
void require_not_read(const std::vector<OutputFile>& outputs, const std::vector<std::filesystem::path>& inputs);

/// \throws UsageError when a file that was read lies in the folder that `output` replaces.
void require_not_read_from(const OutputFile& output, const std::vector<std::filesystem::path>& inputs);

}  // namespace patchlight::cli
