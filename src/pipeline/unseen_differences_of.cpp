#include "pipeline/unseen_differences_of.h"

#include "base/sampling.h"
#include "mesh/kept_patches.h"
#include "mesh/refine.h"
#include "pipeline/lit_problem.h"
#include "plan/goal.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace patchlight {
namespace {

// Light straight from sources at the quarters of patches, in the needed bands. Only differences within a patch count:
// those of patches below a sixty-fourth of the mean area of the goal's are taken as 0. (With a sixteenth, those of
// frames and sills of windows would be missing.)
std::array<Field, 2> direct_at_quarters(const Run& run, const Simulation& simulation, const SolvedBands& bands,
                                        const QuarterLook& look) {
  const PatchMesh& mesh = simulation.mesh;
  const double least_area = mean_area_of_goal(mesh, simulation.plan.goal.get()) / 64;
  std::vector<std::uint8_t> is_left_out;
  for (const double area : mesh.area) is_left_out.insert(is_left_out.end(), 4, area < least_area ? 1 : 0);
  PatchMesh all = refine(mesh);
  all.middles.clear();  // which belong to edges, of which light knows nothing
  const PatchMesh quarters = without_patches(all, is_left_out);
  std::array<Field, 2> direct;
  for (std::size_t half = 0; half < direct.size(); ++half) {
    const Field found =
        reduced(rough_direct_irradiance(run, simulation.plan, quarters, hash({look.seed, half}), look.rays), bands);
    direct[half] = Field::Zero(static_cast<Eigen::Index>(is_left_out.size()), found.cols());
    Eigen::Index next = 0;
    for (std::size_t q = 0; q < is_left_out.size(); ++q)
      if (is_left_out[q] == 0) direct[half].row(static_cast<Eigen::Index>(q)) = found.row(next++);
  }
  return direct;
}

}  // namespace

UnseenDifferences unseen_differences_of(const Run& run, const Simulation& simulation, const InNeededBands& needed,
                                        const TransportOperator& transport, const Eigen::VectorXd& weight, int rays) {
  QuarterLook look{.rays = rays, .seed = simulation.plan.assembly.seed};
  if (has_point_or_daylight(run.scene)) look.direct = direct_at_quarters(run, simulation, needed.bands, look);
  const Occluder& occluder = run.tracing->between_patches();
  const SolvedProblem solved = needed.solved();
  UnseenDifferences unseen = unseen_differences({simulation.mesh, occluder, simulation.transport.lost, solved},
                                                transport, weight, look, run.observer);
  unseen.error = expanded(unseen.error, needed.bands);
  unseen.noise = expanded(unseen.noise, needed.bands);
  unseen.display = expanded(unseen.display, needed.bands);
  return unseen;
}

}  // namespace patchlight
