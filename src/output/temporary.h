#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace patchlight {

/// What the names of all temporary files and folders begin with.
inline constexpr std::string_view temporary_prefix = ".patchlight-";

/// A name beside `file` that no other process and no other call uses. The extension stays, as writers look at it.
std::filesystem::path temporary_beside(const std::filesystem::path& file);

/// The file itself, absolute, where `file` is a symbolic link to it: renaming would replace the link.
/// \throws OutputError when the name is empty.
std::filesystem::path followed(const std::filesystem::path& file);

/// Makes sure that a file or folder is on disk. `file` is the name that the user knows. \throws OutputError.
void flush_to_disk(const std::filesystem::path& path, const std::filesystem::path& file);

/// \throws OutputError that tells the meaning of the system's error number.
[[noreturn]] void fail_writing(const std::filesystem::path& file, const std::string& message, int error_number);

}  // namespace patchlight
