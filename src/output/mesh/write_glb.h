#pragma once

#include "patchlight/output/provenance.h"
#include "patchlight/views/views.h"

#include <filesystem>

namespace patchlight {

/// Writes the patches as a coloured surface for viewers and the web: binary glTF 2.0, unlit (KHR_materials_unlit), one
/// sided, triangles, vertex colours of the interpolated radiance at the recorded exposure. glTF is Y up: a scene whose
/// z points up is turned, (x, y, z) becomes (x, z, -y). Positions are floats relative to the centre of the bounds,
/// which is the node's translation. \throws OutputError, also when the file would exceed the format's 4 GiB.
void write_glb(const std::filesystem::path& file, const SolvedSurface& surface, const Provenance& provenance);

}  // namespace patchlight
