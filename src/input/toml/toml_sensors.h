#pragma once

#include "input/toml/toml_tables.h"
#include "scene/sensor_grid.h"
#include "scene/solids.h"

#include <filesystem>
#include <variant>
#include <vector>

namespace patchlight {

/// The tables [[sensors]]; files of points are read. \throws InputError.
std::vector<std::variant<SensorGroup, FloorGrid>> sensors_of(const TomlValue& root, const TomlFrame& frame);

/// The files of points that a scene file names.
std::vector<std::filesystem::path> sensor_files(const TomlValue& root, const TomlFrame& frame);

/// Grids over floors.
struct FloorSensors {
  std::vector<SensorGroup> groups;
  Diagnostics notes;  ///< on rooms without sensors, or with sensors over a part of the floor
};

/// The grid over the floor of the groups that it names, or one over that of each of the rooms, without places in
/// dark_solids(). \throws InputError when there are no such groups or rooms, or no floor.
FloorSensors sensors_over(const Scene& scene, const FloorGrid& grid);

/// The floor of some polygons: floor_of() those that none of these solids covers.
Floor floor_of_polygons(const Scene& scene, const std::vector<PolygonIndex>& polygons,
                        const std::vector<Solid>& solids);

/// Places of a grid over one floor.
struct GridInAir {
  SensorGroup group;
  double share = 0;  ///< of the floor beyond the strip along its rim that the cells cover
};

/// A grid over a floor, without places in these solids; empty where no place is far enough from the rim. \throws
/// InputError when it has too many cells.
GridInAir grid_over(const Floor& floor, const FloorGrid& grid, const std::vector<Solid>& solids);

/// Without places outside of a room, above a sloping roof or in a nook of another room. A room that is not closed has
/// no inside: all stay.
SensorGroup in_room(SensorGroup group, const NamedRoom& room);

}  // namespace patchlight
