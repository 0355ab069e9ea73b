#include "patchlight/base/error.h"
#include "patchlight/light/material.h"

#include "base/words.h"
#include "files/reason.h"
#include "files/sha256.h"
#include "input/building/cut_openings.h"
#include "input/left_out.h"
#include "input/materials.h"
#include "input/radiance/radiance_material.h"
#include "input/read_model.h"
#include "input/text.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

using HbJson = nlohmann::json;

double number_in(const HbJson& item, const std::string& key, double otherwise) {
  const auto found = item.find(key);
  return found != item.end() && found->is_number() ? found->get<double>() : otherwise;
}

// Reads "r_reflectance" and so on.
Spectrum bands_of_key(const HbJson& item, const std::string& quantity, double otherwise) {
  return rgb(number_in(item, "r_" + quantity, otherwise), number_in(item, "g_" + quantity, otherwise),
             number_in(item, "b_" + quantity, otherwise));
}

std::string text_in(const HbJson& item, const std::string& key) {
  const auto found = item.find(key);
  return found != item.end() && found->is_string() ? found->get<std::string>() : std::string();
}

// The text at a path below the item; empty if absent.
std::string text_at(const HbJson& item, const char* place) {
  const HbJson::json_pointer pointer(place);
  return item.contains(pointer) && item.at(pointer).is_string() ? item.at(pointer).get<std::string>() : std::string();
}

// Transmissivity 0.88 for interior windows and 0.64 for others.
const std::map<std::string, std::pair<double, double>>& generic_values() {
  static const std::map<std::string, std::pair<double, double>> values = {
      {"floor", {0.2, 0}},           {"wall", {0.5, 0}},
      {"ceiling", {0.8, 0}},         {"door", {0.5, 0}},
      {"window", {0, 0.64}},         {"interior_window", {0, 0.88}},
      {"exterior_shade", {0.35, 0}}, {"interior_shade", {0.5, 0}},
      {"context", {0.2, 0}}};
  return values;
}

Material generic_material(const std::string& kind) {
  const auto [reflectance, transmittance] = generic_values().at(kind);
  Material material{"generic_" + kind, rgb(reflectance, reflectance, reflectance), rgb(0, 0, 0)};
  if (transmittance > 0) {
    material.transmittance = rgb(transmittance, transmittance, transmittance);
    material.index = 1.52;
  }
  return material;
}

// The material of a Radiance modifier; empty for unknown kinds.
std::optional<Material> material_of(const HbJson& modifier) {
  const std::string type = in_lower_case(text_in(modifier, "type"));
  const std::string name = text_in(modifier, "identifier");
  const Spectrum reflectance = bands_of_key(modifier, "reflectance", 0);
  const double roughness = number_in(modifier, "roughness", 0);
  if (type == "plastic") return plastic(name, reflectance, number_in(modifier, "specularity", 0));
  if (type == "metal") return metal(name, reflectance, number_in(modifier, "specularity", 0.9), roughness);
  if (type == "mirror") return metal(name, reflectance, 1, roughness);
  if (type == "glass")
    return glass(name, bands_of_key(modifier, "transmissivity", 0),
                 number_in(modifier, "refraction_index", usual_index));
  if (type == "trans") {
    return translucent(name, reflectance, number_in(modifier, "specularity", 0),
                       number_in(modifier, "transmitted_diff", 0), number_in(modifier, "transmitted_spec", 0));
  }
  if (type == "light" || type == "glow") return emitter(name, bands_of_key(modifier, "emittance", 0));
  return std::nullopt;
}

// Position of a kind's modifier in a modifier set: the part, and its keys for outdoor and other faces.
struct PlaceInSet {
  const char* part;
  const char* outdoors;
  const char* other;
};

