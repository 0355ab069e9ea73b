#pragma once

#include "patchlight/input/read_scene.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sensor.h"

#include "input/material_settings.h"
#include "input/scene_lights.h"

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace patchlight {

/// A model that a scene file names.
struct ModelEntry {
  std::filesystem::path file;
  std::string where;                         ///< "room.toml:3", for messages
  std::optional<double> metres_per_unit;     ///< of the model file; if not given, as it states, else 1
  std::optional<Eigen::Affine3d> placement;  ///< meters to meters
  FaceChoice choice;                         ///< what of it takes part
};

/// A grid of sensors over a floor, or one over that of each of some rooms, which are known once the models are read.
struct FloorGrid {
  std::string name;
  std::string group;                 ///< a name of polygon groups, or a pattern with * and ?; empty: of rooms
  std::vector<std::string> rooms;    ///< names of rooms, or patterns
  double height = 0;                 ///< meters above the floor
  std::optional<double> spacing;     ///< meters; that of standard_grid() unless stated
  std::optional<double> from_walls;  ///< meters: no sensor is nearer to the floor's rim; of standard_grid()
  std::string file;                  ///< that asks for it
  std::uint32_t line = 0;
};

/// The content of a scene file, in meters, before the models are read.
struct SceneFile {
  std::string file;
  std::vector<std::filesystem::path> inputs;  ///< it, and the files of lamps, weather, points and spectra it names
  std::string sha256;                         ///< of it and of the files of lamps, weather and spectra it names
  std::vector<ModelEntry> models;
  std::optional<Vector> up;
  std::vector<MaterialSetting> settings;
  std::vector<std::variant<SensorGroup, FloorGrid>> sensors;
  std::vector<Camera> cameras;
  LightEntries lights;
  double detail = 0;                              ///< ReadOptions::detail
  std::optional<double> maintenance_factor = {};  ///< ReadOptions::maintenance_factor
  bool keep_faces = false;                        ///< ReadOptions::keep_faces
  std::optional<BandsAsked> bands;
};

/// Reads a scene file in TOML; its paths start from its folder. docs/reference/scene-file.md lists the keys. \throws
/// InputError naming file, line and key, what was found and what was expected; also when a file does not lie in the
/// folder `confine`, if there is one.
SceneFile read_scene_file(const std::filesystem::path& file, const std::filesystem::path& confine);

}  // namespace patchlight
