#include "plan/survey.h"

#include "patchlight/base/diagnostics.h"

#include "base/tolerances.h"
#include "base/words.h"
#include "light/photometry.h"
#include "scene/coverings.h"
#include "scene/extent.h"
#include "scene/face_tree.h"
#include "scene/room_body.h"
#include "scene/solids.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>
#include <string_view>
#include <utility>
#include <variant>

namespace patchlight {
namespace {

constexpr std::array lamp_words = {"lights",       "lamp",     "lamps",     "desklamp",  "floorlamp",  "emit",
                                   "emitter",      "emitters", "emission",  "emissive",  "glow",       "emitting",
                                   "glowing",      "bulb",     "bulbs",     "neon",      "luminous",   "lightbulb",
                                   "ceilinglight", "led",      "spotlight", "downlight", "floodlight", "arealight"};

// Compounds, those of other languages among them, end in these.
constexpr std::array lamp_endings = {"lampe", "lampen", "leuchte", "leuchten", "luminaire", "luminaires"};

// After "light" these words denote a color or a kind of material.
constexpr std::array<std::string_view, 24> light_things = {
    "grey", "gray", "brown", "blue",  "green", "red",      "yellow", "beige",  "pink", "orange", "purple", "cyan",
    "wood", "oak",  "pine",  "maple", "stone", "concrete", "brick",  "marble", "tan",  "weight", "steel",  "metal"};

bool is_small_letter(char letter) { return letter >= 'a' && letter <= 'z'; }

bool is_capital_letter(char letter) { return letter >= 'A' && letter <= 'Z'; }

// In small letters.
std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words(1);
  for (std::size_t k = 0; k < name.size(); ++k) {
    const bool is_letter =
        is_small_letter(name[k]) || is_capital_letter(name[k]) || static_cast<unsigned char>(name[k]) >= 0x80;
    const bool begins = is_capital_letter(name[k]) && k > 0 && is_small_letter(name[k - 1]);
    if ((!is_letter || begins) && !words.back().empty()) words.emplace_back();
    if (is_letter) words.back() += name[k];
  }
  if (words.back().empty()) words.pop_back();
  for (std::string& word : words) word = in_lower_case(std::move(word));
  return words;
}

bool is_lamp_word(const std::string& word) {
  const auto ends = [&](const char* ending) { return word.ends_with(ending); };
  return std::find(lamp_words.begin(), lamp_words.end(), word) != lamp_words.end() ||
         std::any_of(lamp_endings.begin(), lamp_endings.end(), ends);
}

constexpr const char* usual_sky = "read.daylight.sky=overcast:10000lx";

// The reader's hints, else the materials with a name like a lamp's.
std::vector<LampHint> possible_lamps(const Scene& scene) {
  if (!scene.lamp_hints.empty()) return scene.lamp_hints;
  std::vector<LampHint> hints;
  for (const Material& material : scene.materials) {
    // The radiance of a lit panel, of 1,800 cd/m^2.
    if (is_name_of_lamp(material.name)) hints.push_back({material.name, Spectrum::Constant(1, 10), "its name"});
  }
  return hints;
}

// As one types it in a shell.
std::string setting_for(const LampHint& hint) {
  std::ostringstream text;
  text << hint.material << ".radiance=" << hint.radiance.format(Eigen::IOFormat(6, Eigen::DontAlignCols, ","));
  return "read.settings " + shell_word(text.str());
}

std::string advice_on_lamps(const std::vector<LampHint>& hints) {
  std::string advice;
  for (std::size_t k = 0; k < std::min<std::size_t>(3, hints.size()); ++k)
    advice +=
        "\nhint: '" + hints[k].material + "' looks like a lamp (" + hints[k].reason + "): " + setting_for(hints[k]);
  return advice;
}

std::string advice_on_other_light(const Scene& scene, const std::optional<Solid>& hull) {
  if (hull && is_room(scene, *hull)) {
    return "\nhint: the room has no window (" + place_of(scene, scene.polygons[hull->polygons.front()]) +
           "); create a scene with a lamp: patchlight init MODEL -o SCENE.toml";
  }
  return std::string("\nhint: add daylight") + (hull ? " from outside: " : ": ") + usual_sky +
         "\nhint: create a scene with lamps or daylight: patchlight init MODEL -o SCENE.toml";
}

std::vector<Box> boxes_of_polygons(const Scene& scene) {
  std::vector<Box> boxes(scene.polygons.size());
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p)
    for (const std::uint32_t corner : scene.polygons[p].corners) boxes[p].extend(scene.vertices[corner]);
  return boxes;
}

