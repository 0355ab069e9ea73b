#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include <string>

namespace patchlight {

/// SHA-256 of what the mesh tells form factors: the number of corners, the corners and the normal of every patch, in
/// order, as doubles to the last bit. 64 hexadecimal digits.
std::string geometry_hash(const PatchMesh& mesh);

}  // namespace patchlight
