#include "mesh/nested_mesh.h"

#include "mesh/refine.h"

#include <algorithm>
#include <cassert>
#include <numeric>
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

std::vector<std::uint8_t> large_patches(const PatchMesh& mesh, double usual_edge) {
  std::vector<double> edges;
  for (PatchIndex i = 0; i < mesh.size(); ++i) edges.push_back(longest_edge(mesh, i));
  const double longest = edges.empty() ? 0 : std::min(usual_edge, *std::max_element(edges.begin(), edges.end()));
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

NestedMesh nest(PatchMesh parents, double usual_edge) {
  const std::vector<std::uint8_t> large = large_patches(parents, usual_edge);
  return nest(std::move(parents), large);
}

namespace {

// A mesh each patch of which is cut so many times, and others that balance takes.
Refinement refined(const PatchMesh& mesh, std::vector<std::uint8_t> cuts) {
  Refinement result{mesh, std::vector<PatchIndex>(mesh.size())};
  std::iota(result.parent.begin(), result.parent.end(), PatchIndex{0});
  while (std::any_of(cuts.begin(), cuts.end(), [](std::uint8_t more) { return more > 0; })) {
    Refinement once = refine(result.mesh, cuts);
    std::vector<std::uint8_t> left;
    for (PatchIndex& parent : once.parent) {
      left.push_back(cuts[parent] > 0 ? cuts[parent] - 1 : 0);
      parent = result.parent[parent];
    }
    cuts = std::move(left);
    result = std::move(once);
  }
  return result;
}

}  // namespace

PatchIndex number_kept(std::span<const PatchIndex> places) {
  return static_cast<PatchIndex>(places.size() -
                                 static_cast<std::size_t>(std::count(places.begin(), places.end(), no_patch)));
}

FinerMesh cut_patches(const NestedMesh& mesh, std::span<const std::uint8_t> cuts) {
  assert(cuts.size() == mesh.parents.size());
  const auto patches_before = [&](PatchIndex parent) {
    const PatchRange range = mesh.patches_of(parent);
    return range.end - range.begin;
  };

  // 1. Parents as often as their patches; one that was whole gets parts first.
  std::vector<std::uint8_t> of_parents;
  for (PatchIndex g = 0; g < mesh.parents.size(); ++g)
    of_parents.push_back(cuts[g] > 0 && patches_before(g) == 1 ? cuts[g] - 1 : cuts[g]);
  Refinement parents = refined(mesh.parents, std::move(of_parents));
  std::vector<PatchIndex> parts(mesh.parents.size(), 0);
  for (const PatchIndex before : parents.parent) ++parts[before];

  // 2. What was whole stays so until it is cut; then it is a parent as others are.
  std::vector<std::uint8_t> is_cut;
  for (const PatchIndex before : parents.parent)
    is_cut.push_back(parts[before] > 1 || patches_before(before) > 1 || cuts[before] > 0 ? 1 : 0);
  FinerMesh finer{nest(std::move(parents.mesh), is_cut), {}, {}};

  // 3. Which patches are as they were.
  for (const PatchIndex parent : finer.mesh.parent) finer.parent_before.push_back(parents.parent[parent]);
  finer.place.assign(finer.mesh.patches.size(), no_patch);
  for (PatchIndex g = 0; g < finer.mesh.parents.size(); ++g) {
    const PatchRange now = finer.mesh.patches_of(g);
    const PatchIndex before = parents.parent[g];
    if (parts[before] != 1 || now.end - now.begin != patches_before(before)) continue;
    for (PatchIndex k = 0; k < now.end - now.begin; ++k) finer.place[now.begin + k] = mesh.first_patch[before] + k;
  }
  return finer;
}

FinerMesh refine(const NestedMesh& mesh, std::span<const std::uint8_t> marked_parents) {
  std::vector<std::uint8_t> cuts;
  for (PatchIndex g = 0; g < mesh.parents.size(); ++g) {
    const bool is_whole = mesh.first_patch[g + 1] - mesh.first_patch[g] == 1;
    cuts.push_back(marked_parents[g] == 0 ? 0 : is_whole ? 2 : 1);
  }
  return cut_patches(mesh, cuts);
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
