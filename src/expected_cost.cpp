#include "patchlight/expected_cost.h"

#include "memory.h"

#include <algorithm>
#include <thread>

namespace patchlight {
namespace {

// Processor seconds on one core of an AMD EPYC. Pairs with shadow rays: the geometric mean of two blocks (1.2e-7), two
// furnished rooms (1.9e-7) and 500 boxes (8e-7) of docs/form_factors.md at 8 probes and 16 samples. Without: an empty
// room (tests/benchmarks/effects.cpp).
constexpr double seconds_per_pair = 2.6e-7;
constexpr double seconds_per_free_pair = 2.5e-8;
constexpr int usual_samples = 16;

// A row on demand looks at clusters that a matrix looks at for sixteen rows at once.
constexpr double row_on_demand = 2;

constexpr double seconds_per_hemisphere_ray = 1e-6;
constexpr double seconds_per_light_ray = 2.2e-7;  // docs/lights.md: 0.9 s for 3,980 patches and 1,024 rays

// Closure takes some 40 products with the matrix, a solver some 15; a product of n^2 entries.
constexpr double products_of_closure = 40;
constexpr double products_of_solver = 15;
constexpr double seconds_per_entry = 5e-10;

// Pairs whose exchange areas are found: of all patches, or of the lamps with all.
double pairs(const Scene& scene, const Plan& plan, double patches) {
  if (simulates(plan, Effect::interreflection) || plan.close) return patches * patches / 2;
  double lit = 0;
  double all = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const double area = area_vector(corner_points(scene, p)).norm();
    all += area * (plan.sides.front[p] + plan.sides.back[p]);
    if (is_lamp(scene, p)) lit += area;
  }
  return all > 0 ? row_on_demand * patches * patches * std::min(1.0, lit / all) : 0;
}

double rays_per_patch(const Scene& scene, const Plan& plan) {
  double rays = 0;
  if (simulates(plan, Effect::luminaires)) rays += 64.0 * static_cast<double>(scene.luminaires.size());
  if (scene.sun && simulates(plan, Effect::sun)) rays += 64;
  if (scene.sky && simulates(plan, Effect::sky)) rays += 1024;
  return rays;
}

}  // namespace

ExpectedCost expected_cost(const Scene& scene, const Plan& plan, const Request& request, std::size_t patches) {
  const auto n = static_cast<double>(patches);
  Request used = request;
  used.on_demand = plan.on_demand;
  ExpectedCost cost{.patches = patches, .bytes = memory_needed(patches, used)};
  cost.threads =
      request.threads > 0 ? request.threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));

  const double with_rays = seconds_per_pair * std::max(1.0, static_cast<double>(plan.samples) / usual_samples);
  const double per_pair = simulates(plan, Effect::occlusion) ? with_rays : seconds_per_free_pair;
  cost.form_factor_seconds = per_pair * pairs(scene, plan, n) + seconds_per_hemisphere_ray * plan.lost_share_rays * n;
  cost.direct_light_seconds = seconds_per_light_ray * rays_per_patch(scene, plan) * n;
  const bool solves = simulates(plan, Effect::interreflection);
  const double products = (plan.close ? products_of_closure : 0) + (solves ? products_of_solver : 0);
  cost.solve_seconds = seconds_per_entry * products * n * n;
  return cost;
}

}  // namespace patchlight
