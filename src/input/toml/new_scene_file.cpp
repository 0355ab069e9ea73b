#include "input/toml/new_scene_file.h"

#include "patchlight/base/geometry.h"

#include "base/words.h"
#include "input/materials.h"
#include "input/toml/toml_sensors.h"
#include "input/toml/toml_value.h"
#include "scene/room_body.h"
#include "scene/solids.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <sstream>
#include <utility>

namespace patchlight {
namespace {

// Quotes a text for TOML; control characters become question marks.
std::string toml_text(const std::string& text) {
  std::string result = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') result += '\\';
    const bool is_control = static_cast<unsigned char>(letter) < 0x20 || letter == 0x7f;
    result += is_control ? '?' : letter;
  }
  return result + "\"";
}

// A point as a TOML list, e.g. "[1, 2.5, 0]", rounded to 0.001.
std::string toml_text(const Point& point) {
  std::string text = "[";
  for (const double value : point)
    text += (text.size() > 1 ? ", " : "") + shortest(std::round(1000 * value) / 1000 + 0.0);
  return text + "]";
}

constexpr std::size_t most_named = 12;  // rooms, in lists and with lamps
constexpr double lowest_room = 1.8;     // meters, least clear height above a floor

// Floors of at least 2 m^2.
std::vector<NamedFloor> largest_first(std::vector<NamedFloor> places) {
  std::erase_if(places, [](const NamedFloor& place) { return area_of(place.floor) < 2; });
  std::stable_sort(places.begin(), places.end(),
                   [](const NamedFloor& a, const NamedFloor& b) { return area_of(a.floor) > area_of(b.floor); });
  return places;
}

// The highest coordinate of the scene along its vertical axis.
double top_of(const Scene& scene) {
  double top = -std::numeric_limits<double>::infinity();
  for (const Point& vertex : scene.vertices) top = std::max(top, vertex.dot(scene.up));
  return top;
}

// True if a part of the scene is above the floor, high enough to stand. Roof terraces fail.
bool is_under_something(const Floor& floor, double top) {
  return !floor.outlines.empty() && floor.outlines[0][0].dot(floor.up) + lowest_room <= top;
}

std::vector<NamedFloor> floors_of_rooms(const Scene& scene) {
  const double top = top_of(scene);
  const std::vector<double> windows = window_areas(scene);
  std::vector<NamedFloor> places;
  for (std::size_t k = 0; k < scene.rooms.size(); ++k) {
    Floor floor = floor_of_room(scene.rooms[k].faces, scene.up);
    if (is_under_something(floor, top)) places.push_back({scene.rooms[k].name, std::move(floor), windows[k]});
  }
  return largest_first(std::move(places));
}

// Named groups with a floor that has a part of the scene high above it.
std::vector<NamedFloor> floors_of_groups(const Scene& scene) {
  std::vector<std::vector<PolygonIndex>> of_group(scene.groups.size());
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) of_group[scene.polygons[p].group].push_back(p);
  const double top = top_of(scene);
  const std::vector<Solid> solids = dark_solids(scene);
  std::vector<NamedFloor> places;
  for (std::uint32_t group = 0; group < of_group.size(); ++group) {
    if (group_name(scene, group).empty()) continue;
    Floor floor = floor_of_polygons(scene, of_group[group], solids);
    if (is_under_something(floor, top)) places.push_back({group_name(scene, group), std::move(floor), 0});
  }
  return largest_first(std::move(places));
}

std::string unit_name(double metres_per_unit) {
  for (const auto& [name, length] : units) {
    if (metres_per_unit == length) return name;
  }
  return "m";
}

std::string model_tables(const Scene& scene, const std::vector<std::filesystem::path>& models,
                         std::optional<double> metres_per_unit, const std::filesystem::path& file) {
  std::set<std::string> classes;
  for (std::uint32_t group = 0; group < scene.groups.size(); ++group) {
    const std::string name = group_name(scene, group);
    const std::size_t end = name.find('_');
    if (name.starts_with("Ifc") && end != std::string::npos) classes.insert(name.substr(0, end) + "_*");
  }
  const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
  std::ostringstream text;
  for (const std::filesystem::path& model : models) {
    const std::filesystem::path absolute = std::filesystem::absolute(model);
    const std::filesystem::path relative = absolute.lexically_relative(folder);
    const bool is_near = !relative.empty() && *relative.begin() != "..";
    text << "[[model]]\nfile = " << toml_text((is_near ? relative : absolute).string()) << '\n';
    if (metres_per_unit) text << "unit = " << toml_text(unit_name(*metres_per_unit)) << '\n';
    text << "# Objects, groups or materials to leave out, by name or pattern:\n# leave_out = [";
    std::string list;
    for (const std::string& name : classes) {
      const bool is_loose = name.find("Furnish") != std::string::npos || name.find("Flow") != std::string::npos ||
                            name.find("Member") != std::string::npos || name.find("Railing") != std::string::npos;
      if (is_loose) list += (list.empty() ? "" : ", ") + toml_text(name);
    }
    text << (list.empty() ? "\"chairs*\"" : list) << "]\n\n";
  }
  return text.str();
}

