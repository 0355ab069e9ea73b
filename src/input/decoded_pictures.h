#pragma once

#include "patchlight/scene/scene.h"

#include <filesystem>
#include <string>

namespace patchlight {

/// The scene of a model file, which assimp read and which has `bytes`, with its pictures. Of a scene with pictures the
/// inputs name that of each material, empty for none; materials with one that are no panes have a texture that stands
/// in its place, and their polygons have maps. Where a picture cannot be read the material stays as it is, without
/// texture, and a note names it. Leaves materials that no polygon uses out, and fills inputs and sha256. Pictures that
/// do not lie in the folder `confine`, if there is one, are not read.
Scene with_decoded_pictures(Scene scene, const std::string& bytes, const std::filesystem::path& confine);

}  // namespace patchlight
