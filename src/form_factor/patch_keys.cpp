#include "patchlight/form_factor/patch_keys.h"

#include "patchlight/base/sampling.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace patchlight {
namespace {

// Coordinates are rounded to this share of the scene's size: far above rounding errors, far below the size of a patch.
constexpr double resolution = 1e-6;

// Where a scene lies: coordinates in it are axes^T (x - centre) / size.
struct Frame {
  Point centre;
  Eigen::Matrix3d axes;
  double size = 1;
};

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
  Frame frame{centre, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments).eigenvectors(),
              std::sqrt(moments.trace())};

  // Each axis points to the side of its third moment.
  Vector third = Vector::Zero();
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    third += mesh.area[i] * (frame.axes.transpose() * (mesh.centroid[i] - centre)).array().cube().matrix();
  }
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (third[axis] < 0) frame.axes.col(axis) *= -1;
  }
  return frame;
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
