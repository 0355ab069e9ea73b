#include "patchlight/form_factors.h"

#include "base/parallel.h"
#include "mesh/mesher.h"
#include "plan/check_request.h"
#include "plan/memory.h"
#include "transport/closure.h"
#include "visibility/tracing.h"

#include <string>
#include <utility>
#include <vector>

namespace patchlight {

FormFactors find_form_factors(const Scene& scene, const Request& request, const Observer& observer) {
  const ThreadLimit threads(request.resources.threads);
  check(request, scene);
  Request used = request;
  used.assembly.storage = Storage::tiles;
  if (used.mesh.sides == Sides::automatic && !has_lamp(scene)) used.mesh.sides = Sides::front;
  Plan plan = plan_form_factors(scene, used);
  require_memory(scene, used, plan);
  PatchMesh mesh = tessellate(scene, plan.sides, plan.max_edge);
  require_memory(mesh.size(), used, plan);

  const Tracing tracing(scene, find_coverings(scene, plan.sides));
  std::vector<std::string> notes;
  for (const Problem& problem : problems_with_overlaps(scene, tracing.coverings())) notes.push_back(problem.what);
  Exchange exchange = trace_exchange(mesh, tracing.between_patches(), plan.assembly, observer);
  if (plan.assembly.close) {
    const EntryErrors none;
    const bool weighs = weighs_by_errors(exchange.lost, mesh.size());
    const KnownErrors known{weighs ? exchange.entry_errors : none, exchange.error};
    ClosedExchangeAreas closed =
        close_exchange_areas(std::move(exchange.exchange_areas), exchange.area, exchange.lost, known, observer);
    exchange.exchange_areas = std::move(closed.exchange_areas);
    exchange.closure = closed.method;
    if (!plan.assembly.keep_errors) exchange.entry_errors = {};
  }
  return {used, std::move(plan), std::move(mesh), std::move(exchange), std::move(notes)};
}

}  // namespace patchlight
