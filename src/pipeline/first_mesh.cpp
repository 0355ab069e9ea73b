#include "pipeline/first_mesh.h"

#include "patchlight/transport/lost_share.h"

#include "mesh/mesher.h"
#include "plan/goal.h"
#include "plan/planned_scene.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace patchlight {
namespace {

// The surroundings of the goal are cut after it, as parents where there are some.
NestedMesh nested_as_planned(const Plan& plan, const auto& patches_with_edge) {
  const auto cut = [&](PatchMesh mesh, std::size_t around) {
    return plan.goal ? cut_by_importance(std::move(mesh), *plan.goal, around) : mesh;
  };
  if (plan.accuracy.error_bars) {
    const double longest = 2 * plan.max_edge;
    return nest(cut(patches_with_edge(longest), plan.patches_around / 4), plan.goal ? longest : any_edge);
  }
  NestedMesh mesh;
  mesh.patches = cut(patches_with_edge(plan.max_edge), plan.patches_around);
  return mesh;
}

}  // namespace

PatchMesh open_patches(const Scene& scene, const Plan& plan, double max_edge, const Occluder& occluder) {
  const PatchEdges edges = edges_for(scene, max_edge, plan.goal.get());
  PatchMesh mesh = tessellate(scene, plan.sides, edges, plan.contacts, plan.graded_edges);
  if (plan.contacts.on.empty()) return mesh;
  // Only where faces touch can others be covered. The rest counts as known: open.
  LostShare open;
  open.rays_per_patch = 128;  // a patch is covered when every one of sixteen places on it is
  open.escaped = open.at_backs = open.covered = open.dark = open.overlaid = Eigen::VectorXd::Zero(1);
  std::vector<PatchIndex> place(mesh.size(), 0);
  bool any = false;
  for (PolygonIndex polygon = 0; polygon < scene.polygons.size(); ++polygon) {
    const auto& lines = plan.contacts.on[polygon];
    if (std::none_of(lines.begin(), lines.end(), [](const ContactLine& line) { return line.gap == 0; })) continue;
    for (const Side side : {Side::front, Side::back}) {
      const auto [begin, end] = mesh.patches_on(polygon, side);
      std::fill(place.begin() + begin, place.begin() + end, no_patch);
      any = any || begin < end;
    }
  }
  if (!any) return mesh;
  const LostShare lost = measure_lost_share(mesh, occluder, KnownShares{open, place}, plan.assembly.seed);
  std::vector<std::uint8_t> is_left_out;
  for (PatchIndex i = 0; i < mesh.size(); ++i) is_left_out.push_back(lost.covered[i] == 1 ? 1 : 0);
  return without_patches(mesh, is_left_out);
}

PatchMesh open_patches(const Scene& scene, const Plan& plan, double max_edge) {
  if (plan.contacts.on.empty())
    return tessellate(scene, plan.sides, edges_for(scene, max_edge, plan.goal.get()), {}, plan.graded_edges);
  const Tracing tracing(scene, *plan.coverings, blockers_of(plan), reflections_of(plan));
  return open_patches(scene, plan, max_edge, tracing.between_patches());
}

NestedMesh first_mesh(const Scene& scene, const Plan& plan, const Occluder& occluder) {
  return nested_as_planned(plan, [&](double edge) { return open_patches(scene, plan, edge, occluder); });
}

NestedMesh first_mesh(const Scene& scene, const Plan& plan) {
  return nested_as_planned(plan, [&](double edge) { return open_patches(scene, plan, edge); });
}

}  // namespace patchlight
