#pragma once

#include "patchlight/scene/scene.h"

#include <filesystem>
#include <string>
#include <vector>

namespace patchlight {

/// The text of a commented scene file for models that were read as `scene`: the models, what may be left out, glass as
/// it was read, a sky where nothing shines, or lamps in up to twelve rooms where no daylight gets in with the names of
/// those that have none, sensors over the floors of rooms, and a camera inside each of the three with the largest
/// windows, else the largest floors. Rooms are those that the models name, else the groups with the largest floors.
/// `file` is where the text will stand: models are named from its folder.
std::string new_scene_file(const Scene& scene, const std::vector<std::filesystem::path>& models,
                           std::optional<double> metres_per_unit, const std::filesystem::path& file);

}  // namespace patchlight
