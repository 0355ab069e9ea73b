#pragma once

#include <filesystem>
#include <functional>

namespace patchlight {

/// Lets `write` fill a temporary file beside `file`, flushes it to disk and renames it to `file`: whoever looks sees
/// the old file or the whole new one. When `write` throws, the temporary file is removed and `file` stays as it was.
/// \throws OutputError when the folder is missing or not writable, or `file` is a folder.
void write_whole_file(const std::filesystem::path& file,
                      const std::function<void(const std::filesystem::path& temporary)>& write);

/// Fails early: \throws OutputError when write_whole_file could not write here.
void check_writable(const std::filesystem::path& file);

}  // namespace patchlight
