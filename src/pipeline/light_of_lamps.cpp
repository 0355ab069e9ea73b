#include "pipeline/light_of_lamps.h"

#include "patchlight/base/error.h"

#include "base/parallel.h"

#include <utility>
#include <vector>

namespace patchlight {
namespace {

// Rows of lamps that are asked for at once.
constexpr PatchIndex rows_at_once = 64;

// Ranges of patches that emit, of so many at most.
std::vector<PatchRange> lamps_of(const FieldView& exitance) {
  std::vector<PatchRange> lamps;
  for (Eigen::Index row = 0; row < exitance.rows(); ++row) {
    if (!(exitance.row(row) > 0).any()) continue;
    const auto i = static_cast<PatchIndex>(row);
    if (!lamps.empty() && lamps.back().end == i && i - lamps.back().begin < rows_at_once) {
      ++lamps.back().end;
    } else {
      lamps.push_back({i, i + 1});
    }
  }
  return lamps;
}

// H = F E + H_direct; B = E + rho o H.
Solution light_of_lamps(const RowTransport& transport, const RadiosityProblem& problem, const Observer& observer) {
  const double start = wall_seconds();
  Field H = irradiance_by_lamps(transport, problem.exitance, Stage::solve, observer);
  if (problem.direct_irradiance.size() > 0) H += problem.direct_irradiance;
  const auto rows = (problem.exitance > 0).rowwise().any().count();
  Solution solution;
  solution.radiosity = radiosity_from(problem, H);
  solution.direct_irradiance = H;
  solution.irradiance = H;
  solution.error = Field::Zero(H.rows(), H.cols());
  solution.patch_bound = 0;
  solution.converged = true;
  solution.history = {{.seconds = wall_seconds() - start,
                       .work = static_cast<double>(rows) / static_cast<double>(problem.exitance.rows())}};
  const Progress last{
      .stage = Stage::solve, .fraction = 1, .iteration = &solution.history[0], .irradiance = [&H] { return H; }};
  if (observer && !observer(last)) throw Cancelled();
  return solution;
}

}  // namespace

Field irradiance_by_lamps(const RowTransport& transport, const FieldView& exitance, Stage stage,
                          const Observer& observer) {
  Field H = Field::Zero(exitance.rows(), exitance.cols());
  for (const PatchRange& lamp : lamps_of(exitance)) {
    if (observer && !observer({.stage = stage})) throw Cancelled();
    const Eigen::Index count = lamp.end - lamp.begin;
    H += transport.shoot(lamp, exitance.middleRows(lamp.begin, count));
  }
  return H;
}

SolveWith solver_as_planned(SolveWith solve, const Plan& plan) {
  if (simulates(plan, Effect::interreflection)) return solve ? std::move(solve) : SolveWith(patchlight::solve);
  return [](const RowTransport& transport, const RadiosityProblem& problem, const SolverOptions&,
            const Observer& observer) { return light_of_lamps(transport, problem, observer); };
}

}  // namespace patchlight
