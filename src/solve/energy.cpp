#include "solve/energy.h"

#include "base/vectors.h"
#include "solve/scattering.h"

namespace patchlight {

EnergyBalance energy_balance(const RadiosityProblem& problem, const Solution& solution, const Eigen::VectorXd& row_sum,
                             const LostShare& lost) {
  const auto flux = [&](const Field& x) { return area_sum(x, problem.area); };
  const Field& B = solution.radiosity;
  const Field& H = solution.irradiance;

  EnergyBalance balance;
  balance.emitted = flux(problem.exitance);
  balance.arriving = Eigen::ArrayXd::Zero(balance.emitted.size());
  if (problem.direct_irradiance.size() > 0) balance.arriving = flux(problem.direct_irradiance);
  balance.absorbed = flux(absorb(problem.scattering, H));
  balance.escaped = flux(B.colwise() * lost.escaped.array());
  balance.lost_at_backs = flux(B.colwise() * lost.at_backs.array());
  // What leaves a patch and arrives at no other, beyond the measured lost share.
  balance.defect = flux(B.colwise() * (1 - row_sum.array() - lost.escaped.array() - lost.at_backs.array()));
  const Eigen::ArrayXd all = balance.emitted + balance.arriving;
  const Eigen::ArrayXd left = all - balance.absorbed - balance.escaped - balance.lost_at_backs - balance.defect;
  balance.imbalance = largest((all > 0).select(left.abs() / all, 0.0));
  return balance;
}

}  // namespace patchlight
