#include "render/smooth.h"

#include "base/parallel.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <vector>

namespace patchlight {
namespace {

// Sight lines along a surface run this share of the patch's size above it.
constexpr double lift = 1e-3;

// Patches whose sight lines are traced together.
constexpr std::size_t traced_at_once = 64;

// The sight lines from a point of a patch to its corners.
void add_sight_lines(std::vector<Segment>& lines, const PatchMesh& mesh, PatchIndex patch, const Point& point) {
  const PatchCorners corners = mesh.corner_points(patch);
  const Vector above = lift * (corners.points[2] - corners.points[0]).norm() * mesh.normal[patch];
  const PolygonIndex own = mesh.polygon[patch];
  for (std::size_t k = 0; k < static_cast<std::size_t>(corners.count); ++k)
    lines.push_back({point + above, corners.points[k] + above, own, own});
}

// Which corners of a patch can be seen from a point of it, 1 or 0 each.
std::array<double, 4> corners_seen(const PatchMesh& mesh, const Occluder& occluder, PatchIndex patch,
                                   const Point& point) {
  std::vector<Segment> lines;
  add_sight_lines(lines, mesh, patch, point);
  const auto blocked = occluder.occluded(lines);
  std::array<double, 4> seen{};
  for (std::size_t k = 0; k < blocked.size(); ++k) seen[k] = blocked[k] ? 0 : 1;
  return seen;
}

// Per corner the area of its patch where the centroid sees it, else 0.
CornerWeights weights_of_seen(const PatchMesh& mesh, const Eigen::VectorXd& area, const Occluder& occluder) {
  CornerWeights weights = CornerWeights::Zero(mesh.size(), 4);
  parallel_for((mesh.size() + traced_at_once - 1) / traced_at_once, [&](std::size_t task) {
    const auto first = static_cast<PatchIndex>(task * traced_at_once);
    const auto last = static_cast<PatchIndex>(std::min<std::size_t>(mesh.size(), first + traced_at_once));
    std::vector<Segment> lines;
    for (PatchIndex patch = first; patch < last; ++patch) add_sight_lines(lines, mesh, patch, mesh.centroid[patch]);
    const auto blocked = occluder.occluded(lines);
    std::size_t line = 0;
    for (PatchIndex patch = first; patch < last; ++patch) {
      for (Eigen::Index k = 0; k < mesh.corner_points(patch).count; ++k, ++line)
        weights(patch, k) = blocked[line] ? 0 : area[patch];
    }
  });
  return weights;
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
  CornerWeights weights = weights_of_seen(mesh, area, occluder);
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