const std::map<std::string, PlaceInSet>& places_in_sets() {
  static const std::map<std::string, PlaceInSet> places = {
      {"floor", {"floor_set", "exterior_modifier", "interior_modifier"}},
      {"wall", {"wall_set", "exterior_modifier", "interior_modifier"}},
      {"ceiling", {"roof_ceiling_set", "exterior_modifier", "interior_modifier"}},
      {"door", {"door_set", "exterior_modifier", "interior_modifier"}},
      {"glass_door", {"door_set", "exterior_glass_modifier", "interior_glass_modifier"}},
      {"window", {"aperture_set", "window_modifier", "interior_modifier"}},
      {"operable_window", {"aperture_set", "operable_modifier", "interior_modifier"}},
      {"skylight", {"aperture_set", "skylight_modifier", "interior_modifier"}},
      {"exterior_shade", {"shade_set", "exterior_modifier", "exterior_modifier"}},
      {"interior_shade", {"shade_set", "interior_modifier", "interior_modifier"}}};
  return places;
}

// Honeybee uses one generic modifier for several kinds.
std::string generic_kind(const std::string& kind, bool outdoors) {
  const bool is_glass = kind == "window" || kind == "operable_window" || kind == "skylight" || kind == "glass_door";
  if (is_glass) return outdoors ? "window" : "interior_window";
  return kind;
}

// Converts the modifiers of a honeybee model to materials.
class HoneybeeModifiers {
 public:
  // `radiance` is the model's "properties"."radiance" and may be null.
  explicit HoneybeeModifiers(const HbJson& radiance) : radiance_(radiance) {}

  // The material of a face, opening or shade: its own modifier, else that of its room's modifier set, else honeybee's
  // generic one. `kind` is one of "floor", "wall", "ceiling", "door", "glass_door", "window", "operable_window",
  // "skylight", "exterior_shade", "interior_shade", "context". The boundary condition decides whether the item is
  // outdoors.
  Material material(const HbJson& item, const std::string& set, const std::string& kind) {
    const bool outdoors = text_at(item, "/boundary_condition/type") == "Outdoors";
    std::string name = text_at(item, "/properties/radiance/modifier");
    if (name.empty()) name = of_set(set, kind, outdoors);
    const HbJson* const found = name.empty() ? nullptr : identified("modifiers", name);
    const std::optional<Material> material = found != nullptr ? material_of(*found) : std::nullopt;
    if (material) return *material;
    if (!name.empty() && std::find(unknown_.begin(), unknown_.end(), name) == unknown_.end()) unknown_.push_back(name);
    return generic_material(generic_kind(kind, outdoors));
  }

  // Unsupported modifiers, replaced by honeybee's generic ones.
  const std::vector<std::string>& unknown() const { return unknown_; }

 private:
  const HbJson* identified(const char* list, const std::string& identifier) const {
    const auto all = radiance_.find(list);
    if (all == radiance_.end()) return nullptr;
    const auto found = std::find_if(all->begin(), all->end(),
                                    [&](const HbJson& one) { return text_in(one, "identifier") == identifier; });
    return found == all->end() ? nullptr : &*found;
  }

  std::string of_set(const std::string& set, const std::string& kind, bool outdoors) const {
    const auto place = places_in_sets().find(kind);
    const HbJson* const found = set.empty() ? nullptr : identified("modifier_sets", set);
    if (found == nullptr || place == places_in_sets().end()) return {};
    const auto part = found->find(place->second.part);
    if (part == found->end() || !part->is_object()) return {};
    return text_in(*part, outdoors ? place->second.outdoors : place->second.other);
  }

  const HbJson& radiance_;
  std::vector<std::string> unknown_;
};

const std::map<std::string, double>& honeybee_units() {
  static const std::map<std::string, double> units = {
      {"Meters", 1}, {"Centimeters", 0.01}, {"Millimeters", 0.001}, {"Inches", 0.0254}, {"Feet", 0.3048}};
  return units;
}

// The value of an optional key; null counts as absent.
template <typename Value>
Value value_or(const HbJson& item, const char* key, Value otherwise) {
  const auto found = item.find(key);
  return found == item.end() || found->is_null() ? otherwise : found->get<Value>();
}

// An empty list if absent.
const HbJson& list_of(const HbJson& item, const char* key) {
  static const HbJson none = HbJson::array();
  const auto found = item.find(key);
  return found != item.end() && found->is_array() ? *found : none;
}

Point hb_point(const HbJson& point, double metres) {
  return metres * Point(point.at(0).get<double>(), point.at(1).get<double>(), point.at(2).get<double>());
}

