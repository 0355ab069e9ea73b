#pragma once

#include <filesystem>
#include <string_view>

namespace patchlight {

/// Writes `bytes` as a whole file, see write_whole_file(). \throws OutputError.
void write_bytes(const std::filesystem::path& file, std::string_view bytes);

}  // namespace patchlight
