#include "mesh/interpolate.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace patchlight {
namespace {

// The middles of edges that are those of a patch still, in the order of the cuts.
std::vector<Middle> hanging(const PatchMesh& mesh) {
  if (mesh.middles.empty()) return {};
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& c : mesh.corners) {
    for (std::size_t k = 0; k < 4; ++k) edges.insert(std::minmax(c[k], c[(k + 1) % 4]));
  }
  std::vector<Middle> found;
  for (const Middle& middle : mesh.middles) {
    if (edges.contains(std::minmax(middle.ends[0], middle.ends[1]))) found.push_back(middle);
  }
  return found;
}

using Weights = std::array<double, 4>;

// Shares of the triangle's area opposite to each corner, clamped to the triangle.
Weights barycentric(const PatchCorners& patch, const Vector& normal, const Point& point) {
  const auto& [a, b, c, unused] = patch.points;
  const auto area = [&](const Point& q, const Point& r) {
    return std::max(0.0, normal.dot((q - point).cross(r - point)));
  };
  const double weight_a = area(b, c), weight_b = area(c, a), weight_c = area(a, b);
  const double sum = weight_a + weight_b + weight_c;
  return {weight_a / sum, weight_b / sum, weight_c / sum, 0};
}

// Solves q = s e + t f + s t g for the point q in the quadrilateral a, a + e, a + e + f + g, a + f.
// Eliminating s gives k2 t^2 + k1 t + k0 = 0; the root wanted is the one where the map's Jacobian
// k1 + 2 k2 t = sqrt(k1^2 - 4 k2 k0) is positive. It is taken in the form that does not cancel; k2 may be zero.
Weights inverse_bilinear(const PatchCorners& patch, const Vector& normal, const Point& point) {
  const auto& [a, b, c, d] = patch.points;
  const Vector e = b - a, f = d - a, g = (c - b) - (d - a), q = point - a;
  const auto cross = [&](const Vector& x, const Vector& y) { return normal.dot(x.cross(y)); };
  const double k2 = cross(g, f);
  const double k1 = cross(q, g) + cross(e, f);
  const double k0 = cross(q, e);
  const double jacobian = std::sqrt(std::max(0.0, k1 * k1 - 4 * k2 * k0));
  const double root = k1 >= 0 ? -2 * k0 / (k1 + jacobian) : (jacobian - k1) / (2 * k2);
  const double t = std::isfinite(root) ? std::clamp(root, 0.0, 1.0) : 0.0;
  const Vector along = e + t * g;
  const double s = std::clamp((q - t * f).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return {(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t};
}

}  // namespace

Field vertex_means(const PatchMesh& mesh, const FieldView& patch_values, const CornerWeights& weights) {
  Field sum = Field::Zero(static_cast<Eigen::Index>(mesh.vertices.size()), patch_values.cols());
  std::vector<double> total(mesh.vertices.size(), 0);
  for (PatchIndex patch = 0; patch < mesh.size(); ++patch) {
    const int count = mesh.corner_points(patch).count;
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
      const std::uint32_t vertex = mesh.corners[patch][k];
      const double weight = weights(patch, static_cast<Eigen::Index>(k));
      sum.row(vertex) += weight * patch_values.row(patch);
      total[vertex] += weight;
    }
  }
  for (std::size_t vertex = 0; vertex < total.size(); ++vertex) {
    if (total[vertex] > 0) sum.row(static_cast<Eigen::Index>(vertex)) /= total[vertex];
  }
  // On the edge of a patch that was not cut a value between those at the edge's ends, as it has there itself. The ends
  // may hang on longer edges; these have been cut before.
  for (const Middle& middle : hanging(mesh))
    sum.row(middle.vertex) = (sum.row(middle.ends[0]) + sum.row(middle.ends[1])) / 2;
  return sum;
}

std::array<double, 4> interpolation_weights(const PatchMesh& mesh, PatchIndex patch, const Point& point) {
  const PatchCorners corners = mesh.corner_points(patch);
  const Vector& normal = mesh.normal[patch];
  return corners.count == 3 ? barycentric(corners, normal, point) : inverse_bilinear(corners, normal, point);
}

Eigen::Array<double, 1, Eigen::Dynamic> interpolate(const PatchMesh& mesh, const FieldView& vertex_values,
                                                    PatchIndex patch, const std::array<double, 4>& weights) {
  Eigen::Array<double, 1, Eigen::Dynamic> value = Eigen::Array<double, 1, Eigen::Dynamic>::Zero(vertex_values.cols());
  for (std::size_t k = 0; k < 4; ++k) value += weights[k] * vertex_values.row(mesh.corners[patch][k]);
  return value;
}

}  // namespace patchlight
