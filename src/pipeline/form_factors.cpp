#include "patchlight/form_factors.h"

#include "base/parallel.h"
#include "pipeline/scene_in_patches.h"
#include "transport/closure.h"

#include <utility>

namespace patchlight {

FormFactors find_form_factors(const Scene& scene, const Request& request, const Observer& observer) {
  const ThreadLimit threads(request.resources.threads);
  Request kept = request;
  kept.assembly.storage = Storage::tiles;
  SceneInPatches found = scene_in_patches(scene, std::move(kept));
  const Plan& plan = found.plan;
  Exchange exchange = trace_exchange(found.mesh, found.world->between_patches(), plan.assembly, observer);
  if (plan.assembly.close) {
    const EntryErrors none;
    const bool weighs = weighs_by_errors(exchange.lost, found.mesh.size());
    const KnownErrors known{weighs ? exchange.entry_errors : none, exchange.error};
    ClosedExchangeAreas closed =
        close_exchange_areas(std::move(exchange.exchange_areas), exchange.area, exchange.lost, known, observer);
    exchange.exchange_areas = std::move(closed.exchange_areas);
    exchange.closure = closed.method;
    if (!plan.assembly.keep_errors) exchange.entry_errors = {};
  }
  return {std::move(found.request), std::move(found.plan), std::move(found.mesh), std::move(exchange),
          std::move(found.notes)};
}

}  // namespace patchlight
