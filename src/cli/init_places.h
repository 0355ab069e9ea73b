#pragma once

#include "patchlight/scene/scene.h"

#include "input/toml/new_scene_file.h"

namespace patchlight::cli {

/// Places that solve accepts, and notes on those that it would not.
struct TriedPlaces {
  NewPlaces places;
  Diagnostics notes;
};

/// Sensors over the floors of rooms, else over the floor with the largest closed room above it, and a camera inside
/// each of the three rooms with the largest windows, else floors. `lit` is the scene with its light. A place is good
/// when it stands free, as place_sensors() has it, in enclosed air, as enclosed_places() has it over a ground. A floor
/// has sensors when half of them are good; a camera sees its target. None where the scene has its own.
TriedPlaces new_places(const Scene& lit);

}  // namespace patchlight::cli
