#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace patchlight {

/// "room.obj:12".
inline std::string at_line(const std::filesystem::path& file, std::uint32_t line) {
  return file.string() + ":" + std::to_string(line);
}

}  // namespace patchlight
