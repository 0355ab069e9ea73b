#pragma once

#include "patchlight/scene/scene.h"

#include "input/toml/new_scene_file.h"

namespace patchlight::cli {

/// Places that solve accepts, and notes on the other ones.
struct TriedPlaces {
  NewPlaces places;
  Diagnostics notes;
};

/// Sensors over the floors of rooms, else over the floor with the largest closed room above it, and a camera in each of
/// the three rooms with the largest windows, else floors. `lit` is the scene with its light. A place is good if it is
/// free, see place_sensors(), and in enclosed air above a ground, see enclosed_places(). At least half of the places of
/// a floor must be good. A camera must see its target. A scene with its own sensors or cameras gets none.
TriedPlaces new_places(const Scene& lit);

}  // namespace patchlight::cli
