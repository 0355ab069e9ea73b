#include "input/new_scene_file.h"

#include "base/rounded.h"
#include "base/shortest.h"
#include "input/materials.h"
#include "input/new_cameras.h"
#include "input/toml_text.h"
#include "input/toml_value.h"
#include "scene/sealed_room.h"
#include "scene/sensor_grid.h"
#include "scene/window_areas.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

namespace patchlight {
namespace {

constexpr std::size_t most_named = 12;
constexpr double smallest_room = 2;  // m^2
constexpr double lowest_room = 1.8;  // metres: so much is free over a floor

std::vector<NamedFloor> largest_first(std::vector<NamedFloor> places) {
  std::erase_if(places, [](const NamedFloor& place) { return area_of(place.floor) < smallest_room; });
  std::stable_sort(places.begin(), places.end(),
                   [](const NamedFloor& a, const NamedFloor& b) { return area_of(a.floor) > area_of(b.floor); });
  return places;
}

// What of the scene is highest, along its upright axis.
double top_of(const Scene& scene) {
  double top = -std::numeric_limits<double>::infinity();
  for (const Point& vertex : scene.vertices) top = std::max(top, vertex.dot(scene.up));
  return top;
}

// Has it a height above the floor that one can stand in? A space on a roof has not.
bool is_under_something(const Floor& floor, double top) {
  return !floor.outlines.empty() && floor.outlines[0][0].dot(floor.up) + lowest_room <= top;
}

std::vector<NamedFloor> rooms_of(const Scene& scene) {
  const double top = top_of(scene);
  const std::vector<double> windows = window_areas(scene);
  std::vector<NamedFloor> places;
  for (std::size_t k = 0; k < scene.rooms.size(); ++k) {
    Floor floor = floor_of(scene.rooms[k].faces, scene.up);
    if (is_under_something(floor, top)) places.push_back({scene.rooms[k].name, std::move(floor), windows[k]});
  }
  return largest_first(std::move(places));
}

// Groups with a name, whose floor has something of the scene high over it.
std::vector<NamedFloor> floors_of_groups(const Scene& scene) {
  std::vector<std::vector<PolygonIndex>> of_group(scene.groups.size());
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) of_group[scene.polygons[p].group].push_back(p);
  const double top = top_of(scene);
  std::vector<NamedFloor> places;
  for (std::uint32_t group = 0; group < of_group.size(); ++group) {
    if (group_name(scene, group).empty()) continue;
    Floor floor = floor_of(outlines_of(scene, of_group[group]), scene.up);
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
    text << "# What does not take part: names or patterns of objects, groups or materials.\n# leave_out = [";
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

// Commented out: it says what is so without it.
std::string material_tables(const Scene& scene) {
  std::ostringstream text;
  for (const Material& material : scene.materials) {
    if (material.second_face || !(material.transmittance > 0).any()) continue;
    text << "# [[material]]\n# name = " << toml_text(material.name)
         << "\n# transmittance = " << spectrum_text(material.transmittance)
         << "  # straight through, at right angles; 0 makes it opaque\n"
         << "# reflectance = " << spectrum_text(material.reflectance)
         << "  # diffuse\n# index = " << shortest(material.index) << "\n\n";
  }
  if (!text.str().empty()) return "# Glass, as the model has it. What is changed here counts.\n" + text.str();
  return "# No material is clear. A window lets light in with:\n# [[material]]\n# name = \"Glass*\"\n"
         "# transmittance = 0.8\n# reflectance = 0\n\n";
}

// Over the middle of a floor, as high as is free at least.
std::optional<Point> place_over(const Floor& floor) {
  const SensorGroup grid = floor_grid(floor, lowest_room, std::sqrt(area_of(floor)) / 10, 0);
  Point middle = Point::Zero();
  for (const Sensor& sensor : grid.sensors) middle += sensor.point / static_cast<double>(grid.sensors.size());
  const auto nearest = std::min_element(grid.sensors.begin(), grid.sensors.end(), [&](const auto& a, const auto& b) {
    return (a.point - middle).squaredNorm() < (b.point - middle).squaredNorm();
  });
  return nearest == grid.sensors.end() ? std::nullopt : std::optional(nearest->point);
}

struct LampPlaces {
  std::vector<Point> points;
  std::vector<std::string> rooms_without;  // names, in the scene's order; empty where no room has a lamp of its own
};

// In each of the largest named rooms, else under the ceiling, where that has room below.
LampPlaces places_of_lamps(const Scene& scene, const Solid& hull, const std::vector<NamedFloor>& places) {
  LampPlaces lamps;
  if (!scene.rooms.empty()) {
    for (const NamedRoom& room : scene.rooms) lamps.rooms_without.push_back(room.name);
    for (const NamedFloor& place : places) {
      if (lamps.points.size() == most_named) break;
      const std::optional<Point> lamp = place_over(place.floor);
      if (!lamp) continue;
      lamps.points.push_back(*lamp);
      lamps.rooms_without.erase(std::find(lamps.rooms_without.begin(), lamps.rooms_without.end(), place.name));
    }
  }
  if (!lamps.points.empty()) return lamps;
  const std::optional<Point> lamp = place_under_ceiling(scene, hull);
  return {lamp ? std::vector<Point>{*lamp} : std::vector<Point>{}, {}};
}

// "# No lamp stands in: "store", "attic" and 3 more.", or nothing.
std::string unlit_line(const std::vector<std::string>& rooms) {
  if (rooms.empty()) return {};
  std::string list;
  for (std::size_t k = 0; k < std::min(rooms.size(), most_named); ++k)
    list += (list.empty() ? "" : ", ") + toml_text(rooms[k]);
  if (rooms.size() > most_named) list += " and " + std::to_string(rooms.size() - most_named) + " more";
  return "# No lamp stands in: " + list + ".\n";
}

// Commented out where no place for a lamp is known.
std::string luminaire_table(const Scene& scene, const Solid& hull, const std::vector<NamedFloor>& places) {
  const LampPlaces lamps = places_of_lamps(scene, hull, places);
  std::string positions;
  for (const Point& lamp : lamps.points) positions += (positions.empty() ? "" : ", ") + toml_text(lamp);
  const bool is_known = !positions.empty();
  const std::string mark = is_known ? "" : "# ";
  return std::string("# Nothing in the model shines, and no daylight gets in: a lamp that shines all around") +
         (is_known ? ".\n" : ",\n# for which no place was found.\n") + unlit_line(lamps.rooms_without) + mark +
         "[[luminaire]]\n" + mark + "name = \"lamp\"\n" + mark +
         "kind = \"point\"    # or \"spot\", \"ies\", \"sphere\"\n" + mark + "positions = [" +
         (is_known ? positions : "[X, Y, Z]") + "]\n" + mark + "lumens = 3000\n\n";
}

// A sky as the only light is not commented out.
std::string sky_tables(const Scene& scene, bool is_only_light) {
  const std::string mark = is_only_light ? "" : "# ";
  const std::string why = is_only_light
                              ? "# Nothing in the model shines: a sky, over a ground that reflects a fifth of it.\n"
                          : has_lamp(scene) ? "# The model has lamps. With daylight as well:\n"
                                            : "# Daylight, where a material above lets it in:\n";
  return why + mark + "[sky]\n" + mark + "kind = \"overcast\"   # or \"uniform\", or \"clear\" with a sun\n" + mark +
         "illuminance = 10000  # lx on the open ground\n\n" + mark + "[ground]\n" + mark + "reflectance = 0.2\n\n" +
         "# [sun]\n# time = 2024-06-21T12:00:00Z\n# illuminance = 80000  # lx across its rays\n# [site]\n"
         "# latitude = 52.5\n# longitude = 13.4\n\n";
}

// What nothing in the model gives: a luminaire in a room that no daylight gets into, else a sky.
std::string light_tables(const Scene& scene, const std::vector<NamedFloor>& places) {
  if (has_lamp(scene)) return sky_tables(scene, false);
  const std::optional<Solid> hull = sealed_hull(scene);
  if (!hull || !is_room(scene, *hull)) return sky_tables(scene, true);
  return luminaire_table(scene, *hull, places) + sky_tables(scene, false);
}

constexpr double usual_spacing = 0.5;  // m

// By the usual spacing.
double cells_over(const Floor& floor) {
  if (floor.outlines.empty()) return 0;
  const auto [corner, x, y] = rectangle_over(floor, 0);
  return cells_along(x.norm(), usual_spacing) * cells_along(y.norm(), usual_spacing);
}

// Half a metre; where the grids would have more than 20,000 cells so, as many metres as leave about that many.
double spacing_for(const Scene& scene, const std::vector<NamedFloor>& places) {
  constexpr double most_cells = 2e4;
  double cells = scene.rooms.empty() && !places.empty() ? cells_over(places[0].floor) : 0;
  for (const NamedRoom& room : scene.rooms) cells += cells_over(floor_of(room.faces, scene.up));
  return cells <= most_cells ? usual_spacing : std::ceil(10 * usual_spacing * std::sqrt(cells / most_cells)) / 10;
}

std::string sensor_tables(const Scene& scene, const std::vector<NamedFloor>& places) {
  if (!scene.sensors.empty()) return "# The model has sensors of its own.\n\n";
  std::ostringstream text;
  const std::string rest =
      "height = 0.8      # metres above the floor\nspacing = " + shortest(spacing_for(scene, places)) +
      "\nfrom_walls = 0.5\n\n";
  if (!scene.rooms.empty()) {
    text
        << "# A grid over the floor of every room; results are told room by room.\n[[sensors]]\nname = \"work plane\"\n"
        << "room = \"*\"        # or one of:";
    for (std::size_t k = 0; k < std::min(places.size(), most_named); ++k)
      text << (k > 0 ? ", " : " ") << toml_text(places[k].name);
    text << (places.size() > most_named ? ", ..." : "") << '\n' << rest;
  } else if (!places.empty()) {
    text << "# A grid over the largest floor.\n[[sensors]]\nname = \"work plane\"\nfloor = "
         << toml_text(places[0].name) << '\n'
         << rest;
  }
  return text.str();
}

}  // namespace

std::string new_scene_file(const Scene& scene, const std::vector<std::filesystem::path>& models,
                           std::optional<double> metres_per_unit, const std::filesystem::path& file) {
  const std::vector<NamedFloor> places = scene.rooms.empty() ? floors_of_groups(scene) : rooms_of(scene);
  std::ostringstream text;
  text << "# A scene for patchlight; docs/formats.md has all keys. Lengths are metres.\n"
       << "# patchlight check " << file.filename().string() << "\n# patchlight solve " << file.filename().string()
       << " -o result.vtp --report result.json --picture result.png\n\n"
       << "up = " << (std::abs(scene.up.y()) > 0.5 ? "\"y\"" : "\"z\"") << "\n\n";
  text << model_tables(scene, models, metres_per_unit, file) << material_tables(scene) << light_tables(scene, places)
       << sensor_tables(scene, places);
  text << camera_tables(scene, places);
  return text.str();
}

}  // namespace patchlight
