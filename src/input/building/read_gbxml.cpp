#include "patchlight/base/error.h"
#include "patchlight/base/geometry.h"
#include "patchlight/light/material.h"

#include "base/words.h"
#include "files/sha256.h"
#include "input/building/cut_openings.h"
#include "input/left_out.h"
#include "input/materials.h"
#include "input/read_model.h"
#include "input/text.h"
#include "input/xml_file.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// Materials of the two sides of a surface. Seen from the front, corners run counter-clockwise.
struct GbxmlSides {
  Material front;
  std::optional<Material> back;  // only if different
};

Material matt(const std::string& name, double reflectance) {
  return {name, rgb(reflectance, reflectance, reflectance), rgb(0, 0, 0)};
}

bool is_level(const std::string& kind) {
  constexpr std::array kinds = {"Roof",    "InteriorFloor",      "ExposedFloor", "UndergroundSlab",
                                "Ceiling", "UndergroundCeiling", "RaisedFloor",  "SlabOnGrade"};
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

bool is_glazed(const std::string& kind) {
  return kind.find("Window") != std::string::npos || kind.find("Skylight") != std::string::npos ||
         kind == "SlidingDoor";
}

// <Transmittance type="Visible">, a fraction or a percentage.
std::optional<double> visible_transmittance(const pugi::xml_node& type) {
  for (const pugi::xml_node& stated : type.children("Transmittance")) {
    if (std::string_view(stated.attribute("type").value()) != "Visible") continue;
    const std::optional<double> share = finite_number(trimmed(stated.child_value()));
    const bool is_percent = std::string_view(stated.attribute("unit").value()) == "Percent";
    if (share && *share >= 0) return std::min(1.0, is_percent ? *share / 100 : *share);
  }
  return std::nullopt;
}

// Materials of a building by kind of surface and opening. Reflectances are the defaults of lighting standards for rooms
// of unknown color.
class GbxmlMaterials {
 public:
  explicit GbxmlMaterials(const XmlFile& xml) {
    for (const pugi::xml_node& type : xml.document.document_element().children("WindowType"))
      window_types_.emplace(type.attribute("id").value(), type);
  }

  // The materials of a kind of surface, e.g. InteriorFloor. Horizontal surfaces have a floor on top and a ceiling
  // below; `normal` is that of the front.
  static GbxmlSides surface(const std::string& kind, const Vector& normal) {
    if (!is_level(kind)) return {matt(kind, kind == "Shade" ? 0.35 : of_walls), std::nullopt};
    const Material top = matt(kind + "-top", 0.2);
    const Material underside = matt(kind + "-underside", 0.8);
    return normal.z() >= 0 ? GbxmlSides{top, underside} : GbxmlSides{underside, top};
  }

  // The material of an opening. Windows, skylights and sliding doors are panes, as are openings with a transparent
  // window type. All others are doors.
  Material opening(const pugi::xml_node& opening) {
    const std::string kind = opening.attribute("openingType").value();
    const auto type = window_types_.find(opening.attribute("windowTypeIdRef").value());
    const bool has_type = type != window_types_.end();
    const std::optional<double> stated = has_type ? visible_transmittance(type->second) : std::nullopt;
    if (!is_glazed(kind) && !(stated && *stated > 0)) return matt(kind.empty() ? "Opening" : kind, of_walls);
    const std::string named = has_type ? std::string(trimmed(type->second.child_value("Name"))) : std::string();
    Material pane = matt(named.empty() ? kind : named, 0);
    const double share = stated.value_or(0.7);
    pane.transmittance = rgb(share, share, share);
    if (!stated && std::find(assumed_.begin(), assumed_.end(), pane.name) == assumed_.end())
      assumed_.push_back(pane.name);
    return pane;
  }

  // Windows whose type has no visible transmittance.
  const std::vector<std::string>& assumed() const { return assumed_; }

 private:
  static constexpr double of_walls = 0.5;

  std::map<std::string, pugi::xml_node> window_types_;  // by id
  std::vector<std::string> assumed_;
};

double metres_of(const std::string& unit, const std::string& where) {
  static const std::map<std::string, double> metres = {
      {"Kilometers", 1000}, {"Meters", 1},     {"Centimeters", 0.01}, {"Millimeters", 0.001},
      {"Miles", 1609.344},  {"Yards", 0.9144}, {"Feet", 0.3048},      {"Inches", 0.0254}};
  const auto found = metres.find(unit);
  if (found != metres.end()) return found->second;
  throw InputError(where, "lengthUnit: found '" + unit +
                              "'; expected Kilometers, Meters, Centimeters, Millimeters, Miles, Yards, Feet or Inches");
}

class GbxmlReader {
 public:
  GbxmlReader(const XmlFile& xml, double metres) : xml_(xml), metres_(metres), materials_(xml) {
    scene_.file = xml.file;
    scene_.metres_per_unit = metres;
    scene_.up = Vector::UnitZ();
    scene_.up_stated = true;
  }

  Scene scene() && {
    for (const pugi::xml_node& campus : xml_.document.document_element().children("Campus")) {
      turned_ = finite_number(trimmed(campus.child("Location").child_value("CADModelAzimuth"))).value_or(0);
      for (const pugi::xml_node& surface : campus.children("Surface")) add_surface(surface);
      for (const pugi::xml_node& building : campus.children("Building")) add_rooms(building);
    }
    scene_.diagnostics.push_back(
        {DiagnosticCode::assumed_material,
         "gbXML reflectances are not read. Defaults: walls and doors 0.5, tops of floors and roofs 0.2, "
         "their undersides and ceilings 0.8, shades 0.35\nhint: read.settings changes them, e.g. "
         "InteriorWall.reflectance=0.7"});
    if (turned_ != 0)
      scene_.diagnostics.push_back({DiagnosticCode::north_of_file,
                                    "CADModelAzimuth " + rounded(turned_) +
                                        " is ignored: north is y\nhint: the key north of a scene file changes it"});
    scene_.diagnostics =
        merged({std::move(scene_.diagnostics),
                note_on(DiagnosticCode::assumed_material, "windows whose type has no visible transmittance get 0.7",
                        materials_.assumed())});
    return left_out_.on(std::move(scene_));
  }

 private:
  Point point_of(const pugi::xml_node& node) const {
    Point point = Point::Zero();
    Eigen::Index k = 0;
    for (const pugi::xml_node& coordinate : node.children("Coordinate")) {
      const std::optional<double> value = finite_number(trimmed(coordinate.child_value()));
      if (!value || k == 3)
        throw InputError(place_of(xml_, coordinate), "found the coordinate '" + std::string(coordinate.child_value()) +
                                                         "'; expected three numbers for a CartesianPoint");
      point[k++] = metres_ * *value;
    }
    if (k < 3) throw InputError(place_of(xml_, node), "a CartesianPoint has fewer than three coordinates");
    return point;
  }

  std::vector<Point> loop_of(const pugi::xml_node& loop) const {
    std::vector<Point> points;
    for (const pugi::xml_node& point : loop.children("CartesianPoint")) points.push_back(point_of(point));
    return points;
  }

  std::vector<Point> outline_of(const pugi::xml_node& node) const {
    return loop_of(node.child("PlanarGeometry").child("PolyLoop"));
  }

  static std::string name_of(const pugi::xml_node& node) {
    const std::string_view name = trimmed(node.child_value("Name"));
    return name.empty() ? node.attribute("id").value() : std::string(name);
  }

  void add_surface(const pugi::xml_node& surface) {
    const std::string kind = surface.attribute("surfaceType").value();
    const std::string name = name_of(surface);
    const std::vector<Point> outline = outline_of(surface);
    for (const pugi::xml_node& space : surface.children("AdjacentSpaceId"))
      faces_of_space_[space.attribute("spaceIdRef").value()].push_back(outline);
    std::vector<std::vector<Point>> openings;
    for (const pugi::xml_node& opening : surface.children("Opening")) {
      openings.push_back(outline_of(opening));
      add_opening(opening, openings.back());
      if (openings.back().size() < 3) openings.pop_back();
    }
    if (kind == "Air") return left_out_.add("surfaces of air are open, left out", name);
    if (outline.size() < 3) return left_out_.lose("surfaces without a PolyLoop of three corners, left out", name);
    const CutOutline cut = without_openings(outline, openings, drawing_tolerance);
    if (cut.beyond > 0) left_out_.add("surfaces with openings that reach beyond them, cut within the surface", name);
    if (!cut.is_cut) left_out_.add("surfaces without a computable area, whose openings are not cut out", name);
    const GbxmlSides sides = GbxmlMaterials::surface(kind.empty() ? "Surface" : kind, area_vector(outline));
    if (!cut.parts.empty()) add_polygons(surface, name, cut.parts, sides);
  }

  // Openings of the kind air become holes.
  void add_opening(const pugi::xml_node& opening, const std::vector<Point>& outline) {
    const std::string name = name_of(opening);
    if (std::string_view(opening.attribute("openingType").value()) == "Air") return;
    if (outline.size() < 3) return left_out_.lose("openings without a PolyLoop of three corners, left out", name);
    add_polygons(opening, name, {outline}, {materials_.opening(opening), std::nullopt});
  }

  void add_polygons(const pugi::xml_node& node, const std::string& name, const std::vector<std::vector<Point>>& parts,
                    const GbxmlSides& sides) {
    Polygon polygon;
    polygon.material = index_of(sides.front);
    if (sides.back) polygon.back_material = index_of(*sides.back);
    polygon.group = static_cast<std::uint32_t>(scene_.groups.size());
    polygon.line = line_of(xml_, node);
    scene_.groups.push_back(name);
    scene_ = with_parts(std::move(scene_), std::move(polygon), parts);
  }

  MaterialIndex index_of(const Material& material) {
    // Window types with the same name may differ in transmittance.
    const Spectrum& transmittance = material.transmittance;
    const auto [found, is_new] = materials_by_transmittance_.emplace(
        std::pair(material.name, std::vector<double>(transmittance.begin(), transmittance.end())),
        static_cast<MaterialIndex>(scene_.materials.size()));
    if (is_new) {
      scene_.materials.push_back(material);
      scene_.materials.back().name = material_names_.unique(material.name);
    }
    return found->second;
  }

  // The faces of a space: its shell, else the surfaces around it.
  std::vector<std::vector<Point>> faces_of(const pugi::xml_node& space) const {
    std::vector<std::vector<Point>> faces;
    for (const pugi::xml_node& loop : space.child("ShellGeometry").child("ClosedShell").children("PolyLoop")) {
      faces.push_back(loop_of(loop));
      if (faces.back().size() < 3) faces.pop_back();
    }
    const auto around = faces_of_space_.find(space.attribute("id").value());
    if (!faces.empty() || around == faces_of_space_.end()) return faces;
    for (const std::vector<Point>& face : around->second) {
      if (face.size() >= 3) faces.push_back(face);
    }
    return faces;
  }

  void add_rooms(const pugi::xml_node& building) {
    std::map<std::string, std::string> storeys;
    for (const pugi::xml_node& storey : building.children("BuildingStorey"))
      storeys.emplace(storey.attribute("id").value(), name_of(storey));
    for (const pugi::xml_node& space : building.children("Space")) {
      const auto storey = storeys.find(space.attribute("buildingStoreyIdRef").value());
      std::vector<std::vector<Point>> faces = faces_of(space);
      if (faces.empty()) {
        left_out_.lose("spaces without faces, left out", name_of(space));
        continue;
      }
      scene_.rooms.push_back(
          {room_names_.unique(name_of(space)), storey == storeys.end() ? "" : storey->second, std::move(faces)});
    }
  }

  const XmlFile& xml_;
  double metres_;
  GbxmlMaterials materials_;
  Scene scene_;
  LeftOut left_out_;
  std::map<std::string, std::vector<std::vector<Point>>> faces_of_space_;
  UniqueNames room_names_;
  UniqueNames material_names_;
  std::map<std::pair<std::string, std::vector<double>>, MaterialIndex> materials_by_transmittance_;
  double turned_ = 0;  // angle between the plan's vertical and true north, degrees
};

}  // namespace

Scene read_gbxml(const XmlFile& xml, double factor) {
  const pugi::xml_node root = xml.document.document_element();
  const std::string unit = root.attribute("lengthUnit").value();
  const double metres = factor * metres_of(unit.empty() ? "Meters" : unit, place_of(xml, root));
  Scene scene = with_used_materials(GbxmlReader(xml, metres).scene());
  scene.sha256 = sha256({&xml.bytes, 1});
  return scene;
}

}  // namespace patchlight
