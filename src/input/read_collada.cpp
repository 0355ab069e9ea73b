#include "input/read_collada.h"

#include "input/assimp_scene.h"
#include "input/decoded_pictures.h"
#include "input/left_out.h"
#include "input/scene_bytes.h"
#include "input/text.h"

#include <pugixml.hpp>
#include <set>
#include <utility>

namespace patchlight {
namespace {

// The file's <up_axis>: X_UP, Y_UP (also when there is none) or Z_UP. assimp does not tell it.
Vector up_axis(const std::string& text) {
  constexpr std::string_view element = "<up_axis>";
  const std::size_t found = text.find(element);
  if (found == std::string::npos) return Vector::UnitY();
  const std::size_t value = text.find_first_not_of(" \t\r\n", found + element.size());
  if (value == std::string::npos) return Vector::UnitY();
  return text[value] == 'X' ? Vector::UnitX() : text[value] == 'Z' ? Vector::UnitZ() : Vector::UnitY();
}

// The ids of geometries that a node places in the scene, as "#id". Walked without recursion, however deep nodes are
// nested.
std::set<std::string> placed_geometries(const pugi::xml_document& document) {
  struct Instances : pugi::xml_tree_walker {
    std::set<std::string> urls;
    bool for_each(pugi::xml_node& node) override {
      if (std::string_view(node.name()) == "instance_geometry") urls.insert(node.attribute("url").value());
      return true;
    }
  } instances;
  pugi::xml_node root = document.child("COLLADA");
  root.traverse(instances);
  return instances.urls;
}

// assimp skips geometries that are not meshes, and holes of polygons. Geometries that no node places are not lost.
Scene with_lost_geometry(Scene scene, const std::string& text) {
  LeftOut left_out;
  pugi::xml_document document;
  document.load_buffer(text.data(), text.size());
  const std::set<std::string> placed = placed_geometries(document);
  for (const pugi::xml_node& geometry : document.child("COLLADA").child("library_geometries").children("geometry")) {
    if (placed.count(std::string("#") + geometry.attribute("id").value()) == 0) continue;
    const std::string name = geometry.attribute(geometry.attribute("name") ? "name" : "id").value();
    const pugi::xml_node mesh = geometry.child("mesh");
    if (geometry.child("spline"))
      left_out.lose_without_area("splines, left out", name);
    else if (!mesh)
      left_out.lose("geometries that are not meshes, left out", name);
    for (const pugi::xml_node& polygons : mesh.children("polygons")) {
      for ([[maybe_unused]] const pugi::xml_node& face : polygons.children("ph"))
        left_out.lose("polygons with holes, left out; of the geometries", name);
    }
  }
  return left_out.on(std::move(scene));
}

}  // namespace

Scene read_collada(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine) {
  const std::string bytes = read_text(file, file.string(), "the model file");
  Scene scene = read_isolated(file.string(), [&] { return assimp_scene(bytes, file.string(), metres_per_unit); });
  // These are decoded in a process of their own: one on which that crashes leaves the model as it is.
  scene = with_decoded_pictures(std::move(scene), bytes, confine);
  scene = with_lost_geometry(std::move(scene), bytes);
  scene.up = up_axis(bytes);
  scene.up_stated = true;
  return scene;
}

double collada_unit(std::string_view text) {
  const std::size_t unit = text.find("<unit");
  if (unit == std::string_view::npos) return 1;
  const std::string_view element = text.substr(unit, text.find('>', unit) - unit);
  const std::size_t key = element.find("meter=");
  if (key == std::string_view::npos || key + 7 >= element.size()) return 1;
  const std::size_t begin = key + 7;
  const std::size_t end = element.find_first_of("\"'", begin);
  const double metres = finite_number(element.substr(begin, end - begin)).value_or(1);
  return metres > 0 ? metres : 1;
}

}  // namespace patchlight
