#include "mesh/nested_mesh.h"

#include "mesh/refine.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace patchlight {
namespace {

double longest_edge(const PatchMesh& mesh, PatchIndex patch) {
  const PatchCorners corners = mesh.corner_points(patch);
  const auto count = static_cast<std::size_t>(corners.count);
  double longest = 0;
  for (std::size_t k = 0; k < count; ++k)
    longest = std::max(longest, (corners.points[(k + 1) % count] - corners.points[k]).norm());
  return longest;
}

std::vector<std::uint8_t> large_patches(const PatchMesh& mesh) {
  std::vector<double> edges;
  for (PatchIndex i = 0; i < mesh.size(); ++i) edges.push_back(longest_edge(mesh, i));
  const double longest = edges.empty() ? 0 : *std::max_element(edges.begin(), edges.end());
  std::vector<std::uint8_t> large;
  for (const double edge : edges) large.push_back(parts_of_parent(edge, longest) > 1 ? 1 : 0);
  return large;
}

NestedMesh nest(PatchMesh parents, std::span<const std::uint8_t> is_cut) {
  Refinement refined = refine(parents, is_cut);
  NestedMesh mesh{std::move(parents), std::move(refined.mesh), std::move(refined.parent), {}};
  for (PatchIndex i = 0; i < mesh.patches.size(); ++i) {
    if (i == 0 || mesh.parent[i] != mesh.parent[i - 1]) mesh.first_patch.push_back(i);
  }
  mesh.first_patch.push_back(mesh.patches.size());
  return mesh;
}

}  // namespace

std::size_t parts_of_parent(double edge, double longest) {
  constexpr double small = 0.25;  // of the longest: such parents stay whole
  return edge >= small * longest ? 4 : 1;
}

NestedMesh nest(PatchMesh parents) {
  const std::vector<std::uint8_t> large = large_patches(parents);
  return nest(std::move(parents), large);
}

FinerMesh refine(const NestedMesh& mesh, std::span<const std::uint8_t> marked_parents) {
  Refinement parents = refine(mesh.parents, marked_parents);
  std::vector<PatchIndex> parts(mesh.parents.size(), 0);
  for (const PatchIndex parent : parents.parent) ++parts[parent];
  const auto patches_before = [&](PatchIndex parent) {
    const PatchRange range = mesh.patches_of(parents.parent[parent]);
    return range.end - range.begin;
  };

  // What was whole stays so until it is cut; then it is a parent as others are.
  std::vector<std::uint8_t> is_cut;
  for (PatchIndex g = 0; g < parents.mesh.size(); ++g)
    is_cut.push_back(parts[parents.parent[g]] > 1 || patches_before(g) > 1 ? 1 : 0);
  FinerMesh finer{nest(std::move(parents.mesh), is_cut), {}};
  finer.place.assign(finer.mesh.patches.size(), no_patch);
  for (PatchIndex g = 0; g < finer.mesh.parents.size(); ++g) {
    const PatchRange now = finer.mesh.patches_of(g);
    if (parts[parents.parent[g]] != 1 || now.end - now.begin != patches_before(g)) continue;
    const PatchIndex first_before = mesh.first_patch[parents.parent[g]];
    for (PatchIndex k = 0; k < now.end - now.begin; ++k) finer.place[now.begin + k] = first_before + k;
  }
  return finer;
}

Field summed_by_parent(const NestedMesh& mesh, const FieldView& values) {
  assert(values.rows() == static_cast<Eigen::Index>(mesh.patches.size()));
  Field sums = Field::Zero(mesh.parents.size(), values.cols());
  for (PatchIndex i = 0; i < mesh.patches.size(); ++i) sums.row(mesh.parent[i]) += values.row(i);
  return sums;
}

Field means_by_parent(const NestedMesh& mesh, const FieldView& values, const Eigen::VectorXd& area) {
  const Field areas = summed_by_parent(mesh, area.array());
  return summed_by_parent(mesh, values.colwise() * area.array()).colwise() / areas.col(0);
}

Field of_parents(const NestedMesh& mesh, const FieldView& parent_values) {
  Field values(mesh.patches.size(), parent_values.cols());
  for (PatchIndex i = 0; i < mesh.patches.size(); ++i) values.row(i) = parent_values.row(mesh.parent[i]);
  return values;
}

}  // namespace patchlight
