#include "input/read_ply.h"

#include "patchlight/base/error.h"

#include "files/sha256.h"
#include "input/left_out.h"
#include "input/materials.h"
#include "input/ply_body.h"
#include "input/text.h"

#include <algorithm>
#include <optional>

namespace patchlight {
namespace {

// Where a property stands in its element; nothing when there is none of these names.
std::optional<std::size_t> find(const PlyElement& element, std::initializer_list<std::string_view> names) {
  for (std::size_t k = 0; k < element.properties.size(); ++k) {
    if (std::find(names.begin(), names.end(), element.properties[k].name) != names.end()) return k;
  }
  return std::nullopt;
}

Scene with_vertices(Scene scene, const PlyElement& element, PlyBody& body) {
  const std::optional<std::size_t> x = find(element, {"x"});
  const std::optional<std::size_t> y = find(element, {"y"});
  const std::optional<std::size_t> z = find(element, {"z"});
  if (!x || !y || !z) throw InputError(scene.file, "its vertices lack one of the properties x, y and z");
  for (std::uint64_t v = 0; v < element.count; ++v) {
    Point point = Point::Zero();
    for (std::size_t k = 0; k < element.properties.size(); ++k) {
      const std::vector<double> values = body.next(element.properties[k]);
      if (values.empty()) continue;
      if (k == *x) point.x() = values[0];
      if (k == *y) point.y() = values[0];
      if (k == *z) point.z() = values[0];
    }
    scene.vertices.emplace_back(scene.metres_per_unit * point);
  }
  if (find(element, {"red", "diffuse_red"})) scene.notes.emplace_back("the colours of the vertices are ignored");
  return scene;
}

Polygon polygon_of(const std::vector<double>& corners, const PlyBody& body) {
  Polygon polygon;
  polygon.line = body.line();
  for (const double corner : corners) {
    if (!(corner >= 0 && corner < no_polygon)) {
      throw InputError(body.place(), "a face has a corner that names no vertex\nhint: export the model again");
    }
    polygon.corners.push_back(static_cast<std::uint32_t>(corner));
  }
  return polygon;
}

Scene with_faces(Scene scene, const PlyElement& element, PlyBody& body) {
  LeftOut left_out;
  const std::optional<std::size_t> corners = find(element, {"vertex_indices", "vertex_index"});
  if (!corners) throw InputError(scene.file, "its faces lack the property vertex_indices");
  for (std::uint64_t f = 0; f < element.count; ++f) {
    for (std::size_t k = 0; k < element.properties.size(); ++k) {
      const std::vector<double> values = body.next(element.properties[k]);
      if (k != *corners) continue;
      if (values.size() < 3)
        left_out.lose_face(too_few_corners, scene.groups[0], {.line = body.line()});
      else
        scene.polygons.push_back(polygon_of(values, body));
    }
  }
  if (find(element, {"red", "diffuse_red"})) scene.notes.emplace_back("the colours of the faces are ignored");
  return left_out.on(std::move(scene));
}

Scene without(Scene scene, const PlyElement& element, PlyBody& body) {
  if (element.properties.empty()) return scene;
  for (std::uint64_t k = 0; k < element.count; ++k) {
    for (const PlyProperty& property : element.properties) body.next(property);
  }
  // Lists are of vertices, e.g. strips of triangles.
  const bool has_faces = std::any_of(element.properties.begin(), element.properties.end(),
                                     [](const PlyProperty& property) { return property.is_list; });
  LeftOut left_out;
  if (has_faces && element.count > 0)
    left_out.lose("elements that hold lists and are not faces, left out", element.name);
  else
    left_out.lose_without_area("elements that are neither vertices nor faces, left out", element.name, element.count);
  return left_out.on(std::move(scene));
}

}  // namespace

Scene read_ply(const std::filesystem::path& file, double metres_per_unit) {
  const std::string bytes = read_text(file, file.string(), "the model file");
  const PlyHeader header = read_ply_header(bytes, file.string());
  PlyBody body(bytes, header, file.string());
  Scene scene = scene_without_materials(file.string(), metres_per_unit);
  scene.groups.push_back(file.stem().string());
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") {
      scene = with_vertices(std::move(scene), element, body);
    } else if (element.name == "face") {
      scene = with_faces(std::move(scene), element, body);
    } else {
      scene = without(std::move(scene), element, body);
    }
  }
  for (const Polygon& polygon : scene.polygons) {
    if (*std::max_element(polygon.corners.begin(), polygon.corners.end()) >= scene.vertices.size()) {
      throw InputError(polygon.line > 0 ? file.string() + ":" + std::to_string(polygon.line) : file.string(),
                       "a face has a corner that names no vertex\nhint: export the model again");
    }
  }
  scene.sha256 = sha256({&bytes, 1});
  return scene;
}

}  // namespace patchlight
