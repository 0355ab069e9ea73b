#include "input/toml/toml_sensors.h"

#include "patchlight/base/error.h"

#include "base/words.h"
#include "input/left_out.h"
#include "input/material_settings.h"
#include "input/tables/read_tables.h"
#include "input/text.h"
#include "scene/extent.h"
#include "scene/room_body.h"

#include <algorithm>
#include <limits>
#include <set>

namespace patchlight {
namespace {

std::uint32_t line_of(const std::string& where) {
  return whole_number_in<std::uint32_t>(std::string_view(where).substr(where.rfind(':') + 1)).value_or(0);
}

[[noreturn]] void refuse_spacing(const std::string& where, double cells) {
  throw InputError(where, "sensors.spacing: found a grid of " + std::to_string(static_cast<std::uint64_t>(cells)) +
                              " cells; expected at most " + std::to_string(static_cast<std::uint64_t>(most_sensors)) +
                              "\nhint: a larger spacing");
}

// Refuses grids that are too fine. `edges` start at one corner, in meters.
void require_sensible(const std::string& where, const std::array<Vector, 2>& edges, double spacing) {
  const double cells = cells_along(edges[0].norm(), spacing) * cells_along(edges[1].norm(), spacing);
  if (!(cells <= most_sensors)) refuse_spacing(where, std::min(cells, 1e18));
}

SensorGroup points_of(const TomlValue& list, const TomlFrame& frame) {
  const std::string expected = "points [x, y, z, nx, ny, nz]";
  if (list.kind != TomlValue::Kind::list || list.items.empty()) refuse(list, "a list of " + expected);
  SensorGroup group;
  for (const TomlValue& item : list.items) {
    const std::vector<double> values = numbers(item, 6, expected);
    const Vector direction(&values[3]);
    if (!(direction.stableNorm() > 0)) refuse(item, expected + " with a direction that is not 0, 0, 0");
    group.sensors.push_back({frame.metres_per_unit * Point(values.data()), direction.stableNormalized()});
    group.lines.push_back(line_of(item.where));
  }
  return group;
}

SensorGroup points_in(const TomlValue& name, const TomlFrame& frame) {
  const std::filesystem::path file = named_file(name, frame);
  return parse_points(read_text(file, file.string(), "the file of points"), file, frame.metres_per_unit);
}

SensorGroup rectangle_of(const TomlValue& table, const TomlFrame& frame) {
  const Point corner = frame.metres_per_unit * vector(*find(table, "corner"));
  const TomlValue& list = required(table, "edges", "two edges [[x, y, z], [x, y, z]] from the corner");
  if (list.kind != TomlValue::Kind::list || list.items.size() != 2) refuse(list, "two edges [[x, y, z], [x, y, z]]");
  const std::array<Vector, 2> edges = {frame.metres_per_unit * vector(list.items[0]),
                                       frame.metres_per_unit * vector(list.items[1])};
  const double area = edges[0].cross(edges[1]).norm();
  if (!(area > 1e-9 * edges[0].norm() * edges[1].norm())) refuse(list, "two edges that span an area");
  const TomlValue& spacing = required(table, "spacing", "the length of a cell");
  const double length = frame.metres_per_unit * positive(spacing);
  require_sensible(spacing.where, edges, length);
  return rectangle_grid(corner, edges, length);
}

// Refuses keys that require another key.
void require_absent(const TomlValue& table, const std::vector<std::string>& keys, const std::string& kind) {
  for (const std::string& key : keys) {
    const TomlValue* const value = find(table, key);
    if (value == nullptr) continue;
    throw InputError(value->where, value->name + " does not apply to sensors with '" + kind + "'\nhint: leave it out");
  }
}

// A grid over floors of groups, or of rooms.
FloorGrid floor_grid_of(const TomlValue& table, const TomlFrame& frame, const std::string& name,
                        const std::string& kind) {
  require_absent(table, {"edges"}, kind);
  const auto length = [&](const char* key, double (*checked)(const TomlValue&)) -> std::optional<double> {
    const TomlValue* const value = find(table, key);
    return value ? std::optional(frame.metres_per_unit * checked(*value)) : std::nullopt;
  };
  const TomlValue& place = *find(table, kind);
  FloorGrid grid;
  grid.name = name;
  if (kind == "floor") grid.group = text(place, "the name of polygon groups, or a pattern with * and ?");
  if (kind == "room") grid.rooms = texts(place, "the name of rooms, a pattern with * and ?, or a list of such");
  required(table, "height", "the height above the floor");
  grid.height = *length("height", not_negative);
  grid.spacing = length("spacing", positive);
  grid.from_walls = length("from_walls", not_negative);
  if (kind == "floor" && !grid.from_walls) grid.from_walls = 0;
  grid.file = frame.file.string();
  grid.line = line_of(place.where);
  return grid;
}

std::variant<SensorGroup, FloorGrid> sensors_of_table(const TomlValue& table, const TomlFrame& frame,
                                                      const std::string& name) {
  allow_keys(table, {"name", "points", "file", "corner", "edges", "floor", "room", "height", "spacing", "from_walls"});
  const std::string kind = one_of(table, {"points", "file", "corner", "floor", "room"});
  if (kind == "floor" || kind == "room") return floor_grid_of(table, frame, name, kind);
  require_absent(table, {"height", "from_walls"}, kind);
  if (kind != "corner") require_absent(table, {"edges", "spacing"}, kind);
  SensorGroup group;
  if (kind == "points") group = points_of(*find(table, kind), frame);
  if (kind == "corner") group = rectangle_of(table, frame);
  if (kind == "file") group = points_in(*find(table, kind), frame);
  group.name = name;
  if (group.file.empty()) group.file = frame.file.string();
  if (group.lines.empty()) group.lines = {line_of(table.where)};
  return group;
}

std::string where_of(const FloorGrid& grid) { return grid.file + ":" + std::to_string(grid.line); }

GridSize size_of(const Floor& floor, const FloorGrid& grid) {
  if (grid.spacing && grid.from_walls) return {*grid.spacing, *grid.from_walls};
  const GridSize standard = standard_grid(floor);
  return {grid.spacing.value_or(standard.spacing), grid.from_walls.value_or(standard.from_walls)};
}

bool is_in(const std::vector<Solid>& solids, const Point& point) {
  return std::any_of(solids.begin(), solids.end(),
                     [&](const Solid& solid) { return solid.box.contains(point) && holds(solid, point); });
}

template <class Predicate>
SensorGroup without(const SensorGroup& group, const Predicate& is_left_out) {
  SensorGroup rest = group;
  rest.sensors.clear();
  rest.cells.clear();
  for (std::size_t k = 0; k < group.sensors.size(); ++k) {
    if (is_left_out(group.sensors[k].point)) continue;
    rest.sensors.push_back(group.sensors[k]);
    rest.cells.push_back(group.cells[k]);
  }
  return rest;
}

// The area of a floor without a strip along its boundary, m^2, sampled by 100 x 100 cells of its bounding rectangle.
double area_beyond_strip(const Floor& floor, double from_walls) {
  const auto [corner, x, y] = rectangle_over(floor, 0);
  return area_of(floor_grid(floor, 0, {std::max(x.norm(), y.norm()) / 100, from_walls}));
}

// The fraction of the floor without the strip that the remaining cells cover.
double share_of(const SensorGroup& rest, const Floor& floor, double from_walls) {
  const double whole = area_beyond_strip(floor, from_walls);
  return whole > 0 ? std::min(1.0, area_of(rest) / whole) : 1;
}

// Adds a note on a grid that covers only a part of its floor.
void note_share(LeftOut& notes, const FloorGrid& grid, const std::string& floor, double share) {
  if (share >= 0.9) return;
  notes.add("sensors '" + grid.name +
                "' cover a part of the floor only, as a roof or a solid takes the rest; floor and share",
            floor + " " + rounded(100 * share, 2) + " %", DiagnosticCode::missing_sensors);
}

std::vector<PolygonIndex> polygons_of_group(const Scene& scene, const FloorGrid& grid) {
  std::vector<PolygonIndex> polygons;
  std::set<std::string> names;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const std::string name = group_name(scene, scene.polygons[p].group);
    names.insert(name);
    if (matches(name, grid.group)) polygons.push_back(p);
  }
  if (!polygons.empty()) return polygons;
  const std::vector<std::string> allowed(names.begin(), names.end());
  throw InputError(where_of(grid), "sensors.floor: no face is of a group '" + grid.group + "'" +
                                       suggestion(grid.group, allowed) + " The groups are " + listed(allowed));
}

FloorSensors over_floor(const Scene& scene, const FloorGrid& grid) {
  const std::vector<Solid> solids = dark_solids(scene);
  const Floor floor = floor_of_polygons(scene, polygons_of_group(scene, grid), solids);
  if (floor.outlines.empty())
    throw InputError(where_of(grid), "sensors.floor: no face of '" + grid.group + "' is level");
  GridInAir over = grid_over(floor, grid, solids);
  if (over.group.sensors.empty())
    throw InputError(
        where_of(grid),
        "sensors.spacing: no grid point is above the floor" +
            (grid.from_walls > 0 ? " and " + rounded(*grid.from_walls) + " m from its edges" : std::string()) +
            "\nhint: reduce spacing or from_walls");
  LeftOut notes;
  note_share(notes, grid, grid.group, over.share);
  return {{std::move(over.group)}, notes.on({}).diagnostics};
}

bool is_meant(const NamedRoom& room, const FloorGrid& grid) {
  return std::any_of(grid.rooms.begin(), grid.rooms.end(),
                     [&](const std::string& pattern) { return matches(room.name, pattern); });
}

void require_known_rooms(const Scene& scene, const FloorGrid& grid) {
  if (scene.rooms.empty())
    throw InputError(where_of(grid),
                     "sensors.room: the models name no rooms (IfcSpace); expected floor = \"GROUP\" instead");
  std::vector<std::string> names;
  for (const NamedRoom& room : scene.rooms) names.push_back(room.name);
  for (const std::string& pattern : grid.rooms) {
    const bool is_known =
        std::any_of(names.begin(), names.end(), [&](const std::string& name) { return matches(name, pattern); });
    if (!is_known)
      throw InputError(where_of(grid), "sensors.room: no room is called '" + pattern + "'" +
                                           suggestion(pattern, names) + "\nhint: the rooms are " + listed(names));
  }
}

GridInAir grid_over_room(const NamedRoom& room, const FloorGrid& grid, const std::vector<Solid>& solids,
                         const Vector& up) {
  const Floor floor = floor_of_room(room.faces, up);
  if (floor.outlines.empty()) return {};
  GridInAir over = grid_over(floor, grid, solids);
  // A closed room without light is itself a dark solid. Its sensors read 0.
  if (over.group.sensors.empty()) over = grid_over(floor, grid, {});
  const double area = area_of(over.group);
  over.group = in_room(std::move(over.group), room);
  if (area > 0) over.share *= area_of(over.group) / area;
  return over;
}

double height_of(const NamedRoom& room, const Vector& up) {
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (const std::vector<Point>& face : room.faces) {
    for (const Point& corner : face) {
      lowest = std::min(lowest, up.dot(corner));
      highest = std::max(highest, up.dot(corner));
    }
  }
  return highest - lowest;
}

// The selected rooms, each with its own grid.
FloorSensors over_rooms(const Scene& scene, const FloorGrid& grid) {
  require_known_rooms(scene, grid);
  const std::vector<Solid> solids = dark_solids(scene);
  std::vector<SensorGroup> groups;
  LeftOut notes;
  for (const NamedRoom& room : scene.rooms) {
    if (!is_meant(room, grid)) continue;
    GridInAir over = grid_over_room(room, grid, solids, scene.up);
    if (over.group.sensors.empty()) {
      notes.add("rooms without sensors of '" + grid.name + "', as their floors have no free, level place " +
                    (grid.from_walls ? rounded(*grid.from_walls) + " m from the walls" : "that is wide enough"),
                room.name, DiagnosticCode::missing_sensors);
      continue;
    }
    note_share(notes, grid, room.name, over.share);
    if (const double height = height_of(room, scene.up); grid.height >= height)
      notes.add("sensors '" + grid.name + "' lie " + rounded(grid.height) + " m above the floor, over the ceiling of",
                room.name + " (" + rounded(height) + " m high)", DiagnosticCode::doubtful_sensor);
    over.group.name = grid.rooms == std::vector{room.name} ? grid.name : grid.name + " " + room.name;
    groups.push_back(std::move(over.group));
  }
  if (groups.empty())
    throw InputError(where_of(grid), "sensors.spacing: no cell of these rooms has its middle in the air" +
                                         (grid.from_walls ? ", " + rounded(*grid.from_walls) + " m from the walls;"
                                                          : std::string(";")) +
                                         " expected a smaller from_walls or spacing");
  return {std::move(groups), notes.on({}).diagnostics};
}

}  // namespace

