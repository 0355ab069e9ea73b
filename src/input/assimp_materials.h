#pragma once

#include "patchlight/scene/scene.h"

#include "input/assimp_pictures.h"

namespace patchlight {

/// The scene with all materials of the model, and with notes on what those that meshes use have that is not simulated.
/// Those with a picture are grey and have one texel; where there are pictures the inputs name them, one for each
/// material, as with_decoded_pictures() takes them.
Scene with_assimp_materials(Scene scene, const aiScene& model, const AssimpPictures& pictures);

}  // namespace patchlight
