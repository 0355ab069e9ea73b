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

/// The context shared by all meshes of a run.
struct Run {
  const Scene& scene;  ///< World::planned_scene()
  const Request& request;
  const Plan& plan;
  const Diagnostics& notes;  ///< Simulation::notes
  std::shared_ptr<const World> world;
  const Steps& with;
  const Observer& observer;
  bool is_part = false;  ///< it has some bands of another run, see `LightColour`
};

/// The parts of a run that its steps provide.
Given given_by(const Steps& with);

/// How many times the rays of each patch of a mesh are doubled; empty: 0.
struct MoreRays {
  std::vector<std::uint8_t> to_lights = {};  ///< to luminaires, sun and sky
  std::vector<std::uint8_t> of_rows = {};    ///< over the hemisphere
};

/// Known quantities from the previous mesh.
struct Known {
  std::vector<PatchIndex> place;               ///< per patch: the same one in that mesh, or no_patch
  std::optional<Assembly> exchange;            ///< its exchange areas before closure; none: all are new
  std::optional<LostShare> lost;               ///< its lost shares; none: all are new
  std::optional<DirectIrradiance> light = {};  ///< by luminaires, sun and sky over its whole patches; none: all is new
  /// Per patch: the previous patch with the same light, or no_patch; used with `light`.
  std::vector<PatchIndex> light_place = {};
  MoreRays more_rays = {};
  std::uint64_t meshes = 0;  ///< how many were solved before; decides the random seed, see seed_on()
};

/// A mesh to be solved. Without parents, pairs have no error bars, and those of rows of rays are narrower.
struct MeshToSolve {
  NestedMesh mesh;
  Plan plan;  ///< the run's plan, with storage, samples and solver error for this mesh
  Known known;
};

/// A solved mesh.
struct SolvedMesh {
  Simulation simulation;  ///< without costs
  NestedMesh mesh;
  std::optional<Assembly> raw = {};  ///< with parents: exchange areas before closure
  Eigen::VectorXd interest = {};     ///< with parents: 1 for each patch whose error counts, else 0
  /// With parents: effects_of_parents(); with pairs also the effects of the errors in light_bar.
  Eigen::VectorXd effects = {};
  Eigen::VectorXd noise = {};      ///< with parents: noise_of_parents()
  Eigen::VectorXd row_noise = {};  ///< with rows of rays and parents: the part of each patch in the square of noise_bar
  /// With rows of rays and parents: the part of each patch in the square of light_bar.
  Eigen::VectorXd light_noise = {};
  /// With rows of rays and parents: the share of the squared mesh error that a few cuts would remove.
  double share_cuts_mend = 0;
  double noise_bar = 0;  ///< with parents: the relative_bar() of the noise of rays between patches
  double light_bar = 0;  ///< with parents: that of rays towards luminaires, sun and sky
  std::optional<DirectIrradiance> light = {};  ///< with rows of rays, for another mesh: light over whole patches
  MoreRays more_rays = {};                     ///< those of this solution
};

/// The plan's notes, and notes on polygons that lie on each other. Without refinement also notes on lamps close to the
/// surfaces that they light; with refinement the error bars show these.
Diagnostics notes_on_run(const World& world, const Plan& plan);

/// Warns about emitting patches whose stacking order has changed since the form factors were computed, e.g. a recessed
/// lamp that was dark then.
Diagnostics notes_on_hidden_lamps(const Scene& scene, const Simulation& simulation);

/// Measures the cost of each stage, summed over all rounds.
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