std::vector<Point> hb_points(const HbJson& list, double metres) {
  std::vector<Point> points;
  for (const HbJson& point : list) points.push_back(hb_point(point, metres));
  return points;
}

class HoneybeeScene {
 public:
  HoneybeeScene(const HbJson& model, const std::string& file, double metres)
      : modifiers_(radiance_of(model)), metres_(metres) {
    scene_.file = file;
    report_unread(
        model, "models",
        {"rooms", "orphaned_faces", "orphaned_apertures", "orphaned_doors", "orphaned_shades", "shade_meshes"});
    report_unread(radiance_of(model), "radiance properties", {"modifiers", "modifier_sets", "sensor_grids", "views"});
    for (const HbJson& room : list_of(model, "rooms")) add_room(room);
    for (const HbJson& face : list_of(model, "orphaned_faces")) add_face(face, "");
    for (const HbJson& aperture : list_of(model, "orphaned_apertures")) add_opening(aperture, "", "window");
    for (const HbJson& door : list_of(model, "orphaned_doors"))
      add_opening(door, "", value_or(door, "is_glass", false) ? "glass_door" : "door");
    for (const HbJson& shade : list_of(model, "orphaned_shades")) add(shade, "", "context");
    for (const HbJson& mesh : list_of(model, "shade_meshes"))
      add(mesh, "", value_or(mesh, "is_detached", true) ? "context" : "exterior_shade");
    for (const HbJson& grid : list_of(radiance_of(model), "sensor_grids")) add_grid(grid);
    for (const HbJson& view : list_of(radiance_of(model), "views")) add_view(view);
    scene_.diagnostics =
        merged({std::move(scene_.diagnostics),
                note_on(DiagnosticCode::assumed_material, "unsupported modifiers, replaced by honeybee's generic ones",
                        modifiers_.unknown())});
    scene_ = left_out_.on(std::move(scene_));
  }
  Scene scene() && { return std::move(scene_); }

 private:
  static const HbJson& radiance_of(const HbJson& model) {
    static const HbJson none = HbJson::object();
    const HbJson::json_pointer place("/properties/radiance");
    return model.contains(place) ? model.at(place) : none;
  }

  MaterialIndex index_of(Material material) {
    const auto [found, is_new] =
        material_index_.emplace(material.name, static_cast<MaterialIndex>(scene_.materials.size()));
    if (is_new) scene_.materials.push_back(std::move(material));
    return found->second;
  }

  // Reports objects in lists that this reader does not read.
  void report_unread(const HbJson& owner, const std::string& owners, const std::set<std::string>& known) {
    for (const auto& [key, list] : owner.items()) {
      if (!list.is_array() || known.count(key) > 0) continue;
      for (const HbJson& item : list) {
        if (!item.is_object()) break;
        left_out_.lose("objects in the list '" + key + "' of " + owners + ", which cannot be read, left out",
                       value_or<std::string>(item, "identifier", value_or<std::string>(item, "type", "no identifier")));
      }
    }
  }

  std::uint32_t add_group(const HbJson& item) {
    scene_.groups.push_back(item.at("identifier").get<std::string>());
    return static_cast<std::uint32_t>(scene_.groups.size() - 1);
  }

  void add_parts(const std::vector<std::vector<Point>>& parts, const HbJson& item, MaterialIndex material) {
    Polygon polygon{.corners = {}, .material = material, .group = add_group(item)};
    scene_ = with_parts(std::move(scene_), std::move(polygon), parts);
  }

  // The outline of an object; empty for lost objects.
  std::vector<Point> outline_of(const HbJson& item) {
    std::vector<Point> outline = hb_points(item.at("geometry").at("boundary"), metres_);
    if (outline.size() >= 3) return outline;
    left_out_.lose("objects with fewer than three corners, left out", item.at("identifier").get<std::string>());
    return {};
  }

  std::vector<std::vector<Point>> holes_of(const HbJson& item) const {
    std::vector<std::vector<Point>> holes;
    for (const HbJson& hole : list_of(item.at("geometry"), "holes")) holes.push_back(hb_points(hole, metres_));
    return holes;
  }

