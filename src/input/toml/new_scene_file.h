#pragma once

#include "patchlight/scene/scene.h"

#include "input/toml/scene_file.h"
#include "scene/sensor_grid.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace patchlight {

/// A floor with the name of its room or of its group of faces.
struct NamedFloor {
  std::string name;
  Floor floor;
  double window_area = 0;  ///< of the room, m^2; 0 where it has no windows, or is not known as a room
};

/// The floors of the rooms that the models name, else of groups of faces that no dark_solids() cover: those of 2 m^2 or
/// more with some of the scene 1.8 m above them, the largest first.
std::vector<NamedFloor> named_floors(const Scene& scene);

/// Light for models that have none.
struct NewLight {
  bool is_sealed = false;                  ///< no daylight gets into the room: it needs lamps
  std::vector<Point> lamps;                ///< places for them, meters
  std::vector<std::string> rooms_without;  ///< names; empty where no room has a lamp of its own
};

/// Where no daylight gets in, lamps in up to twelve of the rooms that the models name, else under the ceiling.
NewLight new_light(const Scene& scene);

/// The scene with that light, or with a sky where daylight gets in; one with light as it is.
Scene with_new_light(Scene scene, const NewLight& light);

/// Where sensors and cameras of a new scene file stand.
struct NewPlaces {
  std::optional<FloorGrid> grid;
  std::vector<std::string> rooms_without;  ///< sensors
  std::vector<Camera> cameras;
};

/// The text of a commented scene file for models that were read as `scene`: the models, what may be left out, glass as
/// it was read, light, sensors and cameras. `file` is where the text will stand: models are named from its folder.
std::string new_scene_file(const Scene& scene, const NewLight& light, const NewPlaces& places,
                           const std::vector<std::filesystem::path>& models, std::optional<double> metres_per_unit,
                           const std::filesystem::path& file);

}  // namespace patchlight
