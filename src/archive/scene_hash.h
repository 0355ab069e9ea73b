#pragma once

#include "patchlight/scene/scene.h"

#include <string>

namespace patchlight {

/// SHA-256, hexadecimal, of all that a solution follows from: faces, materials and lights of a scene, whatever its
/// files are called. Sensors and cameras do not count, nor do notes.
std::string scene_hash(const Scene& scene);

}  // namespace patchlight
