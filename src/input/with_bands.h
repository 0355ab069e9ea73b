#pragma once

#include "patchlight/input/read_scene.h"

namespace patchlight {

/// The scene, which is in linear RGB, in the bands that are asked for, and Scene::band_choice, which says why. Nothing
/// changes where nothing has a spectrum by wavelength and no bands are asked for.
Scene with_bands(Scene scene, const BandsAsked& asked);

}  // namespace patchlight