std::string spectrum_text(const Spectrum& spectrum) {
  const std::string values = listed_shares(spectrum);
  return values.find(',') == std::string::npos ? values : "[" + values + "]";
}

// Commented out, with the values that the model already has.
std::string material_tables(const Scene& scene) {
  std::ostringstream text;
  for (const Material& material : scene.materials) {
    if (material.second_face || !(material.transmittance > 0).any()) continue;
    text << "# [[material]]\n# name = " << toml_text(material.name)
         << "\n# transmittance = " << spectrum_text(material.transmittance)
         << "  # clear, at normal incidence; 0 makes it opaque\n"
         << "# reflectance = " << spectrum_text(material.reflectance)
         << "  # diffuse\n# index = " << shortest(material.index) << "\n\n";
  }
  if (!text.str().empty()) return "# Glazing of the model. Uncomment and edit a table to change it.\n" + text.str();
  return "# No material is transparent. To let daylight through a window:\n# [[material]]\n# name = \"Glass*\"\n"
         "# transmittance = 0.8\n# reflectance = 0\n\n";
}

// A point over the middle of a floor, at the least clear height.
std::optional<Point> place_over(const Floor& floor) {
  const SensorGroup grid = floor_grid(floor, lowest_room, {std::sqrt(area_of(floor)) / 10, 0});
  Point middle = Point::Zero();
  for (const Sensor& sensor : grid.sensors) middle += sensor.point / static_cast<double>(grid.sensors.size());
  const auto nearest = std::min_element(grid.sensors.begin(), grid.sensors.end(), [&](const auto& a, const auto& b) {
    return (a.point - middle).squaredNorm() < (b.point - middle).squaredNorm();
  });
  return nearest == grid.sensors.end() ? std::nullopt : std::optional(nearest->point);
}

// A lamp in each of the largest named rooms.
NewLight lamps_in_rooms(const Scene& scene) {
  NewLight light{true, {}, {}};
  for (const NamedRoom& room : scene.rooms) light.rooms_without.push_back(room.name);
  for (const NamedFloor& place : floors_of_rooms(scene)) {
    if (light.lamps.size() == most_named) break;
    const std::optional<Point> lamp = place_over(place.floor);
    if (!lamp) continue;
    light.lamps.push_back(*lamp);
    light.rooms_without.erase(std::find(light.rooms_without.begin(), light.rooms_without.end(), place.name));
  }
  return light;
}

// "# No lamp in: "store", "attic" and 3 more."; empty without rooms.
std::string names_line(const std::string& what, const std::vector<std::string>& rooms) {
  if (rooms.empty()) return {};
  std::vector<std::string> names;
  for (const std::string& room : rooms) names.push_back(toml_text(room));
  return "# " + what + ": " + first_few(names, most_named) + ".\n";
}

// Commented out if no place for a lamp was found.
std::string luminaire_table(const NewLight& light) {
  const std::string positions = listed_as(light.lamps, [](const Point& lamp) { return toml_text(lamp); });
  const bool is_known = !positions.empty();
  const std::string mark = is_known ? "" : "# ";
  return std::string("# The model has neither lamp nor window, so this lamp lights it, evenly in all directions") +
         (is_known ? ".\n" : ";\n# no place for it was found.\n") + names_line("No lamp in", light.rooms_without) +
         mark + "[[luminaire]]\n" + mark + "name = \"lamp\"\n" + mark +
         "kind = \"point\"    # or \"spot\", \"ies\", \"sphere\"\n" + mark + "positions = [" +
         (is_known ? positions : "[X, Y, Z]") + "]\n" + mark + "lumens = 3000\n\n";
}

