#include "pipeline/unseen_differences_of.h"

#include "base/sampling.h"
#include "mesh/refine.h"
#include "pipeline/lit_problem.h"

#include <cstddef>

namespace patchlight {

UnseenDifferences unseen_differences_of(const Run& run, const Simulation& simulation,
                                        const TransportOperator& transport, const Eigen::VectorXd& weight, int rays) {
  QuarterLook look{.rays = rays, .seed = simulation.plan.assembly.seed};
  if (has_point_or_daylight(run.scene)) {
    const PatchMesh quarters = refine(simulation.mesh);
    for (std::size_t half = 0; half < look.direct.size(); ++half)
      look.direct[half] = rough_direct_irradiance(run, simulation.plan, quarters, hash({look.seed, half}));
  }
  const SolvedProblem solved{simulation.problem, simulation.solution};
  const Occluder& occluder = run.tracing->between_patches();
  return unseen_differences({simulation.mesh, occluder, simulation.transport.lost, solved}, transport, weight, look,
                            run.observer);
}

}  // namespace patchlight
