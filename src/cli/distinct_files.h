#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace patchlight::cli {

/// An output file, with its option.
struct OutputFile {
  std::string option;
  std::filesystem::path file;  ///< empty if not requested
};

/// Compares files by device and inode, with links resolved; missing files by folder and name. \throws UsageError when
/// two outputs are the same file.
void require_distinct(const std::vector<OutputFile>& outputs);

/// \throws UsageError when an output is also an input.
void require_not_read(const std::vector<OutputFile>& outputs, const std::vector<std::filesystem::path>& inputs);

/// \throws UsageError when an input lies in the folder that `output` replaces.
void require_not_read_from(const OutputFile& output, const std::vector<std::filesystem::path>& inputs);

}  // namespace patchlight::cli
