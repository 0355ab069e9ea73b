#include "study/error_parts.h"

#include "base/vectors.h"

#include <algorithm>
#include <cmath>

namespace patchlight {
namespace {

// The own error of the setting with these samples and this tolerance in the sweep of one of them.
double own_error(const std::vector<StudySweep>& sweeps, Swept swept, const Plan& plan) {
  for (const StudySweep& sweep : sweeps) {
    if (!sweep.competes || sweep.swept != swept) continue;
    for (const StudySetting& setting : sweep.settings) {
      if (setting.samples == plan.assembly.samples && setting.tolerance == tolerance_of(plan.solver))
        return setting.own_error;
    }
  }
  return 0;
}

// Squares summed by what each patch belongs to: the largest sum and where it is.
template <typename BelongsTo>
std::pair<double, std::size_t> largest_sum(const Eigen::VectorXd& squares, std::size_t places, BelongsTo belongs_to) {
  std::vector<double> sums(places);
  for (Eigen::Index i = 0; i < squares.size(); ++i) sums[belongs_to(static_cast<std::size_t>(i))] += squares[i];
  const auto largest = std::max_element(sums.begin(), sums.end());
  return {*largest, static_cast<std::size_t>(largest - sums.begin())};
}

}  // namespace

ErrorParts error_parts(const Scene& scene, const Simulation& finest, const Discrepancy& discrepancy,
                       const std::vector<StudySweep>& sweeps) {
  ErrorParts parts;
  parts.form_factors = own_error(sweeps, Swept::samples, finest.plan);
  parts.solver = own_error(sweeps, Swept::tolerance, finest.plan);
  const double others = parts.form_factors * parts.form_factors + parts.solver * parts.solver;
  parts.mesh = std::sqrt(std::max(0.0, discrepancy.of_means * discrepancy.of_means - others));

  const PatchMesh& mesh = finest.mesh;
  const double all = total(discrepancy.squares);
  if (!(all > 0)) return parts;
  if (scene.groups.size() > 1) {
    const auto [sum, group] = largest_sum(discrepancy.squares, scene.groups.size(),
                                          [&](std::size_t i) { return scene.polygons[mesh.polygon[i]].group; });
    parts.worst_place = group_name(scene, static_cast<std::uint32_t>(group));
    parts.worst_share = sum / all;
  } else {
    const auto [sum, material] =
        largest_sum(discrepancy.squares, scene.materials.size(), [&](std::size_t i) { return mesh.material[i]; });
    parts.worst_place = scene.materials[material].name;
    parts.worst_share = sum / all;
  }
  return parts;
}

}  // namespace patchlight
