#pragma once

#include "patchlight/scene/scene.h"

#include "input/radiance/radiance_modifiers.h"

#include <filesystem>

namespace patchlight {

/// A Radiance scene file as a scene, and the modifiers that later files may use.
struct RadianceModel {
  Scene scene;
  RadianceModifiers modifiers;
};

/// Reads a Radiance scene file, and those that its !xform lines and instances name, which are looked for beside it and
/// in the current folder and must lie in the folder `confine` if there is one. `known` has what earlier files defined.
/// Other programs are not run. Fills Scene::vertices (metres), polygons, materials, groups, sun, sky, file, inputs,
/// sha256, metres_per_unit, up (z) and notes on what is left out. The lines of polygons are those of the file itself.
/// \throws InputError naming the file and the line.
RadianceModel read_radiance(const std::filesystem::path& file, double metres_per_unit,
                            const std::filesystem::path& confine, RadianceModifiers known);

}  // namespace patchlight