// How far from a point a polygon lies that comes nearer than a radius and lets no light through.
std::optional<double> near_distance(const Scene& scene, PolygonIndex polygon, const Point& middle, double radius) {
  const std::vector<Point> corners = corner_points(scene, polygon);
  if (is_opening(scene, polygon) || std::abs(front_normal(scene, polygon).dot(middle - corners[0])) >= radius)
    return {};
  double least = radius;
  for (const auto& [a, b, c] : triangulate(corners))
    least = std::min(least, distance_to({corners[a], corners[b], corners[c]}, middle));
  return least < radius ? std::optional(least) : std::nullopt;
}

// Luminaires farther from the model than masts are high, and than the model is long.
Diagnostics problems_of_far_ones(const Scene& scene) {
  if (scene.luminaires.empty()) return {};
  const Box box = bounds(scene);
  const double length = box.diagonal().norm();
  const double plausible = std::max(length, 30.0);
  double farthest = plausible;
  std::vector<std::string> far;
  for (const Luminaire& luminaire : scene.luminaires) {
    const double distance = box.exteriorDistance(luminaire.position);
    if (distance <= plausible) continue;
    far.push_back("'" + luminaire.name + "' of " + luminaire.place);
    farthest = std::max(farthest, distance);
  }
  if (far.empty()) return {};
  const bool is_one = far.size() == 1;
  return {{DiagnosticCode::implausible_size,
           (is_one ? "1 luminaire lies " : std::to_string(far.size()) + " luminaires lie up to ") + rounded(farthest) +
               " m from the model, which is " + rounded(length) + " m long (the first: " + far.front() + "). " +
               (is_one ? "Is its position in the unit of its file?" : "Are their positions in the unit of their file?"),
           far.size()}};
}

// Spheres that faces cut: light that starts behind the face falls on its other side.
Diagnostics problems_of_cut_ones(const Scene& scene) {
  std::size_t count = 0;
  std::string first;
  std::optional<BoxRow> row;
  const double rounding = tolerance_of_coordinates * extent_of(scene);  // a sphere that touches a face is not cut
  for (const Luminaire& luminaire : scene.luminaires) {
    const auto* const sphere = std::get_if<SphericalLamp>(&luminaire.light);
    if (sphere == nullptr) continue;
    if (!row) row.emplace(boxes_of_polygons(scene));
    const double radius = sphere->radius - rounding;
    const auto is_out = [&](const Box& box) { return box.exteriorDistance(luminaire.position) >= radius; };
    const auto is_cut = [&](std::size_t polygon) {
      return near_distance(scene, static_cast<PolygonIndex>(polygon), luminaire.position, radius).has_value();
    };
    const auto cut = row->first(0, is_out, is_cut);
    if (!cut || ++count > 1) continue;
    const Polygon& polygon = scene.polygons[*cut];
    const double distance =
        near_distance(scene, static_cast<PolygonIndex>(*cut), luminaire.position, radius).value_or(0);
    first = "'" + luminaire.name + "' (" + luminaire.place + "), of radius " + rounded(sphere->radius) +
            " m, whose middle is " + rounded(distance) + " m from face '" + group_name(scene, polygon.group) + "' (" +
            place_of(scene, polygon) + ")";
  }
  if (count == 0) return {};
  return {
      {DiagnosticCode::implausible_size,
       (count == 1 ? "1 sphere luminaire is" : std::to_string(count) + " sphere luminaires are") +
           " cut by faces (the first: " + first +
           "): light of the part behind the face falls on its other side. Move the luminaire away, or make it smaller",
       count}};
}

// That luminaires are farther from the model than it is long, and than 30 m; and that faces cut the spheres of some.
// O(spheres x log n) for n polygons, and O(n) where there are spheres.
Diagnostics problems_with_luminaires(const Scene& scene) {
  return merged({problems_of_far_ones(scene), problems_of_cut_ones(scene)});
}

// A model is between a part of a chair and a large building, or a site with buildings of some height. Meters.
constexpr double smallest_plausible = 0.4;
constexpr double largest_plausible = 150;

// A site has one short side: the height of its buildings or terrain, up to 30 m, or of towers in a site ten times as
// wide. Sides below a hundredth of the longest count as flat.
bool is_plausible(const Vector& sides) {
  const double longest = sides.maxCoeff();
  if (longest <= largest_plausible) return longest >= smallest_plausible;
  const double highest = std::max(30.0, std::min(100.0, 0.1 * longest));
  return std::any_of(sides.begin(), sides.end(), [&](double side) { return side > 0.01 * longest && side <= highest; });
}

struct Unit {
  const char* name;
  double metres;
  double handicap;  // inches and feet are rare: they have to come nearer by a factor of four
};
constexpr std::array<Unit, 5> units = {
    {{"m", 1, 1}, {"cm", 0.01, 1}, {"mm", 0.001, 1}, {"in", 0.0254, 4}, {"ft", 0.3048, 4}}};

