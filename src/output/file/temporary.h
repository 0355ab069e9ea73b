#pragma once

#include "patchlight/base/error.h"

#include <filesystem>
#include <string>
#include <string_view>

namespace patchlight {

/// What the names of all temporary files and folders begin with.
inline constexpr std::string_view temporary_prefix = ".patchlight-";

/// So many names are tried before it is an error that they are all taken.
inline constexpr int most_tries = 1000;

/// A name beside `file` that no other process and no other call uses. The extension stays, as writers look at it.
std::filesystem::path temporary_beside(const std::filesystem::path& file);

/// The file itself, absolute, where `file` is a symbolic link to it, also when that is not there yet: renaming
/// would replace the link. \throws OutputError when the name is empty, or links lead in a circle.
std::filesystem::path followed(const std::filesystem::path& file);

/// Makes sure that a file or folder is on disk. `file` is the name that the user knows. \throws OutputError.
void flush_to_disk(const std::filesystem::path& path, const std::filesystem::path& file);

/// The same error for a user who does not know of the temporary folder: its path is replaced by `known`.
OutputError renamed(const OutputError& error, const std::filesystem::path& temporary,
                    const std::filesystem::path& known);

/// \throws OutputError that tells the meaning of the system's error number.
[[noreturn]] void fail_writing(const std::filesystem::path& file, const std::string& message, int error_number);

}  // namespace patchlight
