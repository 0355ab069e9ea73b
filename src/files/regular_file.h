#pragma once

#include <filesystem>

namespace patchlight {

/// Reading anything else may wait without an end, or have none. \throws InputError when a file is there that is a
/// folder, a pipe or a device; of one that is not there nothing is said.
void require_regular_file(const std::filesystem::path& file);

}  // namespace patchlight
