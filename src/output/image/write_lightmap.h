#pragma once

#include "patchlight/output/provenance.h"
#include "patchlight/render/image.h"
#include "patchlight/scene/scene.h"
#include "patchlight/simulate.h"

#include <cstddef>
#include <filesystem>
#include <string>

namespace patchlight {

/// Writes a lightmap as a folder: irradiance, direct and indirect as .exr, linear in W/m^2, and as .png, as a white
/// matt surface would look; lightmap.glb and baked.glb (output/lightmap_glb.h); and lightmap.json with what is known of
/// it. The folder appears as a whole. \throws OutputError, also when it holds anything else than an earlier lightmap.
void write_lightmap(const std::filesystem::path& folder, const Scene& scene, const Simulation& simulation,
                    const Lightmap& map, const Provenance& provenance);

/// Fails early: \throws OutputError when write_lightmap could not write here.
void check_lightmap_writable(const std::filesystem::path& folder);

/// Bytes that the map takes in memory.
std::size_t bytes_of(const Lightmap& map);

}  // namespace patchlight
