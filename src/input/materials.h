#pragma once

#include "patchlight/scene/scene.h"

#include <string>
#include <vector>

namespace patchlight {

/// The material of faces for which the file gives none: "default", reflectance 0.5 in all bands.
Material default_material();

/// An empty scene for a format without materials: its only material is the default one, and a note says so.
Scene scene_without_materials(const std::string& file, double metres_per_unit);

/// The scene with only those materials that polygons use, in their order, names that are empty or come twice made
/// unique: "material 3", "wall (2)".
Scene with_used_materials(Scene scene);

/// How many materials have properties that are not simulated, those that none has left out.
std::vector<UnsimulatedMaterials> counted(std::size_t mirrors, std::size_t glass);

/// A spectrum of shares for messages: "0.7", or "0.9, 0.5, 0.2" where bands differ.
std::string listed_shares(const Spectrum& shares);

/// "sentence: a, b", or nothing when there are no names.
Diagnostics note_on(DiagnosticCode code, const std::string& sentence, const std::vector<std::string>& names);

}  // namespace patchlight
