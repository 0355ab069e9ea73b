#include "pipeline/run.h"

#include "lighting/mirror_paths.h"
#include "plan/notes.h"

#include <set>
#include <sstream>

namespace patchlight {
namespace {

// Warns if a noticeable share of the light on mirrors takes chains that are not followed.
Diagnostics notes_on_chains(const World& world) {
  const Tracing& tracing = world.tracing();
  if (tracing.reflections() == Reflections::kept || !tracing.has_specular_surfaces()) return {};
  const MirrorChains& found = world.lighting().mirrors->paths.found();
  if (found.unfollowed_share < 0.01) return {};
  std::ostringstream text;
  text.precision(2);
  text << "patchlight follows " << found.chains.size() << " chains of mirrors and clear faces; up to "
       << 100 * std::min(1.0, found.unfollowed_share)
       << " % of the light that lamps, luminaires and sun send to these faces takes other chains. Error bars "
          "include it as if each face scattered it evenly";
  return {{DiagnosticCode::unfollowed_reflection, text.str()}};
}

}  // namespace

Given given_by(const Steps& with) {
  return {.form_factors = static_cast<bool>(with.exchange),
          .ray_rows = static_cast<bool>(with.ray_exchange),
          .mesh = static_cast<bool>(with.mesh),
          .solver = static_cast<bool>(with.solve)};
}

Diagnostics notes_on_run(const World& world, const Plan& plan) {
  const Scene& scene = world.scene();
  return merged(
      {plan.notes, problems_with_overlaps(scene, world.tracing().coverings()), notes_on_chains(world),
       refines(plan.accuracy) ? Diagnostics() : notes_on_close_lamps(scene, world.between_patches(), plan.max_edge)});
}

Diagnostics notes_on_hidden_lamps(const Scene& scene, const Simulation& simulation) {
  const PatchMesh& mesh = simulation.mesh;
  const Eigen::VectorXd& overlaid = simulation.transport.lost.overlaid;
  const Occluder& occluder = simulation.world->between_patches();
  std::set<std::string> names;
  for (PatchIndex i = 0; i < overlaid.size(); ++i) {
    const bool was_hidden = overlaid[i] == 1 && emits(scene, mesh.polygon[i], mesh.side[i]);
    if (was_hidden && !occluder.is_covered(mesh.polygon[i], mesh.side[i], mesh.centroid[i]))
      names.insert(scene.materials[mesh.material[i]].name);
  }
  Diagnostics notes;
  for (const std::string& name : names)
    notes.push_back(
        {DiagnosticCode::lost_light,
         "material '" + name +
             "' emits, but little light comes from it: some of its faces lay under others when the form factors "
             "were computed, because they were dark; compute them again with the present lamps"});
  return notes;
}

}  // namespace patchlight
