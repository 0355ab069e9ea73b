#include "gather/slopes.h"

#include "base/parallel.h"
#include "mesh/patches_at_vertices.h"
#include "visibility/occluder.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace patchlight {
namespace {

// Keeps the fit soluble where all neighbours lie in one direction, as a share of the squared distances.
constexpr double damping = 1e-6;

// A plane has two slopes, so that residuals begin with the third neighbour.
constexpr std::size_t slopes_of_a_plane = 2;

// Where the radiosity is curved, what is left at the centroids of the patches around is a multiple of what is left
// inside the patch, where it has no peak narrower than these: measured (tests/hard_cases/coarse_patches_test.cpp).
constexpr double left_inside = 0.5;

using Gradient = Eigen::Matrix<double, 3, Eigen::Dynamic>;

// Patches whose radiosities differ by no more than this factor are taken to see each other.
constexpr double most_alike = 2;

// How far over the polygon they look for each other, as a share of their distance.
constexpr double height_of_look = 0.1;

bool are_alike(const FieldView& values, PatchIndex i, PatchIndex j) {
  const auto larger = values.row(i).max(values.row(j));
  const auto smaller = values.row(i).min(values.row(j));
  return (larger <= most_alike * smaller).all();
}

// Those of the patches that light as much, or that nothing hides from this one.
std::vector<PatchIndex> those_in_sight(const PatchMesh& mesh, const FieldView& values, const Occluder& occluder,
                                       PatchIndex j, std::span<const PatchIndex> around) {
  std::vector<Segment> segments;
  std::vector<PatchIndex> others;
  std::vector<PatchIndex> found;
  for (const PatchIndex i : around) {
    if (are_alike(values, i, j)) {
      found.push_back(i);
      continue;
    }
    const Vector up = height_of_look * (mesh.centroid[i] - mesh.centroid[j]).norm() * mesh.normal[j];
    segments.push_back({mesh.centroid[j] + up, mesh.centroid[i] + up});
    others.push_back(i);
  }
  if (others.empty()) return found;
  const std::vector<float> arriving = occluder.transmittance(segments);
  for (std::size_t k = 0; k < others.size(); ++k) {
    if (arriving[k] > 0) found.push_back(others[k]);
  }
  return found;
}

// The patches of the same polygon side that share a vertex: one that shares two counts twice.
std::vector<PatchIndex> patches_around(const PatchMesh& mesh, const PatchesAtVertices& at_vertex, PatchIndex j) {
  std::vector<PatchIndex> around;
  for (const std::uint32_t vertex : corner_vertices(mesh, j)) {
    for (const PatchIndex i : at_vertex[vertex]) {
      if (i != j && mesh.polygon[i] == mesh.polygon[j] && mesh.side[i] == mesh.side[j]) around.push_back(i);
    }
  }
  return around;
}

// (sum d d^T) g = sum d (B_i - B_j), d the way from one centroid to the other
Gradient fitted(const PatchMesh& mesh, const FieldView& values, PatchIndex j, std::span<const PatchIndex> around) {
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  Gradient products = Gradient::Zero(3, values.cols());
  for (const PatchIndex i : around) {
    const Vector d = mesh.centroid[i] - mesh.centroid[j];
    squares += d * d.transpose();
    products += d * (values.row(i) - values.row(j)).matrix();
  }
  const double size = squares.trace();
  if (!(size > 0)) return Gradient::Zero(3, values.cols());
  squares += size * (mesh.normal[j] * mesh.normal[j].transpose() + damping * Eigen::Matrix3d::Identity());
  return squares.ldlt().solve(products);
}

Spectrum residual(const PatchMesh& mesh, const FieldView& values, PatchIndex j, std::span<const PatchIndex> around,
                  const Gradient& gradient) {
  Spectrum squares = Spectrum::Zero(values.cols());
  Spectrum differences = Spectrum::Zero(values.cols());
  for (const PatchIndex i : around) {
    const Vector d = mesh.centroid[i] - mesh.centroid[j];
    const Spectrum difference = values.row(i) - values.row(j);
    squares += (difference - (d.transpose() * gradient).array()).square();
    differences += difference.square();
  }
  const auto count = static_cast<double>(around.size());
  if (around.size() <= slopes_of_a_plane) return (differences / std::max(count, 1.0)).sqrt();
  return (squares / (count - slopes_of_a_plane)).min(differences / count).sqrt();
}

// The least and the largest of a plane at the corners of its patch, less the mean.
std::pair<double, double> range_on(const PatchMesh& mesh, PatchIndex j, const Vector& gradient) {
  const PatchCorners corners = mesh.corner_points(j);
  double least = 0;
  double most = 0;
  for (const Point& corner : std::span<const Point>(corners)) {
    const double more = gradient.dot(corner - mesh.centroid[j]);
    least = std::min(least, more);
    most = std::max(most, more);
  }
  return {least, most};
}

}  // namespace

Slopes slopes_of(const PatchMesh& mesh, const FieldView& values, const Occluder& occluder, const Field& within) {
  const PatchesAtVertices at_vertex(mesh);
  Slopes found{Field::Zero(values.rows(), 3 * values.cols()), Field::Zero(values.rows(), values.cols())};
  parallel_for(mesh.size(), [&](std::size_t row) {
    const auto j = static_cast<PatchIndex>(row);
    const std::vector<PatchIndex> around =
        those_in_sight(mesh, values, occluder, j, patches_around(mesh, at_vertex, j));
    Gradient gradient = fitted(mesh, values, j, around);
    found.left.row(j) = left_inside * residual(mesh, values, j, around, gradient);
    for (Eigen::Index band = 0; band < values.cols(); ++band) {
      auto [least, most] = range_on(mesh, j, gradient.col(band));
      const double steepest = least < 0 ? std::clamp(values(j, band) / -least, 0.0, 1.0) : 1;
      gradient.col(band) *= steepest;
      found.gradient.row(j).segment(3 * band, 3) = gradient.col(band).transpose().array();
      if (within.size() == 0) continue;
      // Over a parallelogram, edges along and across the slope, its variance is range^2 / 12.
      const double range = steepest * (most - least);
      const double unexplained = within(j, band) * within(j, band) - range * range / 12;
      if (unexplained > 0) found.left(j, band) = std::max(found.left(j, band), std::sqrt(unexplained));
    }
  });
  return found;
}

}  // namespace patchlight
