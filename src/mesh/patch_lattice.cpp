#include "mesh/patch_lattice.h"

#include <algorithm>
#include <cmath>

namespace patchlight {
namespace {

// The patches of a lattice are at their places up to this share of their edges.
constexpr double lattice_tolerance = 1e-6;

// Do the corners of a parallelogram lie at -1/2 and 1/2 along both directions, counted from its centroid?
bool is_cell(const PatchMesh& mesh, PatchIndex patch, const Vector& to_u, const Vector& to_v) {
  const PatchCorners corners = mesh.corner_points(patch);
  return corners.count == 4 && std::all_of(corners.points.begin(), corners.points.end(), [&](const Point& corner) {
           const Vector from = corner - mesh.centroid[patch];
           return std::abs(std::abs(from.dot(to_u)) - 0.5) <= lattice_tolerance &&
                  std::abs(std::abs(from.dot(to_v)) - 0.5) <= lattice_tolerance;
         });
}

}  // namespace

std::optional<PatchLattice> lattice_of(const PatchMesh& mesh, PatchRange range) {
  // 1. The first row, as long as centroids are evenly spaced; then the step from row to row.
  const PatchIndex count = range.end - range.begin;
  const Point& first = mesh.centroid[range.begin];
  const Vector u = mesh.centroid[range.begin + 1] - first;
  const auto is_at = [&](PatchIndex k, const Point& place) {
    return (mesh.centroid[range.begin + k] - place).norm() <= lattice_tolerance * u.norm();
  };
  PatchIndex row = 1;
  while (row < count && is_at(row, first + row * u)) ++row;
  if (count % row != 0) return std::nullopt;
  const PatchCorners corners = mesh.corner_points(range.begin);
  const Vector edge = corners.points[1] - corners.points[0];
  const Vector other = corners.points[3] - corners.points[0];
  const Vector v = row < count                                    ? Vector(mesh.centroid[range.begin + row] - first)
                   : edge.cross(u).norm() > other.cross(u).norm() ? edge
                                                                  : other;

  // 2. All of them are parallelograms in their places. The dual vectors: u . to_u = 1, v . to_u = 0.
  const Vector normal = u.cross(v);
  const double squared = normal.squaredNorm();
  if (!(squared > 0)) return std::nullopt;
  const Vector to_u = v.cross(normal) / squared;
  const Vector to_v = normal.cross(u) / squared;
  for (PatchIndex k = 0; k < count; ++k) {
    if (!is_at(k, first + k % row * u + k / row * v) || !is_cell(mesh, range.begin + k, to_u, to_v))
      return std::nullopt;
  }
  return PatchLattice{first - 0.5 * u - 0.5 * v, to_u, to_v, static_cast<int>(row), static_cast<int>(count / row)};
}

PatchIndex PatchLattice::patch_at(const Point& point) const {
  const Vector to = point - origin;
  const auto place = [](double at, int count) { return static_cast<int>(std::clamp(at, 0.0, count - 0.5)); };
  const int column = place(to.dot(to_u), count_u);
  const int row = place(to.dot(to_v), count_v);
  return static_cast<PatchIndex>(row * count_u + column);
}

}  // namespace patchlight
