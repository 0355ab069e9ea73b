#include "pipeline/notes_on_run.h"

#include "lighting/mirror_chains.h"
#include "plan/close_lamps.h"

#include <set>
#include <sstream>
#include <utility>

namespace patchlight {

namespace {

// The light of a sky comes by rays from where it falls.
bool has_lamps_apart_from_sky(const Scene& scene) {
  if (scene.sun || !scene.luminaires.empty()) return true;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (is_lamp(scene, p)) return true;
  }
  return false;
}

std::vector<std::string> notes_on_chains(const Scene& scene, const Tracing& tracing) {
  if (tracing.reflections() == Reflections::kept || !tracing.has_specular_faces()) return {};
  if (!has_lamps_apart_from_sky(scene)) return {};
  const MirrorChains found = mirror_chains(scene);
  constexpr double too_little = 0.01;
  const bool misses_mirrors = found.left_out >= too_little;
  if (!found.is_cut && !misses_mirrors) return {};
  std::ostringstream text;
  text.precision(2);
  text << "light of lamps, luminaires and sun is followed on " << found.chains.size()
       << " ways over mirrors and clear faces" << (found.is_cut ? ", and there are more" : "");
  if (misses_mirrors) {
    text << "; " << 100 * found.left_out
         << " % of the light that these faces may reflect meets some that are on none of them, as small ones are";
  }
  text << "; no error bar has what other ways would bring";
  return {text.str()};
}

}  // namespace

std::vector<std::string> notes_on_run(const Scene& scene, const Tracing& tracing, const Plan& plan) {
  std::vector<std::string> notes = plan.notes;
  for (const Problem& problem : problems_with_overlaps(scene, tracing.coverings())) notes.push_back(problem.what);
  for (std::string& note : notes_on_chains(scene, tracing)) notes.push_back(std::move(note));
  if (refines(plan.accuracy)) return notes;
  for (std::string& note : notes_on_close_lamps(scene, tracing.between_patches(), plan.max_edge))
    notes.push_back(std::move(note));
  return notes;
}

std::vector<std::string> notes_on_hidden_lamps(const Scene& scene, const Simulation& simulation) {
  const PatchMesh& mesh = simulation.mesh;
  const Eigen::VectorXd& overlaid = simulation.transport.lost.overlaid;
  const Occluder& occluder = simulation.tracing->between_patches();
  std::set<std::string> names;
  for (PatchIndex i = 0; i < overlaid.size(); ++i) {
    const bool was_hidden = overlaid[i] == 1 && emits(scene, mesh.polygon[i], mesh.side[i]);
    if (was_hidden && !occluder.is_covered(mesh.polygon[i], mesh.side[i], mesh.centroid[i]))
      names.insert(scene.materials[mesh.material[i]].name);
  }
  std::vector<std::string> notes;
  for (const std::string& name : names)
    notes.push_back("material '" + name +
                    "' emits, but little light comes from it: faces of it lay under others when the form factors were "
                    "made, as they were dark; make the form factors anew with the lamps of now");
  return notes;
}

}  // namespace patchlight
