#pragma once

#include "patchlight/base/field.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"

namespace patchlight {

/// The reflectances of patches with those that lie in a picture replaced by the mean of the picture over the patch.
Field with_textures(Field reflectance, const Scene& scene, const PatchMesh& mesh);

}  // namespace patchlight
