#include "patchlight/mesh/refine.h"

#include "patchlight/base/geometry.h"

#include <algorithm>
#include <map>
#include <utility>

namespace patchlight {
namespace {

using Corners = std::array<std::uint32_t, 4>;

// The vertices of a mesh with those that are added.
class Vertices {
 public:
  explicit Vertices(std::vector<Point> points) : points_(std::move(points)) {}

  std::uint32_t middle(std::uint32_t a, std::uint32_t b) {
    const auto [place, is_new] = middles_.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(points_.size()));
    if (is_new) points_.push_back((points_[a] + points_[b]) / 2);
    return place->second;
  }
  std::uint32_t add(const Point& point) {
    points_.push_back(point);
    return static_cast<std::uint32_t>(points_.size() - 1);
  }
  const Point& at(std::uint32_t vertex) const { return points_[vertex]; }
  std::vector<Point> take() { return std::move(points_); }

 private:
  std::vector<Point> points_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles_;
};

// A triangle repeats its last corner.
std::array<Corners, 4> quarters(const Corners& c, bool is_triangle, Vertices& vertices) {
  const std::uint32_t ab = vertices.middle(c[0], c[1]);
  const std::uint32_t bc = vertices.middle(c[1], c[2]);
  if (is_triangle) {
    const std::uint32_t ca = vertices.middle(c[2], c[0]);
    return {{{c[0], ab, ca, ca}, {ab, c[1], bc, bc}, {ca, bc, c[2], c[2]}, {ab, bc, ca, ca}}};
  }
  const std::uint32_t cd = vertices.middle(c[2], c[3]);
  const std::uint32_t da = vertices.middle(c[3], c[0]);
  // The middles of opposite edges bisect each other.
  const std::uint32_t centre = vertices.add((vertices.at(ab) + vertices.at(cd)) / 2);
  return {{{c[0], ab, centre, da}, {ab, c[1], bc, centre}, {centre, bc, c[2], cd}, {da, centre, cd, c[3]}}};
}

}  // namespace

PatchMesh refine(const PatchMesh& mesh) {
  PatchMesh fine;
  Vertices vertices(mesh.vertices);
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (const Corners& corners : quarters(mesh.corners[i], mesh.corner_points(i).count == 3, vertices)) {
      fine.corners.push_back(corners);
      fine.normal.push_back(mesh.normal[i]);
      fine.material.push_back(mesh.material[i]);
      fine.polygon.push_back(mesh.polygon[i]);
      fine.side.push_back(mesh.side[i]);
    }
  }
  fine.vertices = vertices.take();
  fine.area.resize(fine.corners.size());
  for (const PatchIndex first : mesh.first_patch) fine.first_patch.push_back(4 * first);
  for (PatchIndex i = 0; i < fine.size(); ++i) {
    const PatchCorners corners = fine.corner_points(i);
    fine.centroid.push_back(area_centroid(corners));
    fine.area[i] = area_vector(corners).norm();
  }
  return fine;
}

}  // namespace patchlight
