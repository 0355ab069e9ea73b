#include "patchlight/form_factor/patch_keys.h"

#include "patchlight/base/sampling.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace patchlight {
namespace {

// Coordinates are rounded to this share of the scene's size: far above the rounding errors of files in single
// precision.
constexpr double resolution = 1e-4;

// Two moments that differ by less than this share of their sum are equal: rounding alone would decide.
constexpr double ambiguity = 1e-6;

// Where a scene lies: coordinates in it are axes^T (x - centre) / size.
struct Frame {
  Point centre;
  Eigen::Matrix3d axes;
  double size = 1;
};

// The principal axes of the second moments; the axes of the file where these are ambiguous.
Eigen::Matrix3d principal_axes(const Eigen::Matrix3d& moments) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments);
  const Eigen::Vector3d& values = solver.eigenvalues();
  const double smallest_gap = std::min(values[1] - values[0], values[2] - values[1]);
  return smallest_gap > ambiguity * values.sum() ? solver.eigenvectors() : Eigen::Matrix3d::Identity();
}

// Each axis points to the side of its third moment, or if that vanishes to the side of its largest coordinate.
Eigen::Matrix3d oriented(Eigen::Matrix3d axes, const Point& centre, double size, const PatchMesh& mesh) {
  Vector third = Vector::Zero();
  double total = 0;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    third += mesh.area[i] * (axes.transpose() * (mesh.centroid[i] - centre)).array().cube().matrix();
    total += mesh.area[i];
  }
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    Eigen::Index largest = 0;
    axes.col(axis).cwiseAbs().maxCoeff(&largest);
    const bool symmetric = std::abs(third[axis]) <= ambiguity * total * size * size * size;
    const double direction = symmetric ? axes(largest, axis) : third[axis];
    if (direction < 0) axes.col(axis) *= -1;
  }
  return axes;
}

Frame scene_frame(const PatchMesh& mesh) {
  // Centroid and second moments by area.
  double total = 0;
  Vector sum = Vector::Zero();
  const Point origin = mesh.centroid[0];
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    total += mesh.area[i];
    sum += mesh.area[i] * (mesh.centroid[i] - origin);
  }
  const Point centre = origin + sum / total;
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const Vector offset = mesh.centroid[i] - centre;
    moments += mesh.area[i] / total * offset * offset.transpose();
  }
  const double size = std::sqrt(moments.trace());
  return {centre, oriented(principal_axes(moments), centre, size, mesh), size};
}

std::uint64_t rounded(double x) { return static_cast<std::uint64_t>(std::llround(x / resolution)); }

}  // namespace

std::vector<std::uint32_t> patch_keys(const PatchMesh& mesh) {
  std::vector<std::uint32_t> keys;
  if (mesh.size() == 0) return keys;
  const Frame frame = scene_frame(mesh);
  const double scale = frame.size > 0 ? 1 / frame.size : 1;
  keys.reserve(mesh.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const Vector position = scale * frame.axes.transpose() * (mesh.centroid[i] - frame.centre);
    const double facing = mesh.normal[i].dot(frame.axes * Vector(1, 2, 4));  // tells the two sides of a polygon apart
    keys.push_back(hash({rounded(position.x()), rounded(position.y()), rounded(position.z()), facing > 0 ? 1U : 0U}));
  }
  return keys;
}

}  // namespace patchlight
