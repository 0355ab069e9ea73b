#pragma once

#include "patchlight/output/provenance.h"
#include "patchlight/views/views.h"

#include <filesystem>

namespace patchlight {

/// Writes the patches as a coloured surface for viewers: binary little-endian PLY, positions in metres in double, per
/// vertex the display colour (sRGB, 8 bits) of the interpolated radiance at the recorded exposure, one face per patch.
/// \throws OutputError.
void write_ply(const std::filesystem::path& file, const SolvedSurface& surface, const Provenance& provenance);

}  // namespace patchlight
