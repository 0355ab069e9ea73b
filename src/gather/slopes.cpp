#include "gather/slopes.h"

#include "base/parallel.h"
#include "mesh/patches_at_vertices.h"
#include "visibility/occluder.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {
namespace {

// Keeps the fit soluble where all neighbours lie in one direction, as a share of the squared distances.
constexpr double damping = 1e-6;

// A plane has two slopes, so that residuals begin with the third neighbour.
constexpr std::size_t slopes_of_a_plane = 2;

// An allowance: of a radiosity that is curved evenly, a sixth of the residual at the patches around is left at the edge
// of the patch, and more where it has a peak narrower than these. docs/theory/irradiance-at-a-point.md has what it
// comes to.
constexpr double residual_inside = 0.5;

// Patches whose radiosities differ by no more than this factor are taken to see each other.
constexpr double about_equal = 1.25;

// How far over the polygon they look for each other, as a share of their distance.
constexpr double height_of_sight = 0.1;

// So few patches of a polygon side may be alike by symmetry, whatever light is on it.
constexpr PatchIndex few_patches = 4;

using Gradient = Eigen::Matrix<double, 3, Eigen::Dynamic>;

// Of a linear function with this gradient, over a patch: per triangle of its fan 1/12 of the sum over the corners of
// the squared differences from its mean, and that of its mean from the patch's.
double variance_over(const PatchMesh& mesh, PatchIndex j, const Vector& gradient) {
  const PatchCorners corners = mesh.corner_points(j);
  const std::span<const Point> points = corners;
  double variance = 0;
  double area = 0;
  for (std::size_t k = 1; k + 1 < points.size(); ++k) {
    const std::array<Point, 3> triangle{points[0], points[k], points[k + 1]};
    const Point centroid = (triangle[0] + triangle[1] + triangle[2]) / 3;
    const double size = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).norm();
    double squares = std::pow(gradient.dot(centroid - mesh.centroid[j]), 2);
    for (const Point& corner : triangle) squares += std::pow(gradient.dot(corner - centroid), 2) / 12;
    variance += size * squares;
    area += size;
  }
  return area > 0 ? variance / area : 0;
}

class Planes {
 public:
  Planes(const PatchMesh& mesh, const FieldView& values, const Occluder& occluder)
      : mesh_(mesh), values_(values), occluder_(occluder), at_vertex_(mesh) {}

  std::vector<PatchIndex> patches_around(PatchIndex j) const;
  Gradient fitted(PatchIndex j, std::span<const PatchIndex> around) const;
  Spectrum residual(PatchIndex j, std::span<const PatchIndex> around, const Gradient& gradient) const;

 private:
  bool are_about_equal(PatchIndex i, PatchIndex j) const;
  std::vector<PatchIndex> in_sight(PatchIndex j, std::span<const PatchIndex> others) const;

  const PatchMesh& mesh_;
  const FieldView& values_;
  const Occluder& occluder_;
  PatchesAtVertices at_vertex_;
};

bool Planes::are_about_equal(PatchIndex i, PatchIndex j) const {
  const auto larger = values_.row(i).max(values_.row(j));
  const auto smaller = values_.row(i).min(values_.row(j));
  return (larger <= about_equal * smaller).all();
}

// Those that nothing hides from this one.
std::vector<PatchIndex> Planes::in_sight(PatchIndex j, std::span<const PatchIndex> others) const {
  std::vector<Segment> segments;
  for (const PatchIndex i : others) {
    const Vector up = height_of_sight * (mesh_.centroid[i] - mesh_.centroid[j]).norm() * mesh_.normal[j];
    segments.push_back({mesh_.centroid[j] + up, mesh_.centroid[i] + up});
  }
  const std::vector<float> arriving = occluder_.transmittance(segments);
  std::vector<PatchIndex> found;
  for (std::size_t k = 0; k < others.size(); ++k) {
    if (arriving[k] > 0) found.push_back(others[k]);
  }
  return found;
}

