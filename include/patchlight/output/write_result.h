#pragma once

#include "patchlight/output/provenance.h"
#include "patchlight/views/surface.h"

#include <filesystem>
#include <string>
#include <vector>

namespace patchlight {

/// The extensions write_result() knows: ".vtp", ".ply", ".glb".
const std::vector<std::string>& result_extensions();

/// Writes the solved patches in the format that the extension names. \throws OutputError, also for an unknown one.
void write_result(const std::filesystem::path& file, const SolvedSurface& surface, const Provenance& provenance);

}  // namespace patchlight
