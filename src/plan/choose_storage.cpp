#include "plan/choose_storage.h"

#include "plan/check_request.h"
#include "plan/decide.h"
#include "plan/memory.h"

#include <utility>

namespace patchlight {

namespace {

// Requests and plans have these parts in common.
template <typename Parts>
Parts stored_as_rays(Parts parts) {
  parts.assembly.storage = Storage::rays;
  if (parts.solver.solver == Solver::cg) parts.solver.solver = Solver::gmres;
  return parts;
}

}  // namespace

Request by_rays(Request request) { return stored_as_rays(std::move(request)); }

Plan by_rays(Plan plan) {
  plan = stored_as_rays(std::move(plan));
  plan.assembly.keep_errors = false;
  for (Decision& decision : plan.decisions)
    if (decision.effect == Effect::closure) decision = closed_by_rays();
  return plan;
}

namespace {

// Pairs of more patches take tens of seconds, and rows of rays one or two: docs/concepts/pairs-and-rays.md.
constexpr std::size_t most_patches_in_pairs = 10000;

// Sides have few patches each: the error by the size of patches is larger than the noise of rays, which take much less
// time than pairs. Not on the way to an accuracy, where faces are cut as it matters, and the noise of rays would limit.
bool has_coarse_sides(const StoredLight& light, const Request& request) {
  return light.patches >= 1000 && light.patches < 32 * light.sides && !refines(request.accuracy);
}

std::string reason_for_rays(const StoredLight& light, const Request& request, double bytes) {
  if (light.is_mirrored) return "which follow light over glazing and mirrors in each band";
  if (light.has_goal) return "because the patches are concentrated on a goal";
  if (light.patches <= most_patches_in_pairs && has_coarse_sides(light, request))
    return "because " + std::to_string(light.sides) + " sides of faces have few patches each: pairs would take longer";
  const bool fits = bytes <= usable_memory(request.resources);
  return "because all pairs of " + std::to_string(light.patches) + " patches need " + gigabytes(bytes) +
         (fits ? " and more time" : ", and " + gigabytes(usable_memory(request.resources)) + " is allowed");
}

// Error bars of 5,000 patches in pairs take two fifths of the run; of twice as many, three fifths. Standard errors of
// sensors follow from them, and are far too small behind slits and louvers without: then more patches have bars as
// well.
ChosenStorage with_cheap_bars(ChosenStorage chosen, const Given& given, const StoredLight& light) {
  const bool is_cheap = chosen.request.assembly.storage == Storage::tiles && light.is_reflected &&
                        (light.has_sensors || light.patches <= 5000);
  if (!chosen.request.accuracy.cheap_error_bars || !is_cheap || part_without_error_bars(chosen.request, given))
    return chosen;
  AccuracyOptions with_bars = chosen.request.accuracy;
  with_bars.error_bars = true;
  const double bytes = memory_needed(light.patches, chosen.request.assembly, with_bars);
  if (bytes <= usable_memory(chosen.request.resources)) chosen.request.accuracy = with_bars;
  return chosen;
}

}  // namespace

ChosenStorage choose_storage(const Request& request, const Given& given, const StoredLight& light) {
  ChosenStorage chosen{request, {}};
  const bool asks_for_rays = request.assembly.storage == Storage::rays;
  if (asks_for_rays && light.is_reflected && !given.mesh && !given.ray_rows) chosen.request.accuracy.error_bars = true;
  const bool lacks_bars = asks_for_rays && !light.is_reflected && has_error_bars(request.accuracy);
  if (request.assembly.storage != Storage::automatic && !lacks_bars)
    return with_cheap_bars(std::move(chosen), given, light);
  chosen.request.assembly.storage = Storage::tiles;
  const double bytes = memory_needed(light.patches, chosen.request.assembly, request.accuracy);
  const bool too_many = light.patches > most_patches_in_pairs || bytes > usable_memory(request.resources);
  const bool is_coarse = has_coarse_sides(light, request);
  const bool pays = light.is_reflected && (too_many || is_coarse || light.is_mirrored || light.has_goal);
  const bool has_to = light.is_mirrored && !has_error_bars(request.accuracy);
  if (!(pays || has_to) || part_that_takes_pairs(request, given))
    return with_cheap_bars(std::move(chosen), given, light);
  chosen.request = by_rays(std::move(chosen.request));
  chosen.request.accuracy.error_bars = light.is_reflected;
  const bool replaces_pairs = light.patches <= most_patches_in_pairs && is_coarse;
  // About as accurate as pairs.
  if (replaces_pairs || ((light.is_mirrored || light.has_goal) && light.patches <= 40000))
    chosen.request.assembly.rays = 256;
  chosen.notes = {{DiagnosticCode::rows_of_rays, "form factors are sampled by rays (assembly.storage=rays), " +
                                                     reason_for_rays(light, request, bytes) +
                                                     "\nhint: assembly.storage=tiles computes all pairs instead"}};
  return chosen;
}

}  // namespace patchlight
