#pragma once

#include "input/toml/toml_tables.h"
#include "scene/sensor_grid.h"
#include "scene/solids.h"

#include <filesystem>
#include <variant>
#include <vector>

namespace patchlight {

/// The tables [[sensors]], with files of points read. \throws InputError.
std::vector<std::variant<SensorGroup, FloorGrid>> sensors_of(const TomlValue& root, const TomlFrame& frame);

/// The files of points of a scene file.
std::vector<std::filesystem::path> sensor_files(const TomlValue& root, const TomlFrame& frame);

/// Grids over floors.
struct FloorSensors {
  std::vector<SensorGroup> groups;
  Diagnostics notes;  ///< on rooms without sensors, or with sensors over a part of the floor
};

/// The grid over the floor of the named groups, or over that of each room. Sensors in dark_solids() are removed.
/// \throws InputError when no group or room matches, or there is no floor.
FloorSensors sensors_over(const Scene& scene, const FloorGrid& grid);

/// The floor of some polygons: floor_of() the polygons that none of these solids covers.
Floor floor_of_polygons(const Scene& scene, const std::vector<PolygonIndex>& polygons,
                        const std::vector<Solid>& solids);

/// The places of a grid over one floor.
struct GridInAir {
  SensorGroup group;
  double share = 0;  ///< fraction of the floor without the strip along its boundary that the cells cover
};

/// A grid over a floor, without places in these solids. Empty if no place is far enough from the boundary.
/// \throws InputError for too many cells.
GridInAir grid_over(const Floor& floor, const FloorGrid& grid, const std::vector<Solid>& solids);

/// Removes places outside of a room, e.g. above a sloping roof or in a corner of another room. Rooms that are not
/// closed keep all places.
SensorGroup in_room(SensorGroup group, const NamedRoom& room);

}  // namespace patchlight
