#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"

#include <string>

namespace patchlight {

/// SHA-256 of the mesh data that form factors depend on: the number of corners, the corners and the normal of every
/// patch, in order, as doubles to the last bit. 64 hexadecimal digits.
std::string geometry_hash(const PatchMesh& mesh);

/// SHA-256, hexadecimal, of all that a solution follows from: faces, materials and lights of a scene, whatever its
/// files are called. Sensors and cameras do not count, nor do notes.
std::string scene_hash(const Scene& scene);

}  // namespace patchlight
