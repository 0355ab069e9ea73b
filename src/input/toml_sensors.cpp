#include "input/toml_sensors.h"

#include "patchlight/base/error.h"

#include "base/near_match.h"
#include "base/rounded.h"
#include "input/material_settings.h"
#include "input/read_points.h"
#include "input/text.h"
#include "scene/room_body.h"
#include "scene/sensor_grid.h"

#include <algorithm>
#include <charconv>
#include <set>

namespace patchlight {
namespace {

std::uint32_t line_of(const std::string& where) {
  const std::size_t colon = where.rfind(':');
  std::uint32_t line = 0;
  std::from_chars(where.data() + colon + 1, where.data() + where.size(), line);
  return line;
}

[[noreturn]] void refuse_spacing(const std::string& where, double cells) {
  throw InputError(where, "sensors.spacing: found a grid of " + std::to_string(static_cast<std::uint64_t>(cells)) +
                              " cells; expected at most " + std::to_string(static_cast<std::uint64_t>(most_sensors)) +
                              ". Give a larger spacing");
}

// The two edges from a corner, in metres, and the spacing: a grid that is not too fine.
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

// Keys that go with another one only.
void require_absent(const TomlValue& table, const std::vector<std::string>& keys, const std::string& kind) {
  for (const std::string& key : keys) {
    const TomlValue* const value = find(table, key);
    if (value == nullptr) continue;
    throw InputError(value->where, value->name + " says nothing about sensors given by '" + kind + "'; leave it out");
  }
}

std::variant<SensorGroup, FloorGrid> sensors_of_table(const TomlValue& table, const TomlFrame& frame,
                                                      const std::string& name) {
  allow_keys(table, {"name", "points", "file", "corner", "edges", "floor", "room", "height", "spacing", "from_walls"});
  const std::string kind = one_of(table, {"points", "file", "corner", "floor", "room"});
  if (kind == "floor" || kind == "room") {
    require_absent(table, {"edges"}, kind);
    const TomlValue& floor = *find(table, kind);
    const std::string named = text(floor, kind == "floor" ? "the name of polygon groups, or a pattern with * and ?"
                                                          : "the name of rooms, or a pattern with * and ?");
    const TomlValue* const from_walls = find(table, "from_walls");
    const double usual_distance = kind == "room" ? 0.5 : 0;  // metres
    const double height = not_negative(required(table, "height", "the height above the floor"));
    const double spacing = positive(required(table, "spacing", "the length of a cell"));
    FloorGrid grid;
    grid.name = name;
    (kind == "floor" ? grid.group : grid.room) = named;
    grid.height = frame.metres_per_unit * height;
    grid.spacing = frame.metres_per_unit * spacing;
    grid.from_walls = from_walls ? frame.metres_per_unit * not_negative(*from_walls) : usual_distance;
    grid.file = frame.file.string();
    grid.line = line_of(floor.where);
    return grid;
  }
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

namespace {

SensorGroup grid_over(const Floor& floor, const FloorGrid& grid, const std::string& where) {
  const auto [corner, x, y] = rectangle_over(floor, grid.height);
  require_sensible(where, {x, y}, grid.spacing);
  SensorGroup group = floor_grid(floor, grid.height, grid.spacing, grid.from_walls);
  group.name = grid.name;
  group.file = grid.file;
  group.lines = {grid.line};
  return group;
}

std::vector<SensorGroup> over_floor(const Scene& scene, const FloorGrid& grid, const std::string& where) {
  std::vector<PolygonIndex> polygons;
  std::set<std::string> names;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const std::string name = group_name(scene, scene.polygons[p].group);
    names.insert(name);
    if (name == grid.group || matches(name, grid.group)) polygons.push_back(p);
  }
  if (polygons.empty()) {
    const std::vector<std::string> allowed(names.begin(), names.end());
    throw InputError(where, "sensors.floor: no face is of a group '" + grid.group + "'" +
                                suggestion(grid.group, allowed) + " The groups are " + listed(allowed));
  }
  const Floor floor = floor_of(outlines_of(scene, polygons), scene.up);
  if (floor.outlines.empty()) throw InputError(where, "sensors.floor: no face of '" + grid.group + "' is level");
  SensorGroup group = grid_over(floor, grid, where);
  if (group.sensors.empty())
    throw InputError(where, "sensors.spacing: no cell has its middle over the floor" +
                                (grid.from_walls > 0 ? ", " + rounded(grid.from_walls) + " m from its rim" : ""));
  return {group};
}

// Without sensors above a sloping roof or in a nook of another room. A room that is not closed has no inside: all stay.
SensorGroup within(SensorGroup group, const RoomBody& body) {
  SensorGroup inside = group;
  inside.sensors.clear();
  inside.cells.clear();
  for (std::size_t k = 0; k < group.sensors.size(); ++k) {
    if (!body.holds(group.sensors[k].point)) continue;
    inside.sensors.push_back(group.sensors[k]);
    inside.cells.push_back(group.cells[k]);
  }
  return inside.sensors.empty() ? group : inside;
}

// The rooms that a pattern means, each with a grid of its own; those too narrow for one have none.
FloorSensors over_rooms(const Scene& scene, const FloorGrid& grid, const std::string& where) {
  std::vector<SensorGroup> groups;
  std::string narrow;
  std::vector<std::string> names;
  bool found = false;
  for (const NamedRoom& room : scene.rooms) {
    names.push_back(room.name);
    if (room.name != grid.room && !matches(room.name, grid.room)) continue;
    found = true;
    const Floor floor = floor_of(room.faces, scene.up);
    SensorGroup group = floor.outlines.empty() ? SensorGroup() : grid_over(floor, grid, where);
    if (group.sensors.empty()) {
      narrow += (narrow.empty() ? "" : ", ") + room.name;
      continue;
    }
    group = within(std::move(group), RoomBody(room.faces));
    group.name = names.back() == grid.room ? grid.name : grid.name + " " + room.name;
    groups.push_back(std::move(group));
  }
  if (names.empty())
    throw InputError(where, "sensors.room: the models name no rooms (IfcSpace); expected floor = \"GROUP\" instead");
  if (!found)
    throw InputError(where, "sensors.room: no room is called '" + grid.room + "'" + suggestion(grid.room, names) +
                                " The rooms are " + listed(names));
  if (groups.empty())
    throw InputError(where, "sensors.spacing: no cell of these rooms has its middle " + rounded(grid.from_walls) +
                                " m from the walls; expected a smaller from_walls or spacing");
  if (narrow.empty()) return {std::move(groups), {}};
  return {std::move(groups), "rooms without sensors of '" + grid.name + "', as no place over their floor is " +
                                 rounded(grid.from_walls) + " m from the walls: " + narrow};
}

}  // namespace

FloorSensors sensors_over(const Scene& scene, const FloorGrid& grid) {
  const std::string where = grid.file + ":" + std::to_string(grid.line);
  if (!grid.room.empty()) return over_rooms(scene, grid, where);
  return {over_floor(scene, grid, where), {}};
}

}  // namespace patchlight