  // Adds an object's face without these holes and openings.
  void add_cut(const HbJson& item, const std::vector<std::vector<Point>>& holes, MaterialIndex material) {
    const std::string name = item.at("identifier").get<std::string>();
    const std::vector<Point> outline = outline_of(item);
    if (outline.empty()) return;
    const CutOutline cut = without_openings(outline, holes, drawing_tolerance);
    if (cut.beyond > 0) left_out_.add("faces with openings that reach beyond them, cut within the face", name);
    if (!cut.is_cut) left_out_.add("faces without a computable area, whose openings are not cut out", name);
    add_parts(cut.parts, item, material);
  }

  void add_mesh(const HbJson& item, MaterialIndex material) {
    const HbJson& mesh = item.at("geometry");
    const auto first = static_cast<std::uint32_t>(scene_.vertices.size());
    const std::vector<Point> points = hb_points(mesh.at("vertices"), metres_);
    scene_.vertices.insert(scene_.vertices.end(), points.begin(), points.end());
    Polygon polygon{.corners = {}, .material = material, .group = add_group(item)};
    for (const HbJson& face : mesh.at("faces")) {
      polygon.corners.clear();
      for (const HbJson& corner : face) {
        const auto place = corner.get<std::int64_t>();
        if (place < 0 || place >= static_cast<std::int64_t>(points.size()))
          throw InputError(scene_.file + ": " + scene_.groups.back(),
                           "a face of the mesh names vertex " + std::to_string(place) + "; expected 0 to " +
                               std::to_string(static_cast<std::int64_t>(points.size()) - 1) +
                               "\nhint: export the model again");
        polygon.corners.push_back(first + static_cast<std::uint32_t>(place));
      }
      if (polygon.corners.size() >= 3)
        scene_.polygons.push_back(polygon);
      else
        left_out_.lose_face(too_few_corners, scene_.groups.back());
    }
    if (mesh.at("faces").empty()) left_out_.lose("meshes without faces, left out", scene_.groups.back());
  }

  // Adds a shade or an opening, given as one face or as a mesh.
  void add(const HbJson& item, const std::string& set, const std::string& kind) {
    const HbJson& geometry = item.at("geometry");
    if (geometry.contains("boundary"))
      return add_cut(item, holes_of(item), index_of(modifiers_.material(item, set, kind)));
    if (geometry.contains("vertices") && geometry.contains("faces"))
      return add_mesh(item, index_of(modifiers_.material(item, set, kind)));
    left_out_.lose("objects whose geometry is neither a face nor a mesh, left out",
                   item.at("identifier").get<std::string>());
  }

  void add_shades(const HbJson& owner, const std::string& set) {
    for (const HbJson& shade : list_of(owner, "outdoor_shades")) add(shade, set, "exterior_shade");
    for (const HbJson& shade : list_of(owner, "indoor_shades")) add(shade, set, "interior_shade");
  }

  void add_opening(const HbJson& opening, const std::string& set, const std::string& kind) {
    report_unread(opening, "openings", {"indoor_shades", "outdoor_shades"});
    add_shades(opening, set);
    add(opening, set, kind);
  }

  static const char* kind_of_opening(const HbJson& face, const HbJson& opening, bool is_clear) {
    if (opening.at("type") != "Aperture") return is_clear ? "glass_door" : "door";
    if (text_in(face, "face_type") == "RoofCeiling") return "skylight";
    return value_or(opening, "is_operable", false) ? "operable_window" : "window";
  }

  // Adds the openings of a face. Openings between two rooms occur twice in the file, back to back.
  void add_openings(const HbJson& face, const std::string& set) {
    for (const char* const key : {"apertures", "doors"}) {
      for (const HbJson& opening : list_of(face, key)) {
        const HbJson& condition = opening.at("boundary_condition");
        const bool is_inside = condition.at("type") == "Surface";
        const bool is_clear = opening.at("type") == "Aperture" || value_or(opening, "is_glass", false);
        if (is_inside && done_.count(condition.at("boundary_condition_objects").at(0).get<std::string>()) > 0) {
          add_shades(opening, set);
          continue;
        }
        done_.insert(opening.at("identifier").get<std::string>());
        add_opening(opening, set, kind_of_opening(face, opening, is_clear));
      }
    }
  }

