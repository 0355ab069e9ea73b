#include "form_factor/patch_keys.h"

#include "base/sampling.h"

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

// Calls use(A, B, C) for the triangles of a patch.
template <typename Use>
void for_triangles(const PatchMesh& mesh, PatchIndex patch, Use use) {
  const PatchCorners corners = mesh.corner_points(patch);
  for (std::size_t k = 2; k < static_cast<std::size_t>(corners.count); ++k)
    use(corners.points[0], corners.points[k - 1], corners.points[k]);
}

double triangle_area(const Point& a, const Point& b, const Point& c) { return (b - a).cross(c - a).norm() / 2; }

// The integral of x x^T over a triangle.
Eigen::Matrix3d second_moments(const Vector& a, const Vector& b, const Vector& c) {
  const Vector sum = a + b + c;
  return triangle_area(a, b, c) / 12 *
         (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
}

// The integral over a triangle of the cube of each coordinate: a tenth of the area times the sum of all ten products of
// three of its values at the corners.
Vector third_moments(const Vector& a, const Vector& b, const Vector& c) {
  const Eigen::Array3d x = a.array(), y = b.array(), z = c.array();
  const Eigen::Array3d products =
      x.cube() + y.cube() + z.cube() + x.square() * (y + z) + y.square() * (x + z) + z.square() * (x + y) + x * y * z;
  return triangle_area(a, b, c) / 10 * products.matrix();
}

// Each axis points to the side of its third moment, or if that vanishes to the side of its largest coordinate.
Eigen::Matrix3d oriented(Eigen::Matrix3d axes, const Point& centre, double size, const PatchMesh& mesh) {
  Vector third = Vector::Zero();
  double total = 0;
  const auto local = [&](const Point& point) -> Vector { return axes.transpose() * (point - centre); };
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for_triangles(mesh, i, [&](const Point& a, const Point& b, const Point& c) {
      third += third_moments(local(a), local(b), local(c));
    });
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

// By moments of the surfaces, not of the patches' centroids: however they are cut, it stays.
Frame scene_frame(const PatchMesh& mesh) {
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
    for_triangles(mesh, i, [&](const Point& a, const Point& b, const Point& c) {
      moments += second_moments(a - centre, b - centre, c - centre) / total;
    });
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
