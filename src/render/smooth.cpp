#include "render/smooth.h"

#include "visibility/occluder.h"

#include <vector>

namespace patchlight {
namespace {

// Sight lines along a surface run this share of the patch's size above it.
constexpr double lift = 1e-3;

// Which corners of a patch can be seen from a point of it, 1 or 0 each.
std::array<double, 4> corners_seen(const PatchMesh& mesh, const Occluder& occluder, PatchIndex patch,
                                   const Point& point) {
  const PatchCorners corners = mesh.corner_points(patch);
  const Vector above = lift * (corners.points[2] - corners.points[0]).norm() * mesh.normal[patch];
  const PolygonIndex own = mesh.polygon[patch];
  std::vector<Segment> lines;
  for (std::size_t k = 0; k < static_cast<std::size_t>(corners.count); ++k) {
    lines.push_back({point + above, corners.points[k] + above, own, own});
  }
  const auto blocked = occluder.occluded(lines);
  std::array<double, 4> seen{};
  for (std::size_t k = 0; k < blocked.size(); ++k) seen[k] = blocked[k] ? 0 : 1;
  return seen;
}

// A vertex that no patch sees takes all of them.
CornerWeights with_every_vertex(const PatchMesh& mesh, CornerWeights weights, const Eigen::VectorXd& area) {
  std::vector<double> total(mesh.vertices.size(), 0);
  const auto count = [&](PatchIndex patch) { return mesh.corner_points(patch).count; };
  for (PatchIndex patch = 0; patch < mesh.size(); ++patch) {
    for (int k = 0; k < count(patch); ++k) total[mesh.corners[patch][static_cast<std::size_t>(k)]] += weights(patch, k);
  }
  for (PatchIndex patch = 0; patch < mesh.size(); ++patch) {
    for (int k = 0; k < count(patch); ++k) {
      if (total[mesh.corners[patch][static_cast<std::size_t>(k)]] == 0) weights(patch, k) = area[patch];
    }
  }
  return weights;
}

}  // namespace

SmoothField smooth(const PatchMesh& mesh, const FieldView& patch_values, const Eigen::VectorXd& area,
                   const Occluder& occluder) {
  CornerWeights weights(mesh.size(), 4);
  for (PatchIndex patch = 0; patch < mesh.size(); ++patch) {
    const auto seen = corners_seen(mesh, occluder, patch, mesh.centroid[patch]);
    for (Eigen::Index k = 0; k < 4; ++k) weights(patch, k) = seen[static_cast<std::size_t>(k)] * area[patch];
  }
  const CornerWeights complete = with_every_vertex(mesh, weights, area);
  return {vertex_means(mesh, patch_values, complete), std::move(weights)};
}

Eigen::Array<double, 1, Eigen::Dynamic> value_at(const PatchMesh& mesh, const SmoothField& field,
                                                 const Occluder& occluder, PatchIndex patch, const Point& point) {
  std::array<double, 4> weights = interpolation_weights(mesh, patch, point);
  const bool divided = (field.weights.row(patch).head(mesh.corner_points(patch).count) == 0).any();
  if (!divided) return interpolate(mesh, field.at_vertices, patch, weights);

  // Of the corners that this point cannot see, none counts; if it sees none at all, all do.
  const auto seen = corners_seen(mesh, occluder, patch, point);
  double total = 0;
  for (std::size_t k = 0; k < 4; ++k) total += seen[k] * weights[k];
  if (total > 0) {
    for (std::size_t k = 0; k < 4; ++k) weights[k] *= seen[k] / total;
  }
  return interpolate(mesh, field.at_vertices, patch, weights);
}

}  // namespace patchlight
