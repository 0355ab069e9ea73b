#pragma once

#include "patchlight/scene/scene.h"

namespace patchlight {

/// The scene with neighbouring bands as one where no reflectance or transmittance tells them apart and all lights have
/// the same share of their light in each, or none has any: nothing that is linear in light changes.
Scene with_alike_bands_joined(Scene scene);

}  // namespace patchlight
