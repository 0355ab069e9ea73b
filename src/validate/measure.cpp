#include "validate/measure.h"

#include "form_factor/patch_shape.h"
#include "mesh/mesher.h"
#include "scene/repair.h"
#include "transport/merged.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace patchlight::validation {
namespace {

// What contour_exchange_area() promises of the relative error of one pair.
constexpr double closed_form_error = 1e-6;
// Entries are floats, narrowed toward zero.
constexpr double float_error = 0x1p-23;

// The mean of so many runs lies within so many of its standard errors: by Student's distribution with 15 degrees of
// freedom all but once in 900 cases, and as seeds are fixed a case that passes always does.
constexpr int runs = 16;
constexpr double standard_errors = 4;
constexpr int rays_per_pair = 16;

// Bound on the error of each pair, summed by group.
Eigen::MatrixXd error_between_groups(const ExchangeAreas& S, const PatchMesh& mesh,
                                     std::span<const std::uint32_t> group_of, std::uint32_t groups) {
  const std::vector<PatchShape> shapes = patch_shapes(mesh);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(groups, groups);
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (PatchIndex j = 0; j < mesh.size(); ++j) {
      const auto entry = static_cast<double>(S.at(i, j));
      if (entry == 0) continue;
      const double relative = is_near(shapes[i], shapes[j]) ? closed_form_error : quadrature_error;
      sum(group_of[i], group_of[j]) += (relative + float_error) * entry;
    }
  }
  return sum;
}

}  // namespace

GroupExchange group_exchange(const Scene& scene, double max_edge, const AssemblyOptions& options,
                             const Observer& observer) {
  const Scene repaired = repair(scene);
  check(repaired);
  const PatchMesh mesh = tessellate(repaired, kept_sides(repaired, Sides::front), max_edge);
  const Assembly assembly = assemble_exchange_areas(mesh, Occluder(repaired), options, observer);

  const auto groups = static_cast<std::uint32_t>(repaired.groups.size());
  std::vector<std::uint32_t> group_of(mesh.size());
  Eigen::VectorXd area = Eigen::VectorXd::Zero(groups);
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    group_of[i] = repaired.polygons[mesh.polygon[i]].group;
    area[group_of[i]] += mesh.area[i];
  }
  return {exchange_between_groups(assembly.exchange_areas, group_of, groups),
          error_between_groups(assembly.exchange_areas, mesh, group_of, groups), area};
}

Measured unoccluded_form_factor(const Scene& scene, double max_edge, std::uint32_t to, const Observer& observer) {
  const GroupExchange exchange = group_exchange(scene, max_edge, {}, observer);
  return {exchange.exchange_area(0, to) / exchange.area[0], exchange.error(0, to) / exchange.area[0], "quadrature"};
}

Measured sampled_form_factor(const Scene& scene, double max_edge, std::uint32_t to, const Observer& observer) {
  double sum = 0;
  double sum_of_squares = 0;
  double systematic = 0;
  for (int run = 1; run <= runs; ++run) {
    const AssemblyOptions options{rays_per_pair, static_cast<std::uint64_t>(run)};
    const GroupExchange exchange = group_exchange(scene, max_edge, options, observer);
    const double form_factor = exchange.exchange_area(0, to) / exchange.area[0];
    sum += form_factor;
    sum_of_squares += form_factor * form_factor;
    systematic = std::max(systematic, exchange.error(0, to) / exchange.area[0]);
  }
  const double mean = sum / runs;
  const double variance = std::max(0.0, sum_of_squares / runs - mean * mean) / (runs - 1);  // of the mean
  return {mean, standard_errors * std::sqrt(variance) + systematic, "4 standard errors, quadrature"};
}

Measured refined(const Measured& coarse, const Measured& fine) {
  return {fine.value, std::abs(fine.value - coarse.value) + fine.error_bar, "refinement, " + fine.bar_from};
}

}  // namespace patchlight::validation
