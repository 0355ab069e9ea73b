#include "pipeline/relative_errors.h"

#include "patchlight/accuracy/error_bars.h"

#include "accuracy/errors.h"
#include "accuracy/interest.h"
#include "accuracy/spaces.h"
#include "base/vectors.h"

namespace patchlight {

AccuracyStep errors_of(const Simulation& simulation, const Eigen::VectorXd& weight) {
  const ErrorBars& bars = *simulation.error_bars;
  const auto relative = [&](const Field& bar) {
    return relative_bar(bar, simulation.problem, simulation.solution, weight);
  };
  const auto patches = static_cast<PatchIndex>((weight.array() > 0).count());
  return {.patches = patches,
          .new_patches = patches,
          .samples = samples_of(simulation.plan.assembly),
          .mesh = relative(bars.mesh),
          .form_factor = relative(bars.form_factor),
          .solver = relative(bars.solver),
          .total = relative(bars.total()),
          .display = relative(bars.display)};
}

std::vector<SpaceErrors> errors_by_space(const Scene& scene, const Simulation& simulation) {
  if (!simulation.error_bars) return {};
  const PatchMesh& mesh = simulation.mesh;
  const Eigen::VectorXd interest = interest_of(scene, mesh, simulation.plan.accuracy.interest);
  const Eigen::VectorXd inside = interest.cwiseProduct(inside_shells(scene, mesh, Dividing::with_openings));
  const Eigen::VectorXd outside = interest - inside;
  if (total(inside) == 0 || total(outside) == 0) return {};
  return {{"inside", errors_of(simulation, inside)}, {"outside", errors_of(simulation, outside)}};
}

}  // namespace patchlight
