#include "scene/model_face.h"

namespace patchlight {

ModelFace model_face(const Scene& scene, const Polygon& polygon) {
  ModelFace face{.corners = {}, .file = polygon.file, .line = polygon.line, .face = polygon.face};
  for (const std::uint32_t corner : polygon.corners) face.corners.push_back(scene.vertices[corner]);
  return face;
}

double area_of(const std::vector<ModelFace>& faces) {
  double area = 0;
  for (const ModelFace& face : faces) area += area_vector(face.corners).norm();
  return area;
}

bool is_loss(DiagnosticCode code) {
  return code == DiagnosticCode::left_out || code == DiagnosticCode::little_left_out;
}

std::set<std::string> objects_with_faces(const Scene& scene) {
  std::vector<std::uint8_t> has_polygon(scene.groups.size(), 0);
  for (const Polygon& polygon : scene.polygons) {
    if (polygon.group < scene.groups.size()) has_polygon[polygon.group] = 1;
  }
  std::set<std::string> names;
  for (std::size_t group = 0; group < scene.groups.size(); ++group) {
    if (has_polygon[group] != 0 && !scene.groups[group].empty()) names.insert(scene.groups[group]);
  }
  return names;
}

std::string counted(std::size_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string listed(const Scene& scene, const std::vector<ModelFace>& faces) {
  Polygon first;
  first.file = faces.front().file;
  first.line = faces.front().line;
  first.group = static_cast<std::uint32_t>(scene.groups.size());  // unknown
  return counted(faces.size(), "face") + (faces.size() == 1 ? " (" : " (first at ") + place_of(scene, first) + ")";
}

}  // namespace patchlight
