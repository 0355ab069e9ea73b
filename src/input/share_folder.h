#pragma once

#include <filesystem>

namespace patchlight {

/// The file `name` ("ifc/read_ifc.mjs") of those that patchlight installs into share/patchlight. It stands beside the
/// program or the library in one of the folders above it, in the build tree too, else in XDG_DATA_DIRS. Empty when
/// there is none.
std::filesystem::path shared_file(const std::filesystem::path& name);

}  // namespace patchlight
