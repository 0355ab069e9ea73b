#include "scene/problem_face.h"

#include <sstream>

namespace patchlight {

ProblemFace problem_face(const Scene& scene, const Polygon& polygon) {
  ProblemFace face{.corners = {}, .file = polygon.file, .line = polygon.line, .face = polygon.face};
  for (const std::uint32_t corner : polygon.corners) face.corners.push_back(scene.vertices[corner]);
  return face;
}

std::string counted(std::size_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string listed(const Scene& scene, const std::vector<ProblemFace>& faces) {
  Polygon first;
  first.file = faces.front().file;
  first.line = faces.front().line;
  first.group = static_cast<std::uint32_t>(scene.groups.size());  // unknown
  std::ostringstream text;
  text << counted(faces.size(), "face") << (faces.size() == 1 ? " (" : " (first at ") << place_of(scene, first) << ')';
  return text.str();
}

}  // namespace patchlight
