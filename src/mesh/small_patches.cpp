#include "mesh/small_patches.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <numeric>
#include <vector>

namespace patchlight {

double mean_area(std::span<const double> areas) {
  return std::accumulate(areas.begin(), areas.end(), 0.0) / static_cast<double>(areas.size());
}

double mean_area(const PatchMesh& mesh) { return mean_area(std::span<const double>(mesh.area)); }

double small_area(const PatchMesh& mesh) { return mean_area(mesh) / 16; }

PatchMesh without_patches(const PatchMesh& mesh, std::span<const std::uint8_t> is_left_out) {
  assert(is_left_out.size() == mesh.size() && mesh.middles.empty());
  constexpr std::uint32_t none = ~std::uint32_t{0};
  PatchMesh kept;
  kept.sheets = mesh.sheets;
  std::vector<std::uint32_t> number(mesh.vertices.size(), none);
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (const std::uint32_t vertex : mesh.corners[i]) number[vertex] = is_left_out[i] ? number[vertex] : 0;
  }
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == none) continue;
    number[v] = static_cast<std::uint32_t>(kept.vertices.size());
    kept.vertices.push_back(mesh.vertices[v]);
  }
  std::size_t slot = 0;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (; mesh.first_patch[slot] <= i; ++slot) kept.first_patch.push_back(kept.size());
    if (is_left_out[i]) continue;
    std::array<std::uint32_t, 4> corners = mesh.corners[i];
    for (std::uint32_t& corner : corners) corner = number[corner];
    kept.corners.push_back(corners);
    kept.centroid.push_back(mesh.centroid[i]);
    kept.normal.push_back(mesh.normal[i]);
    kept.area.push_back(mesh.area[i]);
    kept.material.push_back(mesh.material[i]);
    kept.polygon.push_back(mesh.polygon[i]);
    kept.side.push_back(mesh.side[i]);
  }
  for (; slot < mesh.first_patch.size(); ++slot) kept.first_patch.push_back(kept.size());
  return kept;
}

namespace {

// The middle of the edge that begins at a corner.
Point middle(const PatchCorners& patch, int corner) {
  const auto next = static_cast<std::size_t>((corner + 1) % patch.count);
  return (patch.points[static_cast<std::size_t>(corner)] + patch.points[next]) / 2;
}

PatchCorners triangle(const Point& a, const Point& b, const Point& c) { return {{a, b, c, c}, 3}; }

bool is_left_of(const Point& from, const Point& to, const Vector& normal, const Point& point) {
  return normal.dot((to - from).cross(point - from)) > 0;
}

}  // namespace

PatchCorners quarter_of(const PatchCorners& patch, int quarter) {
  const auto& c = patch.points;
  const Point ab = middle(patch, 0), bc = middle(patch, 1);
  if (patch.count == 3) {
    const Point ca = middle(patch, 2);
    if (quarter == 0) return triangle(c[0], ab, ca);
    if (quarter == 1) return triangle(ab, c[1], bc);
    return quarter == 2 ? triangle(ca, bc, c[2]) : triangle(ab, bc, ca);
  }
  const Point cd = middle(patch, 2), da = middle(patch, 3);
  const Point centre = (ab + cd) / 2;
  if (quarter == 0) return {{c[0], ab, centre, da}, 4};
  if (quarter == 1) return {{ab, c[1], bc, centre}, 4};
  return quarter == 2 ? PatchCorners{{centre, bc, c[2], cd}, 4} : PatchCorners{{da, centre, cd, c[3]}, 4};
}

int quarter_at(const PatchCorners& patch, const Vector& normal, const Point& point) {
  const Point ab = middle(patch, 0), bc = middle(patch, 1);
  if (patch.count == 3) {
    const Point ca = middle(patch, 2);
    if (is_left_of(ca, ab, normal, point) == is_left_of(ca, ab, normal, patch.points[0])) return 0;
    if (is_left_of(ab, bc, normal, point) == is_left_of(ab, bc, normal, patch.points[1])) return 1;
    return is_left_of(bc, ca, normal, point) == is_left_of(bc, ca, normal, patch.points[2]) ? 2 : 3;
  }
  // The line through the middles of the second and the last edge divides the corners 0 and 1 from 2 and 3.
  const Point cd = middle(patch, 2), da = middle(patch, 3);
  const bool near_first_edge = is_left_of(bc, da, normal, point) == is_left_of(bc, da, normal, patch.points[0]);
  const bool near_last_edge = is_left_of(ab, cd, normal, point) == is_left_of(ab, cd, normal, patch.points[0]);
  if (near_first_edge) return near_last_edge ? 0 : 1;
  return near_last_edge ? 3 : 2;
}

}  // namespace patchlight