// A sky that is the only light is active, otherwise it is commented out.
std::string sky_tables(const Scene& scene, bool is_only_light) {
  const std::string mark = is_only_light ? "" : "# ";
  const std::string why = is_only_light ? "# The model has no lamp, so the sky lights it; the ground reflects 20 %.\n"
                          : has_lamp(scene) ? "# The model has lamps. To add daylight:\n"
                                            : "# Daylight, if a material above lets it in:\n";
  return why + mark + "[sky]\n" + mark + "kind = \"overcast\"   # or \"uniform\", or \"clear\" with a sun\n" + mark +
         "illuminance = 10000  # lx, horizontal, under the open sky\n\n" + mark + "[ground]\n" + mark +
         "reflectance = 0.2\n\n" +
         "# [sun]\n# time = 2024-06-21T12:00:00Z\n# illuminance = 80000  # lx, direct normal\n# [site]\n"
         "# latitude = 52.5\n# longitude = 13.4\n\n";
}

std::string light_tables(const Scene& scene, const NewLight& light) {
  if (light.is_sealed) return luminaire_table(light) + sky_tables(scene, false);
  return sky_tables(scene, !has_lamp(scene));
}

// All rooms, or those with a place for sensors.
std::string rooms_text(const FloorGrid& grid) {
  if (grid.rooms.size() == 1) return toml_text(grid.rooms[0]);
  std::string list;
  for (const std::string& room : grid.rooms) list += "  " + toml_text(room) + ",\n";
  return "[\n" + list + "]";
}

std::string sensor_tables(const Scene& scene, const NewPlaces& places) {
  if (!scene.sensors.empty()) return "# The model has sensors of its own.\n\n";
  std::string text = names_line("No sensors in", places.rooms_without);
  const std::string mark = places.grid ? "" : "# ";
  const FloorGrid grid = places.grid.value_or(FloorGrid{"work plane", "FLOOR", {}, 0.8, {}, {}, {}, 0});
  if (!places.grid) text += "# No closed room was found. A sensor grid over a group of faces:\n";
  text += mark + "[[sensors]]\n" + mark + "name = " + toml_text(grid.name) + '\n' + mark +
          (grid.rooms.empty() ? "floor = " + toml_text(grid.group) : "room = " + rooms_text(grid)) + '\n' + mark +
          "height = " + shortest(grid.height) + "      # meters above the floor\n" +
          "# spacing = 0.5   # meters; default: EN 12464-1, by the size of the room\n" + mark +
          (grid.rooms.empty() ? "from_walls = 0.5\n\n" : "# from_walls = 0.5\n\n");
  return text;
}

std::string camera_tables(const std::vector<Camera>& cameras) {
  std::ostringstream text;
  if (!cameras.empty()) text << "# Views for --view NAME, in the rooms with the largest windows or floors.\n";
  for (const Camera& camera : cameras) {
    text << "[[camera]]\nname = " << toml_text(camera.name) << "\neye = " << toml_text(camera.eye)
         << "\ntarget = " << toml_text(camera.target) << "\nfield_of_view = " << shortest(camera.vertical_field_of_view)
         << "  # degrees, vertical\n\n";
  }
  return text.str();
}

}  // namespace

std::vector<NamedFloor> named_floors(const Scene& scene) {
  return scene.rooms.empty() ? floors_of_groups(scene) : floors_of_rooms(scene);
}

NewLight new_light(const Scene& scene) {
  if (has_lamp(scene)) return {};
  const std::optional<Solid> hull = sealed_hull(scene);
  if (!hull || !is_room(scene, *hull)) return {};
  NewLight light = lamps_in_rooms(scene);
  if (!light.lamps.empty()) return light;
  const std::optional<Point> lamp = place_under_ceiling(scene, *hull);
  return {true, lamp ? std::vector<Point>{*lamp} : std::vector<Point>{}, {}};
}

Scene with_new_light(Scene scene, const NewLight& light) {
  if (has_lamp(scene)) return scene;
  for (const Point& lamp : light.lamps) {
    scene.luminaires.emplace_back();
    scene.luminaires.back().position = lamp;
  }
  if (!light.is_sealed) scene.sky = Sky{};
  return scene;
}

std::string new_scene_file(const Scene& scene, const NewLight& light, const NewPlaces& places,
                           const std::vector<std::filesystem::path>& models, std::optional<double> metres_per_unit,
                           const std::filesystem::path& file) {
  std::ostringstream text;
  text << "# A scene for patchlight. `patchlight help scene-file` lists all keys. Lengths are in meters.\n"
       << "# patchlight check " << file.filename().string() << "\n# patchlight solve " << file.filename().string()
       << " -o result.vtp --json result.json --picture result.png\n\n"
       << "up = " << (std::abs(scene.up.y()) > 0.5 ? "\"y\"" : "\"z\"") << "\n\n";
  text << model_tables(scene, models, metres_per_unit, file) << material_tables(scene) << light_tables(scene, light)
       << sensor_tables(scene, places) << camera_tables(places.cameras);
  return text.str();
}

}  // namespace patchlight
