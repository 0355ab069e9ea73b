#pragma once

#include <filesystem>

namespace patchlight {

/// The folder of the project's own models.
std::filesystem::path mesh_folder();

}  // namespace patchlight
