#include "plan/choose_storage.h"

#include "patchlight/base/error.h"
#include "patchlight/scene/sides.h"

#include "mesh/mesher.h"
#include "plan/check_request.h"
#include "plan/decide.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <optional>
#include <sstream>
#include <unistd.h>
#include <utility>

namespace patchlight {
namespace {

// The exchange areas, in float, half of a symmetric matrix. The rest is measured: the program and its libraries, and
// the mesh, the fields and the results per patch.
constexpr double bytes_per_pair = 2;
constexpr double bytes_per_error = 0.5;  // standard errors, if kept: one byte for two entries
constexpr double bytes_per_patch = 1500;
constexpr double bytes_of_next_mesh = 1000;  // per patch where rows of rays are refined
constexpr double bytes_of_program = 50e6;

double bytes_of_a_pair(const AssemblyOptions& assembly, const AccuracyOptions& accuracy) {
  if (!keeps_entries(assembly.storage)) return 0;
  // With another matrix before closure, and at the end of a mesh that of the next.
  if (refines(accuracy)) return bytes_per_pair + 5.5;
  // With the matrix of the parents while it is summed up.
  if (accuracy.error_bars) return 2 * bytes_per_pair + bytes_per_error + 0.7;
  return bytes_per_pair + (assembly.keep_errors ? bytes_per_error : 0);
}

double bytes_of_a_patch(const AssemblyOptions& assembly, const AccuracyOptions& accuracy, const LightInMemory& light) {
  if (assembly.storage == Storage::rays) {
    // Rows with one band of light, two more bands, and the rays, which stop at mirrors and clear faces twice on
    // average.
    return bytes_per_patch + 180 + (light.in_colour ? 1100 : 0) + (refines(accuracy) ? bytes_of_next_mesh : 0) +
           (light.is_mirrored ? 32.0 : 4.0) * assembly.rays;
  }
  // Progressive refinement keeps a coarse transport that it has learned from rows.
  return bytes_per_patch + (keeps_entries(assembly.storage) ? 0 : 300);
}

LightInMemory light_in_memory(const Plan& plan) {
  return {simulates(plan, Effect::colour), simulates(plan, Effect::mirrors)};
}

// The scene and the tree of the ray tracer.
double bytes_of_polygons(const Plan& plan) { return 1500 * static_cast<double>(plan.sides.front.size()); }

double installed_bytes() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
}

// Advice where pairs do not fit but rows of rays would.
std::string advice_by_rays(std::size_t patches, const Plan& plan) {
  if (plan.assembly.storage != Storage::tiles) return {};
  Plan rays = plan;
  rays.assembly.storage = Storage::rays;
  if (memory_needed(patches, rays) > usable_memory(plan.resources)) return {};
  return "\nhint: or use assembly.storage=rays";
}

// Requests and plans have these parts in common.
template <typename Parts>
Parts stored_as_rays(Parts parts) {
  parts.assembly.storage = Storage::rays;
  if (parts.solver.solver == Solver::cg) parts.solver.solver = Solver::gmres;
  return parts;
}

// Pairs of more patches take tens of seconds, and rows of rays one or two: docs/concepts/pairs-and-rays.md.
constexpr std::size_t most_patches_in_pairs = 10000;

// True if sides have few patches each: the discretization error exceeds the noise of rays, which take much less time
// than pairs. False during refinement to an accuracy, where faces are cut as needed and the noise of rays would limit
// the accuracy.
bool has_coarse_sides(const StoredLight& light, const Request& request) {
  return light.patches >= 1000 && light.patches < 32 * light.sides && !refines(request.accuracy);
}

std::string reason_for_rays(const StoredLight& light, const Request& request, double bytes) {
  if (light.is_mirrored) return "which follow light over glazing and mirrors in each band";
  if (light.has_goal) return "because the patches are concentrated on a goal";
  if (light.patches <= most_patches_in_pairs && has_coarse_sides(light, request))
    return "because " + std::to_string(light.patches) + " patches are few for " + std::to_string(light.sides) +
           " sides of faces: all pairs would take longer";
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

std::string gigabytes(double bytes) {
  std::ostringstream text;
  text << std::setprecision(3) << bytes / 1e9 << " GB";
  return text.str();
}

std::string memory_refused(double bytes, const Resources& resources) {
  return "takes " + gigabytes(bytes) + ", and " + gigabytes(usable_memory(resources)) +
         (resources.memory ? " is allowed (resources.memory)" : " is available");
}

double memory_needed(std::size_t patches, const AssemblyOptions& assembly, const AccuracyOptions& accuracy,
                     const LightInMemory& light) {
  const auto n = static_cast<double>(patches);
  return bytes_of_a_pair(assembly, accuracy) * n * n + bytes_of_a_patch(assembly, accuracy, light) * n +
         bytes_of_program;
}

double memory_needed(std::size_t patches, const Plan& plan) {
  return memory_needed(patches, plan.assembly, plan.accuracy, light_in_memory(plan)) + bytes_of_polygons(plan);
}

bool may_keep_solution(std::size_t patches, const Plan& plan) {
  return memory_needed(patches, plan) + 600 * static_cast<double>(patches) <= usable_memory(plan.resources);
}

double memory_of_next_mesh(std::size_t patches, double times_the_rays, Plan plan) {
  plan.assembly.rays = static_cast<int>(std::ceil(times_the_rays * plan.assembly.rays));
  return memory_needed(patches, plan) + bytes_of_next_mesh * static_cast<double>(patches);
}

bool fits_as_next_mesh(std::size_t patches, double times_the_rays, const Plan& plan) {
  return memory_of_next_mesh(patches, times_the_rays, plan) <= usable_memory(plan.resources);
}

double usable_memory(const Resources& resources) { return resources.memory.value_or(0.8 * installed_bytes()); }

double patches_that_fit(const Plan& plan) {
  const double left = std::max(0.0, usable_memory(plan.resources) - bytes_of_program - bytes_of_polygons(plan));
  const double of_a_patch = bytes_of_a_patch(plan.assembly, plan.accuracy, light_in_memory(plan));
  const double of_a_pair = bytes_of_a_pair(plan.assembly, plan.accuracy);
  if (of_a_pair == 0) return std::max(1.0, left / of_a_patch);
  const double half = of_a_patch / (2 * of_a_pair);
  return std::max(1.0, std::sqrt(half * half + left / of_a_pair) - half);
}

void require_memory(std::size_t patches, const Request& request, const Plan& plan) {
  const double needed = memory_needed(patches, plan);
  const double usable = usable_memory(plan.resources);
  if (needed <= usable) return;
  const auto fitting = static_cast<long>(patches_that_fit(plan));
  // Each small face needs a patch of its own, whatever the requested number.
  const bool too_many_faces = !request.mesh.max_edge && static_cast<long>(patches_asked(request)) <= fitting;
  const std::string by_rays = advice_by_rays(patches, plan);
  const std::string hint = usable <= 2 * bytes_of_program ? ": the program itself needs " + gigabytes(bytes_of_program)
                           : too_many_faces
                               ? ". Each face needs a patch\nhint: simplify the model, or leave objects out" + by_rays
                               : "\nhint: at most mesh.patches " + std::to_string(fitting) + by_rays;
  throw MemoryError(std::to_string(patches) + " patches need about " + gigabytes(needed) + ", and " +
                    gigabytes(usable) + (plan.resources.memory ? " is allowed (resources.memory)" : " is available") +
                    hint);
}

std::size_t least_patches_with(const Scene& scene, const KeptSides& sides, double max_edge,
                               const ContactLines& contacts) {
  // Numbers too large to count are clamped.
  const double by_area = std::min(kept_area(scene, sides) / (max_edge * max_edge), 1e18);
  return std::max(least_patches(scene, sides, contacts), static_cast<std::size_t>(by_area));
}

void require_memory(const Scene& scene, const Request& request, const Plan& plan) {
  const std::optional<double>& edge = request.mesh.max_edge;
  require_memory(edge ? least_patches_with(scene, plan.sides, *edge, plan.contacts) : patches_asked(request), request,
                 plan);
}

Request by_rays(Request request) { return stored_as_rays(std::move(request)); }

Plan by_rays(Plan plan) {
  plan = stored_as_rays(std::move(plan));
  plan.assembly.keep_errors = false;
  for (Decision& decision : plan.decisions)
    if (decision.effect == Effect::closure) decision = closed_by_rays();
  return plan;
}

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
