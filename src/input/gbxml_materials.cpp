#include "input/gbxml_materials.h"

#include "input/text.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace patchlight {
namespace {

// As lighting standards assume them for rooms whose colours are not known.
constexpr double of_walls = 0.5;
constexpr double of_floors = 0.2;
constexpr double of_ceilings = 0.8;
constexpr double of_shades = 0.35;
constexpr double of_panes = 0.7;  // transmittance

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

// <Transmittance type="Visible">, in percent if it says so.
std::optional<double> visible_transmittance(const pugi::xml_node& type) {
  for (const pugi::xml_node& stated : type.children("Transmittance")) {
    if (std::string_view(stated.attribute("type").value()) != "Visible") continue;
    const std::optional<double> share = finite_number(trimmed(stated.child_value()));
    const bool is_percent = std::string_view(stated.attribute("unit").value()) == "Percent";
    if (share && *share >= 0) return std::min(1.0, is_percent ? *share / 100 : *share);
  }
  return std::nullopt;
}

}  // namespace

GbxmlMaterials::GbxmlMaterials(const XmlFile& xml) {
  for (const pugi::xml_node& type : xml.document.document_element().children("WindowType"))
    window_types_.emplace(type.attribute("id").value(), type);
}

GbxmlSides GbxmlMaterials::surface(const std::string& kind, const Vector& normal) const {
  if (!is_level(kind)) return {matt(kind, kind == "Shade" ? of_shades : of_walls), std::nullopt};
  const Material top = matt(kind + "-top", of_floors);
  const Material underside = matt(kind + "-underside", of_ceilings);
  return normal.z() >= 0 ? GbxmlSides{top, underside} : GbxmlSides{underside, top};
}

Material GbxmlMaterials::opening(const pugi::xml_node& opening) {
  const std::string kind = opening.attribute("openingType").value();
  const auto type = window_types_.find(opening.attribute("windowTypeIdRef").value());
  const bool has_type = type != window_types_.end();
  const std::optional<double> stated = has_type ? visible_transmittance(type->second) : std::nullopt;
  if (!is_glazed(kind) && !(stated && *stated > 0)) return matt(kind.empty() ? "Opening" : kind, of_walls);
  const std::string named = has_type ? std::string(trimmed(type->second.child_value("Name"))) : std::string();
  Material pane = matt(named.empty() ? kind : named, 0);
  const double share = stated.value_or(of_panes);
  pane.transmittance = rgb(share, share, share);
  if (!stated && std::find(assumed_.begin(), assumed_.end(), pane.name) == assumed_.end())
    assumed_.push_back(pane.name);
  return pane;
}

std::string usual_reflectances() {
  return "reflectances of gbXML are not read, usual ones are taken: walls and doors 0.5, tops of floors and roofs 0.2, "
         "their undersides and ceilings 0.8, shades 0.35; read.settings changes them, as InteriorWall.reflectance=0.7";
}

}  // namespace patchlight
