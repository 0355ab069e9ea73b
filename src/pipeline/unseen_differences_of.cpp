#include "pipeline/unseen_differences_of.h"

#include "base/sampling.h"
#include "mesh/refine.h"
#include "pipeline/lit_problem.h"

#include <cstddef>

namespace patchlight {

UnseenDifferences unseen_differences_of(const Run& run, const Simulation& simulation, const InNeededBands& needed,
                                        const TransportOperator& transport, const Eigen::VectorXd& weight, int rays) {
  QuarterLook look{.rays = rays, .seed = simulation.plan.assembly.seed};
  if (has_point_or_daylight(run.scene)) {
    const PatchMesh quarters = refine(simulation.mesh);
    for (std::size_t half = 0; half < look.direct.size(); ++half)
      look.direct[half] =
          reduced(rough_direct_irradiance(run, simulation.plan, quarters, hash({look.seed, half}), rays), needed.bands);
  }
  const Occluder& occluder = run.tracing->between_patches();
  const SolvedProblem solved = needed.solved();
  UnseenDifferences unseen = unseen_differences({simulation.mesh, occluder, simulation.transport.lost, solved},
                                                transport, weight, look, run.observer);
  unseen.error = expanded(unseen.error, needed.bands);
  unseen.display = expanded(unseen.display, needed.bands);
  return unseen;
}

}  // namespace patchlight