std::vector<std::variant<SensorGroup, FloorGrid>> sensors_of(const TomlValue& root, const TomlFrame& frame) {
  std::vector<std::variant<SensorGroup, FloorGrid>> all;
  std::set<std::string> names;
  for (const TomlValue& table : tables(find(root, "sensors"))) {
    const TomlValue* const given = find(table, "name");
    const std::string name = given ? text(*given) : "sensors " + std::to_string(all.size() + 1);
    all.push_back(sensors_of_table(table, frame, name));
    if (!names.insert(name).second) refuse(given ? *given : table, "a name that no other sensors have");
  }
  return all;
}

std::vector<std::filesystem::path> sensor_files(const TomlValue& root, const TomlFrame& frame) {
  std::vector<std::filesystem::path> files;
  for (const TomlValue& table : tables(find(root, "sensors"))) {
    if (const TomlValue* const file = find(table, "file")) files.push_back(named_file(*file, frame));
  }
  return files;
}

Floor floor_of_polygons(const Scene& scene, const std::vector<PolygonIndex>& polygons,
                        const std::vector<Solid>& solids) {
  const double extent = extent_of(scene);
  std::vector<PolygonIndex> open;
  for (const PolygonIndex p : polygons) {
    const Side upper = front_normal(scene, p).dot(scene.up) > 0 ? Side::front : Side::back;
    if (!is_in(solids, point_before(scene, p, upper, extent))) open.push_back(p);
  }
  return floor_of(outlines_of(scene, open), scene.up);
}

GridInAir grid_over(const Floor& floor, const FloorGrid& grid, const std::vector<Solid>& solids) {
  const GridSize size = size_of(floor, grid);
  const double cells = most_cells(floor, size);
  if (!(cells <= most_sensors)) refuse_spacing(where_of(grid), std::min(cells, 1e18));
  SensorGroup group =
      without(floor_grid(floor, grid.height, size), [&](const Point& point) { return is_in(solids, point); });
  group.name = grid.name;
  group.file = grid.file;
  group.lines = {grid.line};
  const double share = share_of(group, floor, size.from_walls);
  return {std::move(group), share};
}

SensorGroup in_room(SensorGroup group, const NamedRoom& room) {
  const RoomBody body(room.faces);
  SensorGroup inside = without(group, [&](const Point& point) { return !body.holds(point); });
  return inside.sensors.empty() ? group : inside;
}

FloorSensors sensors_over(const Scene& scene, const FloorGrid& grid) {
  return grid.rooms.empty() ? over_floor(scene, grid) : over_rooms(scene, grid);
}

}  // namespace patchlight
