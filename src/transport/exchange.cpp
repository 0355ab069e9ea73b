#include "patchlight/transport/exchange.h"

#include "transport/closure.h"
#include "visibility/occluder.h"

#include <utility>

namespace patchlight {
namespace {

// What storage may change of a closed row, as a share of its area: its entries are narrowed toward zero (2^-23 of
// each), stored as the nearest floats F_ij (2^-24) and narrowed once more when they are read (2^-23).
constexpr double storage_loss = 5 * 0x1p-24;

// Beyond so many patches the errors of entries are not kept for closure alone: rows of thousands of entries are known
// so much better than the lost share that hardly anything is moved, whatever the weights.
constexpr PatchIndex most_weighed = 4096;

}  // namespace

Exchange trace_exchange(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                        const Observer& observer) {
  LostShare lost = measure_lost_share(mesh, occluder, options.lost_share_rays, options.seed, observer);
  AssemblyOptions keeping = options;
  const bool weighs = weighs_by_errors(lost, mesh.size()) && options.estimator == Estimator::automatic;
  keeping.keep_errors = options.keep_errors || weighs;
  return exchange_of(assemble_exchange_areas(mesh, occluder, keeping, observer), mesh, std::move(lost));
}

Exchange exchange_of(Assembly raw, const PatchMesh& mesh, LostShare lost) {
  const Eigen::VectorXd seen = row_sums(raw.exchange_areas);
  const Eigen::VectorXd area = exposed_area(mesh, lost, seen);
  return {std::move(raw.exchange_areas), area, seen.cwiseQuotient(area), std::move(lost), raw.counts, raw.error,
          std::move(raw.entry_errors),   {}};
}

Exchange exchange_on_demand(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                            const Observer& observer) {
  LostShare lost = measure_lost_share(mesh, occluder, options.lost_share_rays, options.seed, observer);
  const Eigen::VectorXd area = exposed_area(mesh, lost, Eigen::VectorXd::Zero(mesh.size()));
  return {ExchangeAreas(0), area, {}, std::move(lost), {}, {}, {}, "none: rows on demand"};
}

bool weighs_by_errors(const LostShare& lost, PatchIndex patches) { return !lost.closed() && patches <= most_weighed; }

ClosedExchangeAreas close_exchange(Exchange exchange, const Observer& observer) {
  const Eigen::Index n = exchange.area.size();
  if (!exchange.closure.empty() && !exchange.lost.closed()) {
    return {std::move(exchange.exchange_areas), Eigen::VectorXd::Zero(n), exchange.closure};
  }
  if (!exchange.closure.empty()) {
    const Eigen::VectorXd missing = exchange.area - row_sums(exchange.exchange_areas);
    if ((missing.array().abs() <= storage_loss * exchange.area.array()).all()) {
      return {std::move(exchange.exchange_areas), missing, exchange.closure};
    }
  }
  const KnownErrors known{exchange.entry_errors, exchange.error};
  return close_exchange_areas(std::move(exchange.exchange_areas), exchange.area, exchange.lost, known, observer);
}

}  // namespace patchlight