// The unit that brings the model nearest to the 6 m of a room.
std::optional<UnitGuess> guess_unit(const Scene& scene, const Vector& sides) {
  if (scene.unit_stated || is_plausible(sides)) return std::nullopt;
  const double size = sides.maxCoeff();
  const double in_model_units = size / scene.metres_per_unit;
  const auto distance = [&](const Unit& unit) {
    return std::abs(std::log(in_model_units * unit.metres / 6)) + std::log(unit.handicap);
  };
  const Unit& best = *std::min_element(units.begin(), units.end(),
                                       [&](const Unit& a, const Unit& b) { return distance(a) < distance(b); });
  const double guessed = in_model_units * best.metres;
  if (guessed < smallest_plausible || guessed > largest_plausible) return std::nullopt;
  return UnitGuess{best.name, best.metres,
                   "the model would be " + rounded(guessed) + " m long instead of " + rounded(size) +
                       " m, the size of a room or a building"};
}

Diagnostics problems_of_size(const Scene& scene, const std::optional<UnitGuess>& guess, const Vector& sides) {
  if (scene.unit_stated || is_plausible(sides)) return {};
  const double size = sides.maxCoeff();
  const std::string advice =
      guess ? "perhaps its unit is " + guess->unit + ", as then " + guess->reason +
                  ": read.metres_per_unit=" + shortest(guess->metres_per_unit)
            : "no unit makes it the size of a room; radiances do not depend on it, lengths and fluxes do";
  return {{DiagnosticCode::implausible_size, "the model is " + rounded(size) + " m long with " +
                                                 rounded(scene.metres_per_unit) + " m per unit; " + advice}};
}

Diagnostics problems_with_reflectance(const std::vector<MaterialFacts>& materials) {
  std::vector<std::string> names;
  for (const MaterialFacts& facts : materials) {
    if ((facts.material.reflectance >= 1).any()) names.push_back(facts.material.name);
  }
  if (names.empty()) return {};
  return {{DiagnosticCode::full_reflectance,
           "reflectance 1 (Kd), so nothing is absorbed: " + first_few(names) +
               "; it is taken as it is. Real surfaces stay below 0.9, and a closed room of reflectance 1 has no answer",
           names.size()}};
}

std::vector<MaterialFacts> facts_of_materials(const Scene& scene) {
  std::vector<MaterialFacts> all;
  for (const Material& material : scene.materials) {
    all.push_back({material, 0, 0, Spectrum::Zero(material.exitance.size()), 0});
  }
  const auto add = [&all](MaterialIndex index, double area) {
    MaterialFacts& facts = all[index];
    ++facts.faces;
    facts.area += area;
    facts.flux += area * facts.material.exitance;
  };
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const Polygon& polygon = scene.polygons[p];
    const double area = polygon_area(scene, p);
    add(polygon.material, area);
    if (polygon.back_material) add(*polygon.back_material, area);
  }
  std::erase_if(all, [](const MaterialFacts& facts) { return facts.faces == 0; });
  const Bands bands = bands_of(scene);
  for (MaterialFacts& facts : all) facts.luminous_flux = luminance(facts.flux, bands);
  return all;
}

// "IfcSlab_*" of "IfcSlab_Floor:1"; other names stand for themselves.
std::string class_of(const std::string& name) {
  const std::size_t end = name.find('_');
  return name.starts_with("Ifc") && end != std::string::npos ? name.substr(0, end) + "_*" : name;
}

std::vector<ObjectFacts> largest_first(std::vector<ObjectFacts> all) {
  std::stable_sort(all.begin(), all.end(), [](const ObjectFacts& a, const ObjectFacts& b) { return a.area > b.area; });
  return all;
}

std::vector<ObjectFacts> facts_of_objects(const Scene& scene) {
  std::vector<ObjectFacts> all(scene.groups.size());
  for (std::uint32_t group = 0; group < all.size(); ++group) all[group].name = group_name(scene, group);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    ObjectFacts& facts = all[scene.polygons[p].group];
    ++facts.faces;
    facts.area += polygon_area(scene, p);
  }
  std::erase_if(all, [](const ObjectFacts& facts) { return facts.faces == 0; });
  return largest_first(std::move(all));
}

std::vector<ObjectFacts> by_class(const std::vector<ObjectFacts>& objects) {
  std::map<std::string, ObjectFacts> classes;
  for (const ObjectFacts& object : objects) {
    const std::string name = class_of(object.name);
    ObjectFacts& facts = classes.try_emplace(name, ObjectFacts{name, 0, 0, 0}).first->second;
    ++facts.objects;
    facts.faces += object.faces;
    facts.area += object.area;
  }
  std::vector<ObjectFacts> all;
  for (const auto& [name, facts] : classes) all.push_back(facts);
  return largest_first(std::move(all));
}

}  // namespace

double area_of_faces(const Scene& scene) {
  double area = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) area += polygon_area(scene, p);
  return area;
}

