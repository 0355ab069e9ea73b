#include "patchlight/form_factors.h"

#include "base/parallel.h"
#include "mesh/mesher.h"
#include "plan/memory.h"
#include "transport/closure.h"
#include "visibility/tracing.h"

#include <utility>

namespace patchlight {

FormFactors find_form_factors(const Scene& scene, const Request& request, const Observer& observer) {
  const ThreadLimit threads(request.threads);
  Request used = request;
  used.storage = Storage::tiles;
  if (used.sides == Sides::automatic && !has_lamp(scene)) used.sides = Sides::front;
  require_memory(scene, used);
  Plan plan = plan_form_factors(scene, used);
  PatchMesh mesh = tessellate(scene, plan.sides, plan.max_edge);
  require_memory(mesh.size(), used);

  const Tracing tracing(scene, find_coverings(scene, plan.sides));
  for (const Problem& problem : problems_with_overlaps(scene, tracing.coverings())) plan.notes.push_back(problem.what);
  Exchange exchange =
      trace_exchange(mesh, tracing.between_patches(), assembly_options(plan), plan.lost_share_rays, observer);
  if (plan.close) {
    const EntryErrors none;
    const bool weighs = weighs_by_errors(exchange.lost, mesh.size());
    const KnownErrors known{weighs ? exchange.entry_errors : none, exchange.error};
    ClosedExchangeAreas closed =
        close_exchange_areas(std::move(exchange.exchange_areas), exchange.area, exchange.lost, known, observer);
    exchange.exchange_areas = std::move(closed.exchange_areas);
    exchange.closure = closed.method;
    if (!plan.standard_errors) exchange.entry_errors = {};
  }
  return {used, std::move(plan), std::move(mesh), std::move(exchange)};
}

}  // namespace patchlight
