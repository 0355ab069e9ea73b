#include "patchlight/transport/exchange.h"

#include <utility>

namespace patchlight {

Exchange trace_exchange(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                        int lost_share_rays, const Observer& observer) {
  Assembly raw = assemble_exchange_areas(mesh, occluder, options, observer);
  LostShare lost = measure_lost_share(mesh, occluder, lost_share_rays, options.seed, observer);
  const Eigen::VectorXd seen = row_sums(raw.exchange_areas);
  const Eigen::VectorXd area = exposed_area(mesh, lost, seen);
  return {std::move(raw.exchange_areas), area, seen.cwiseQuotient(area), std::move(lost), raw.counts, raw.error,
          std::move(raw.entry_errors),   {}};
}

Exchange exchange_on_demand(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                            int lost_share_rays, const Observer& observer) {
  LostShare lost = measure_lost_share(mesh, occluder, lost_share_rays, options.seed, observer);
  const Eigen::VectorXd area = exposed_area(mesh, lost, Eigen::VectorXd::Zero(mesh.size()));
  return {ExchangeAreas(0), area, {}, std::move(lost), {}, {}, {}, "none: rows on demand"};
}

ClosedExchangeAreas close_exchange(Exchange exchange, const Observer& observer) {
  if (exchange.closure.empty() || exchange.lost.closed()) {
    return close_exchange_areas(std::move(exchange.exchange_areas), exchange.area, exchange.lost, observer);
  }
  return {std::move(exchange.exchange_areas), Eigen::VectorXd::Zero(exchange.area.size()), exchange.closure};
}

}  // namespace patchlight