  void add_face(const HbJson& face, const std::string& set) {
    static const std::map<std::string, std::string> kinds = {
        {"Floor", "floor"}, {"Wall", "wall"}, {"RoofCeiling", "ceiling"}};
    add_shades(face, set);
    report_unread(face, "faces", {"apertures", "doors", "indoor_shades", "outdoor_shades"});
    const auto kind = kinds.find(face.at("face_type").get<std::string>());
    if (kind != kinds.end()) {
      std::vector<std::vector<Point>> holes = holes_of(face);
      for (const char* const key : {"apertures", "doors"})
        for (const HbJson& opening : list_of(face, key))
          holes.push_back(hb_points(opening.at("geometry").at("boundary"), metres_));
      add_cut(face, holes, index_of(modifiers_.material(face, set, kind->second)));
    }
    add_openings(face, set);
  }

  void add_room(const HbJson& room) {
    const std::string set = text_at(room, "/properties/radiance/modifier_set");
    NamedRoom body{value_or(room, "display_name", room.at("identifier").get<std::string>()),
                   value_or<std::string>(room, "story", ""),
                   {}};
    report_unread(room, "rooms", {"faces", "indoor_shades", "outdoor_shades"});
    add_shades(room, set);
    for (const HbJson& face : room.at("faces")) {
      body.faces.push_back(hb_points(face.at("geometry").at("boundary"), metres_));
      add_face(face, set);
    }
    scene_.rooms.push_back(std::move(body));
  }

  void add_grid(const HbJson& grid) {
    SensorGroup group;
    group.name = grid.at("identifier").get<std::string>();
    group.file = scene_.file;
    for (const HbJson& sensor : grid.at("sensors")) {
      const Point at = hb_point(sensor.at("pos"), metres_);
      const Vector direction = hb_point(sensor.at("dir"), 1);
      if (!(direction.stableNorm() > 0))
        throw InputError(scene_.file + ": " + group.name, "a sensor looks along 0, 0, 0; expected a direction");
      group.sensors.push_back({at, direction.stableNormalized()});
    }
    group.lines = {0};
    if (!group.sensors.empty()) scene_.sensors.push_back(std::move(group));
  }

  void add_view(const HbJson& view) {
    const Point eye = hb_point(view.at("position"), metres_);
    const Vector way = hb_point(view.at("direction"), 1);
    const double angle = value_or(view, "v_size", 60.0);
    if (!(way.stableNorm() > 0) || !(angle > 0 && angle < 180)) {
      scene_.diagnostics.push_back(
          {DiagnosticCode::simplified_part,
           "view '" + view.at("identifier").get<std::string>() + "' is no perspective below 180 degrees: left out"});
      return;
    }
    scene_.cameras.push_back({eye, eye + way.stableNormalized(), angle, view.at("identifier").get<std::string>()});
  }

  HoneybeeModifiers modifiers_;
  double metres_;
  Scene scene_;
  LeftOut left_out_;
  std::map<std::string, MaterialIndex> material_index_;
  std::set<std::string> done_;  // openings between rooms that were added
};

}  // namespace

Scene read_hbjson(const std::filesystem::path& file, double metres_per_unit) {
  const std::string bytes = read_text(file, file.string(), "the model file");
  try {
    const HbJson model = HbJson::parse(bytes);
    const std::string unit = value_or<std::string>(model, "units", "Meters");
    const auto known = honeybee_units().find(unit);
    if (known == honeybee_units().end())
      throw InputError(file.string(), "units: found '" + unit +
                                          "'; expected Meters, Centimeters, Millimeters, Inches "
                                          "or Feet");
    Scene scene = with_used_materials(HoneybeeScene(model, file.string(), known->second * metres_per_unit).scene());
    scene.metres_per_unit = known->second * metres_per_unit;
    scene.up = Vector::UnitZ();
    scene.up_stated = true;
    scene.sha256 = sha256({&bytes, 1});
    return scene;
  } catch (const HbJson::exception& error) {
    throw InputError(file.string(), "is not a valid honeybee model: " + reason_of(error) + "\nhint: export it again");
  }
}

}  // namespace patchlight
