#pragma once

#include "patchlight/scene/scene.h"

#include "input/toml/scene_file.h"
#include "scene/sensor_grid.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace patchlight {

/// A floor with the name of its room or group of faces.
struct NamedFloor {
  std::string name;
  Floor floor;
  double window_area = 0;  ///< of the room, m^2; 0 without windows, or if the floor belongs to no room
};

/// The floors of the named rooms, else of groups of faces outside dark_solids(). Floors have at least 2 m^2 and a part
/// of the scene at least 1.8 m above them. The largest come first.
std::vector<NamedFloor> named_floors(const Scene& scene);

/// Light for models without any.
struct NewLight {
  bool is_sealed = false;                  ///< no daylight enters; the room needs lamps
  std::vector<Point> lamps;                ///< positions, meters
  std::vector<std::string> rooms_without;  ///< names; empty if no room has a lamp of its own
};

/// Lamps for a model that no daylight enters: in up to twelve of the named rooms, else below the ceiling.
NewLight new_light(const Scene& scene);

/// Adds that light, or a sky if daylight can enter. A scene with light stays unchanged.
Scene with_new_light(Scene scene, const NewLight& light);

/// Sensors and cameras of a new scene file.
struct NewPlaces {
  std::optional<FloorGrid> grid;
  std::vector<std::string> rooms_without;  ///< sensors
  std::vector<Camera> cameras;
};

/// The text of a commented scene file for models that were read as `scene`: models, parts that can be left out, glass,
/// light, sensors and cameras. Paths of models are relative to the folder of `file`, the new scene file.
std::string new_scene_file(const Scene& scene, const NewLight& light, const NewPlaces& places,
                           const std::vector<std::filesystem::path>& models, std::optional<double> metres_per_unit,
                           const std::filesystem::path& file);

}  // namespace patchlight
