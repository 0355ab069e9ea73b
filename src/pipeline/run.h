#pragma once

#include "patchlight/simulate.h"
#include "patchlight/transport/assemble.h"

#include "base/parallel.h"
#include "lighting/direct_irradiance.h"
#include "mesh/nested_mesh.h"
#include "pipeline/world.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace patchlight {

/// The context that all meshes of a run have in common.
struct Run {
  const Scene& scene;  ///< World::planned_scene()
  const Request& request;
  const Plan& plan;
  const Diagnostics& notes;  ///< Simulation::notes
  std::shared_ptr<const World> world;
  const Steps& with;
  const Observer& observer;
  bool is_part = false;  ///< it has some of the bands of another run, see LightColours
};

/// The parts of a run that its steps give.
Given given_by(const Steps& with);

/// How often the rays of each patch of a mesh are doubled; empty: never.
struct MoreRays {
  std::vector<std::uint8_t> to_lights = {};  ///< to luminaires, sun and sky
  std::vector<std::uint8_t> of_rows = {};    ///< over the hemisphere
};

/// Known quantities from the mesh before.
struct Known {
  std::vector<PatchIndex> place;     ///< per patch: the same one in that mesh, or no_patch
  std::optional<Assembly> exchange;  ///< its exchange areas before closure; none: all are new
  std::optional<LostShare> lost;     ///< its lost shares; none: all are new
  std::optional<DirectIrradiance> light =
      {};  ///< that of luminaires, sun and sky over its whole patches; none: all is new
  std::vector<PatchIndex> light_place = {};  ///< per patch: that whose light is its own, or no_patch; with `light`
  MoreRays more_rays = {};
  std::uint64_t meshes = 0;  ///< how many were solved before; decides the random seed, see seed_on()
};

/// A mesh whose solution is wanted. Pairs have no error bars without parents, and rows of rays narrower ones.
struct MeshToSolve {
  NestedMesh mesh;
  Plan plan;  ///< that of the run, with the storage, samples and solver's error that this mesh is worth
  Known known;
};

/// A solved mesh.
struct SolvedMesh {
  Simulation simulation;  ///< without costs
  NestedMesh mesh;
  std::optional<Assembly> raw = {};  ///< with parents: exchange areas before closure
  Eigen::VectorXd interest = {};     ///< with parents: 1 for each patch whose error counts, else 0
  Eigen::VectorXd effects = {};      ///< with parents: effects_of_parents(); by pairs also of what light_bar is of
  Eigen::VectorXd noise = {};        ///< with parents: noise_of_parents()
  Eigen::VectorXd row_noise = {};  ///< with rows of rays and parents: the part of each patch in the square of noise_bar
  Eigen::VectorXd light_noise = {};  ///< and in that of light_bar
  double share_cuts_mend = 0;  ///< with rows of rays and parents: the share of the square of the mesh's error that some
                               ///< cuts of patches would take away
  double noise_bar = 0;        ///< with parents: the error by rays between patches, as relative_bar()
  double light_bar = 0;        ///< with parents: and by those towards luminaires, sun and sky
  std::optional<DirectIrradiance> light = {};  ///< with rows of rays, for another mesh: light over whole patches
  MoreRays more_rays = {};                     ///< that it was solved with
};

/// The plan's notes, those on polygons that lie one on the other and, where patches are not refined, on lamps that are
/// close to what they light: else error bars see these.
Diagnostics notes_on_run(const World& world, const Plan& plan);

/// Warns about emitting patches whose stacking order has changed since the form factors were made, e.g. a lamp that is
/// let into a ceiling and was dark then.
Diagnostics notes_on_hidden_lamps(const Scene& scene, const Simulation& simulation);

/// Measures the cost of each stage, all its rounds together.
class StageClock {
 public:
  /// Ends a stage; the next one begins.
  void finish(Stage stage) {
    auto of_stage = std::find_if(costs_.begin(), costs_.end(), [&](const StageCost& c) { return c.stage == stage; });
    if (of_stage == costs_.end()) of_stage = costs_.insert(of_stage, {stage, 0, 0});
    of_stage->seconds += wall_seconds() - wall_;
    of_stage->cpu_seconds += cpu_seconds() - cpu_;
    wall_ = wall_seconds();
    cpu_ = cpu_seconds();
  }
  const std::vector<StageCost>& costs() const { return costs_; }

 private:
  double wall_ = wall_seconds();
  double cpu_ = cpu_seconds();
  std::vector<StageCost> costs_;
};

}  // namespace patchlight
