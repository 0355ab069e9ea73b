#pragma once

#include "patchlight/light/material.h"
#include "patchlight/scene/scene.h"

#include "input/gltf_model.h"

#include <string>
#include <vector>

namespace patchlight {

/// The materials of a glTF file as diffuse ones: reflectance is the base colour, radiance in W/(m^2 sr) the emissive
/// factor times the emissive strength. A texture counts by its mean colour, if it could be decoded. Those with
/// transmission or, blended, an alpha below 1 are panes, smooth metals mirrors.
std::vector<Material> gltf_materials(const GltfModel& gltf);

/// The numbers of materials that are metallic and no mirrors, or transparent by textures or masks.
std::vector<UnsimulatedMaterials> unsimulated(const GltfModel& gltf);

/// One sentence per property that the materials have and the simulation ignores or simplifies.
std::vector<std::string> notes_on_materials(const GltfModel& gltf);

}  // namespace patchlight
