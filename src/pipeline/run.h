#pragma once

#include "patchlight/simulate.h"
#include "patchlight/transport/assemble.h"

#include "lighting/direct_irradiance.h"
#include "mesh/nested_mesh.h"
#include "pipeline/world.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace patchlight {

/// What all meshes of a run have in common.
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

/// What of a run its steps give.
Given given_by(const Steps& with);

/// How often the rays of each patch of a mesh are doubled; empty: never.
struct MoreRays {
  std::vector<std::uint8_t> to_lights = {};  ///< to luminaires, sun and sky
  std::vector<std::uint8_t> of_rows = {};    ///< over the hemisphere
};

/// What is known from the mesh before.
struct Known {
  std::vector<PatchIndex> place;     ///< per patch: the same one in that mesh, or no_patch
  std::optional<Assembly> exchange;  ///< its exchange areas before closure; none: all are new
  std::optional<LostShare> lost;     ///< its lost shares; none: all are new
  std::optional<DirectIrradiance> light =
      {};  ///< that of luminaires, sun and sky over its whole patches; none: all is new
  std::vector<PatchIndex> light_place = {};  ///< per patch: that whose light is its own, or no_patch; with `light`
  MoreRays more_rays = {};
  std::uint64_t meshes = 0;  ///< how many were solved before, by which rays are chosen anew where they have told how
                             ///< many it takes; 0: as on the first one
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
  double noise_bar = 0;        ///< with parents: what rays between patches err, as relative_bar()
  double light_bar = 0;        ///< with parents: and those towards luminaires, sun and sky
  std::optional<DirectIrradiance> light = {};  ///< with rows of rays that may be found anew in part: what these met,
                                               ///< over whole patches
  MoreRays more_rays = {};                     ///< that it was solved with
};

}  // namespace patchlight
