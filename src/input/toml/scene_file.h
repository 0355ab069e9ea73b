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

/// A model of a scene file.
struct ModelEntry {
  std::filesystem::path file;
  std::string where;                         ///< "room.toml:3", for messages
  std::optional<double> metres_per_unit;     ///< unit of the model file; default: the unit that it states, else 1
  std::optional<Eigen::Affine3d> placement;  ///< meters to meters
  FaceChoice choice;                         ///< the faces to keep
};

/// A grid of sensors over a floor, or over the floor of each room of a list. Rooms are known after the models are read.
struct FloorGrid {
  std::string name;
  std::string group;                 ///< a name of polygon groups, or a pattern with * and ?; empty: rooms
  std::vector<std::string> rooms;    ///< names or patterns
  double height = 0;                 ///< meters above the floor
  std::optional<double> spacing;     ///< meters; default: standard_grid()
  std::optional<double> from_walls;  ///< meters, the least distance from the floor's boundary; default: standard_grid()
  std::string file;                  ///< the scene file
  std::uint32_t line = 0;
};

/// The content of a scene file, in meters, before the models are read.
struct SceneFile {
  std::string file;
  std::vector<std::filesystem::path> inputs;  ///< the file itself and its files of lamps, weather, points and spectra
  std::string sha256;                         ///< SHA-256 of the same files without points
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

/// Reads a scene file in TOML. Paths are relative to its folder. docs/reference/scene-file.md lists the keys.
/// \throws InputError with file, line, key, found and expected value; also for a file outside the folder `confine` (if
/// given).
SceneFile read_scene_file(const std::filesystem::path& file, const std::filesystem::path& confine);

}  // namespace patchlight
