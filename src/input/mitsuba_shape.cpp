#include "input/mitsuba_shape.h"

#include "patchlight/base/error.h"

#include "input/read_obj.h"
#include "input/read_ply.h"
#include "input/text.h"
#include "scene/problem_face.h"

#include <algorithm>
#include <array>
#include <system_error>

namespace patchlight {
namespace {

constexpr std::array shapes = {"obj", "ply", "rectangle", "cube", "sphere", "disk", "cylinder"};

// From -1 to 1 in x and y; its front looks along +z.
FacetedShape rectangle() { return {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2, 3}}}; }

// From -1 to 1, fronts outward.
FacetedShape cube() {
  FacetedShape shape;
  for (const double z : {-1., 1.})
    for (const double y : {-1., 1.})
      for (const double x : {-1., 1.}) shape.points.emplace_back(x, y, z);
  shape.faces = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  return shape;
}

FacetedShape faces_of(Scene scene) {
  FacetedShape shape;
  shape.points = std::move(scene.vertices);
  for (Polygon& polygon : scene.polygons) shape.faces.push_back(std::move(polygon.corners));
  return shape;
}

std::optional<FacetedShape> mesh_of(const MitsubaFile& file, const pugi::xml_node& shape, const std::string& kind,
                                    MitsubaMeshes& meshes) {
  const std::string place = file.place(shape);
  const std::string name = file.word(shape, "filename", "");
  if (name.empty()) throw InputError(place, "the shape has no filename; expected the name of a mesh");
  const std::filesystem::path path = std::filesystem::path(file.files()[0]->file).parent_path() / name;
  require_within(meshes.confine, path, place);
  const auto [found, is_new] = meshes.by_file.try_emplace(path.lexically_normal().string());
  std::error_code error;
  if (!is_new || !std::filesystem::is_regular_file(path, error)) return found->second;
  Scene scene = kind == "obj" ? read_obj(path, 1, meshes.confine) : read_ply(path, 1);
  meshes.files.push_back(path);
  meshes.digests.push_back(scene.sha256);
  for (const Problem& problem : scene.problems) {
    if (is_loss(problem.kind)) meshes.losses.push_back(problem);
  }
  found->second = faces_of(std::move(scene));
  return found->second;
}

FacetedShape cylinder_of(const MitsubaFile& file, const pugi::xml_node& shape) {
  return faceted_cone(file.vector(shape, "p0", Vector(0, 0, 0)), file.vector(shape, "p1", Vector(0, 0, 1)),
                      file.number(shape, "radius", 1), file.number(shape, "radius", 1));
}

}  // namespace

bool is_mitsuba_shape(const std::string& kind) { return std::find(shapes.begin(), shapes.end(), kind) != shapes.end(); }

std::optional<FacetedShape> mitsuba_shape(const MitsubaFile& file, const pugi::xml_node& shape, MitsubaMeshes& meshes) {
  const std::string kind = file.text(shape, "type");
  if (kind == "obj" || kind == "ply") return mesh_of(file, shape, kind, meshes);
  if (kind == "rectangle") return rectangle();
  if (kind == "cube") return cube();
  if (kind == "disk") return faceted_ring(Point::Zero(), Vector::UnitZ(), 0, 1);
  if (kind == "cylinder" || kind == "sphere") {
    const double radius = file.number(shape, "radius", 1);
    if (!(radius > 0))
      throw InputError(file.place(shape), "the " + kind + " has a radius of 0 or less; expected one above 0");
    const FacetedShape found = kind == "sphere" ? faceted_sphere(file.vector(shape, "center", Vector::Zero()), radius)
                                                : cylinder_of(file, shape);
    if (found.faces.empty()) throw InputError(file.place(shape), "the cylinder has no length; expected two places");
    return found;
  }
  return std::nullopt;
}

}  // namespace patchlight
