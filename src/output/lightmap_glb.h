#pragma once

#include "patchlight/output/provenance.h"
#include "patchlight/render/image.h"
#include "patchlight/scene/scene.h"
#include "patchlight/simulate.h"

#include <filesystem>

namespace patchlight {

/// Writes the patches as binary glTF 2.0 for engines that light them by a lightmap: the materials' reflectances as base
/// colours, normals, TEXCOORD_1 the place in the lightmap and TEXCOORD_0 that in the material's picture, or metres
/// along the face where it has none. One-sided triangles, y up, positions as write_glb() has them. \throws OutputError.
void write_lightmap_glb(const std::filesystem::path& file, const Scene& scene, const Simulation& simulation,
                        const Lightmap& map, const Provenance& provenance);

/// The same with the light itself as colours for viewers: unlit (KHR_materials_unlit), the map's radiance exposed and
/// embedded as PNG, its places in TEXCOORD_0 and in TEXCOORD_1. Clear faces are drawn as thin glass. \throws
/// OutputError.
void write_baked_glb(const std::filesystem::path& file, const Scene& scene, const Simulation& simulation,
                     const Lightmap& map, const Provenance& provenance);

}  // namespace patchlight
