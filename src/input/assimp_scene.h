#pragma once

#include "patchlight/scene/scene.h"

#include <string>

namespace patchlight {

/// Reads a COLLADA model with assimp: all faces, in the order of the nodes, with the nodes' transformations.
/// Coordinates pass through single precision, and axes stay as in the file. Diffuse colours become reflectances,
/// emissive colours radiances in W/(m^2 sr), an opacity below 1 makes a pane. Fills vertices (metres), polygons,
/// materials, maps into pictures, groups (names of the nodes), file, metres_per_unit, notes and the inputs, as
/// with_decoded_pictures() takes them. May crash on damaged files: call it within read_isolated(). \throws InputError
/// naming `file`.
Scene assimp_scene(const std::string& bytes, const std::string& file, double metres_per_unit);

}  // namespace patchlight
