#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace patchlight {

/// True for a folder that may be replaced: one with an earlier result.
using MayReplace = std::function<bool(const std::filesystem::path& folder)>;

/// What is written into a folder of its own.
struct FolderResult {
  std::string facts_file;          ///< JSON
  std::string kind;                ///< what stands in it as "kind"
  std::vector<std::string> names;  ///< of all that may be there
};

/// True for a folder that holds such a result, and nothing that was not written with it.
bool holds_result(const std::filesystem::path& folder, const FolderResult& result);

/// Lets `write` fill a temporary folder beside `folder` and renames it to `folder`: whoever looks sees the old folder
/// or the whole new one. When `write` throws, the temporary folder is removed and `folder` stays as it was. \throws
/// OutputError when the place is not writable, or `folder` is a file or holds what may not be replaced.
void write_whole_folder(const std::filesystem::path& folder, const MayReplace& may_replace,
                        const std::function<void(const std::filesystem::path& temporary)>& write);

/// Fails early: \throws OutputError when write_whole_folder could not write here. Removes what killed runs have left.
void check_folder_writable(const std::filesystem::path& folder, const MayReplace& may_replace);

}  // namespace patchlight