std::vector<PatchIndex> Planes::patches_around(PatchIndex j) const {
  std::vector<PatchIndex> around;
  for (const std::uint32_t vertex : corner_vertices(mesh_, j)) {
    for (const PatchIndex i : at_vertex_[vertex]) {
      if (i != j && mesh_.polygon[i] == mesh_.polygon[j] && mesh_.side[i] == mesh_.side[j]) around.push_back(i);
    }
  }
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  const auto unequal =
      std::stable_partition(around.begin(), around.end(), [&](PatchIndex i) { return are_about_equal(i, j); });
  if (unequal == around.end()) return around;
  const std::vector<PatchIndex> seen = in_sight(j, std::span<const PatchIndex>(unequal, around.end()));
  around.erase(unequal, around.end());
  around.insert(around.end(), seen.begin(), seen.end());
  return around;
}

// (sum d d^T) g = sum d (B_i - B_j), d the way from one centroid to the other; without slopes that would make the plane
// negative at a corner.
Gradient Planes::fitted(PatchIndex j, std::span<const PatchIndex> around) const {
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  Gradient products = Gradient::Zero(3, values_.cols());
  for (const PatchIndex i : around) {
    const Vector d = mesh_.centroid[i] - mesh_.centroid[j];
    squares += d * d.transpose();
    products += d * (values_.row(i) - values_.row(j)).matrix();
  }
  const double size = squares.trace();
  if (!(size > 0)) return Gradient::Zero(3, values_.cols());
  squares += size * (mesh_.normal[j] * mesh_.normal[j].transpose() + damping * Eigen::Matrix3d::Identity());
  Gradient gradient = squares.ldlt().solve(products);
  const PatchCorners corners = mesh_.corner_points(j);
  for (Eigen::Index band = 0; band < values_.cols(); ++band) {
    double least = 0;
    for (const Point& corner : std::span<const Point>(corners))
      least = std::min(least, gradient.col(band).dot(corner - mesh_.centroid[j]));
    if (least < 0) gradient.col(band) *= std::clamp(values_(j, band) / -least, 0.0, 1.0);
  }
  return gradient;
}

// Root mean square, by the degrees of freedom that the fit leaves; never more than the differences themselves.
Spectrum Planes::residual(PatchIndex j, std::span<const PatchIndex> around, const Gradient& gradient) const {
  Spectrum squares = Spectrum::Zero(values_.cols());
  Spectrum differences = Spectrum::Zero(values_.cols());
  for (const PatchIndex i : around) {
    const Vector d = mesh_.centroid[i] - mesh_.centroid[j];
    const Spectrum difference = values_.row(i) - values_.row(j);
    squares += (difference - (d.transpose() * gradient).array()).square();
    differences += difference.square();
  }
  const auto count = static_cast<double>(around.size());
  if (around.size() <= slopes_of_a_plane) return (differences / std::max(count, 1.0)).sqrt();
  return (squares / (count - slopes_of_a_plane)).min(differences / count).sqrt();
}

bool has_few_patches(const PatchMesh& mesh, PatchIndex j) {
  const auto [begin, end] = mesh.patches_on(mesh.polygon[j], mesh.side[j]);
  return end - begin <= few_patches;
}

}  // namespace

Slopes slopes_of(const PatchMesh& mesh, const FieldView& values, const Occluder& occluder,
                 const RadiosityErrors& errors, const Observer& observer) {
  const Planes planes(mesh, values, occluder);
  const Field& display = errors.display;
  const Field zero = Field::Zero(values.rows(), values.cols());
  Slopes found{Field::Zero(values.rows(), 3 * values.cols()), zero, zero};
  parallel_for(mesh.size(), Stage::gather, observer, [&](std::size_t row) {
    const auto j = static_cast<PatchIndex>(row);
    const std::vector<PatchIndex> around = planes.patches_around(j);
    const Gradient gradient = planes.fitted(j, around);
    found.residual.row(j) = residual_inside * planes.residual(j, around, gradient);
    for (Eigen::Index band = 0; band < values.cols(); ++band) {
      found.gradient.row(j).segment(3 * band, 3) = gradient.col(band).transpose().array();
      if (display.size() == 0) continue;
      const double unexplained = std::pow(display(j, band), 2) - variance_over(mesh, j, gradient.col(band));
      found.unknown(j, band) = std::sqrt(std::max(0.0, unexplained));
    }
    if (display.size() == 0 && errors.reflected.size() > 0 && has_few_patches(mesh, j))
      found.unknown.row(j) = errors.reflected.row(j);
  });
  return found;
}

}  // namespace patchlight