bool is_name_of_lamp(const std::string& name) {
  const std::vector<std::string> words = words_of(name);
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (is_lamp_word(words[k])) return true;
    const bool is_of_thing =
        k + 1 < words.size() && std::find(light_things.begin(), light_things.end(), words[k + 1]) != light_things.end();
    if (words[k] == "light" && !is_of_thing) return true;
  }
  return false;
}

FirstLight first_light(const Scene& scene) {
  const std::optional<Solid> hull = sealed_hull(scene);
  const std::vector<LampHint> hints = possible_lamps(scene);
  FirstLight light;
  light.advice = "no material emits" + advice_on_lamps(hints) + advice_on_other_light(scene, hull);
  const bool is_sealed = hull && is_room(scene, *hull);
  if (!is_sealed) light.setting = usual_sky;
  if (is_sealed && !hints.empty()) light.setting = setting_for(hints.front());
  if (!hints.empty()) return light;
  std::vector<std::string> names;
  for (const Material& material : scene.materials) names.push_back(material.name);
  light.advice += "\nhint: make a material emit, one of " + first_few(names) + ": read.settings MATERIAL.radiance=10";
  return light;
}

const char* name_of(SkyKind kind) {
  constexpr std::array names = {"uniform", "overcast", "clear", "perez"};
  return names.at(static_cast<std::size_t>(kind));
}

std::size_t kept_side_count(const KeptSides& sides) {
  const auto kept = [](const std::vector<std::uint8_t>& side) {
    return static_cast<std::size_t>(std::count(side.begin(), side.end(), std::uint8_t{1}));
  };
  return kept(sides.front) + kept(sides.back);
}

SideCounts count_sides(const Scene& scene, Sides sides) {
  const Sides chosen = has_lamp(scene) || sides == Sides::both ? sides : Sides::front;
  const KeptSides kept = kept_sides(scene, chosen);
  return {chosen, kept_side_count(kept), kept_area(scene, kept), kept.notes};
}

Diagnostics problems_with_size(const Scene& scene) {
  const Vector sides = main_bounds(scene).sizes();
  return merged({problems_of_size(scene, guess_unit(scene, sides), sides), problems_with_luminaires(scene)});
}

Diagnostics problems_with_sensors(const Scene& scene) {
  std::size_t count = 0;
  for (const SensorGroup& group : scene.sensors) count += group.sensors.size();
  if (count <= 100'000) return {};  // a grid of half a meter over 150 x 150 m
  const auto fewer = [](const SensorGroup& a, const SensorGroup& b) { return a.sensors.size() < b.sensors.size(); };
  const SensorGroup& largest = *std::max_element(scene.sensors.begin(), scene.sensors.end(), fewer);
  Box box;
  for (const Sensor& sensor : largest.sensors) box.extend(sensor.point);
  const std::string line = largest.lines.empty() ? std::string() : ":" + std::to_string(largest.lines.front());
  return {{DiagnosticCode::implausible_size,
           std::to_string(count) + " sensors are requested, which takes a long time; the largest group, '" +
               largest.name + "' (" + largest.file + line + "), has " + std::to_string(largest.sensors.size()) +
               " of them over " + rounded(box.sizes().maxCoeff()) +
               " m. Is the model in the stated unit? If it is, a larger spacing gives fewer sensors",
           count}};
}

SceneReport survey(const Scene& scene) {
  SceneReport report;
  report.bounds = bounds(scene);
  report.vertices = scene.vertices.size();
  report.polygons = scene.polygons.size();
  report.groups = scene.groups.size();
  report.materials = facts_of_materials(scene);
  report.objects = facts_of_objects(scene);
  report.classes = by_class(report.objects);
  report.area = area_of_faces(scene);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) report.lamps += is_lamp(scene, p);

  const KeptSides kept = kept_sides(scene, Sides::automatic);
  const Shells& shells = kept.geometry->shells;
  report.shells = shells.count;
  report.closed_shells = shells.closed_count;
  report.open_edges = shells.rim.size();
  for (const RimEdge& edge : shells.rim)
    report.open_edge_length += (scene.vertices[edge.to] - scene.vertices[edge.from]).norm();

  const Vector sides = main_bounds(scene).sizes();
  report.unit_guess = guess_unit(scene, sides);
  report.usable = has_lamp(scene);
  Diagnostics found =
      merged({scene.diagnostics, problems_of_size(scene, report.unit_guess, sides), problems_with_luminaires(scene),
              problems_with_sensors(scene), problems_with_reflectance(report.materials),
              problems_with_overlaps(scene, find_coverings(scene, kept))});
  if (!report.usable) {
    report.first_light = first_light(scene);
    found.push_back({DiagnosticCode::no_lamp, report.first_light->advice});
  }
  report.diagnostics = worst_first(std::move(found));
  return report;
}

}  // namespace patchlight
