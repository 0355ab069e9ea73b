#include "patchlight/base/error.h"

#include "base/tolerances.h"
#include "base/vectors.h"
#include "mesh/interpolate.h"
#include "mesh/nested_mesh.h"
#include "mesh/patch_lookup.h"
#include "pipeline/first_mesh.h"
#include "plan/choose_storage.h"
#include "solve/scattering.h"
#include "study/study.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace patchlight {
namespace {

// Patches with a longer edge are cut into four; edges are at most twice as long.
PatchMesh cut_to(const PatchMesh& mesh, double max_edge) {
  std::vector<std::uint8_t> marked(mesh.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const double longest = std::sqrt(longest_edge_squared(mesh.corner_points(i)));
    marked[i] = longest > max_edge * (1 + tolerance_of_shapes);
  }
  return refine(mesh, marked).mesh;
}

// From 2^(count - 1) times the finest edge down to it.
std::vector<SizedMesh> all_sizes(const Scene& scene, const Plan& plan, double finest, int count) {
  std::vector<SizedMesh> all;
  for (int k = count - 1; k >= 0; --k) {
    const double edge = std::ldexp(finest, k);
    all.push_back({edge, all.empty() ? open_patches(scene, plan, edge) : cut_to(all.back().mesh, edge)});
  }
  return all;
}

// Halving edges overshoots: the edge for which the finest size has about as many patches as wanted.
double edge_for(const Scene& scene, const Plan& plan, double wanted, int sizes) {
  double best = plan.max_edge;
  double least = std::numeric_limits<double>::infinity();
  double edge = plan.max_edge;
  for (int guess = 0; guess < 6 && least > 0.1; ++guess) {
    const double found = all_sizes(scene, plan, edge, sizes).back().mesh.size();
    const double miss = std::abs(std::log(found / wanted));
    if (miss < least) least = miss, best = edge;
    edge *= std::sqrt(found / wanted);
  }
  return best;
}

void require_memory_for_reference(std::size_t patches, const Request& request, const Plan& plan) {
  try {
    require_memory(patches, request, plan);
  } catch (const MemoryError& error) {
    throw MemoryError(std::string("the reference of a study has about four times the patches asked for: ") +
                      error.what());
  }
}

// The means of the reference over each patch of a mesh.
struct Means {
  Field radiosity;
  Field spread;  // variance about it
};

Means means_over(const Simulation& simulation, const Reference& reference) {
  const Field& own = simulation.solution.radiosity;
  if (reference.uniform) {
    return {reference.uniform->replicate(own.rows(), 1), Field::Zero(own.rows(), own.cols())};
  }
  // Over the exposed part of the patch: each patch of the reference counts by its own.
  const Eigen::Map<const Eigen::ArrayXd> area(reference.mesh.area.data(), reference.mesh.size());
  const Field share = reference.problem.area.array() / area;
  const Field seen = average_over(simulation.mesh, reference.mesh, share);
  const auto mean = [&](const Field& values) -> Field {
    const Field sum = average_over(simulation.mesh, reference.mesh, values.colwise() * share.col(0));
    return sum.colwise() / seen.col(0);
  };
  const Field radiosity = mean(reference.radiosity);
  const Field squares = mean(reference.radiosity.square());
  return {radiosity, (squares - radiosity.square()).max(0)};
}

}  // namespace

NestedSizes nested_sizes(const Scene& scene, const Request& request, int sizes) {
  Plan plan = make_plan(scene, request);
  const double patches = open_patches(scene, plan, plan.max_edge).size();
  plan.contacts.of_edge = 0.5;  // as meshes with error bars have it, which the largest patches are the parents of
  const double finest = request.mesh.max_edge ? plan.max_edge : edge_for(scene, plan, patches, sizes);
  std::vector<SizedMesh> all = all_sizes(scene, plan, finest / 2, sizes + 1);
  NestedSizes result{{}, std::move(all.back()), all.front().max_edge};
  require_memory_for_reference(result.finer.mesh.size(), request, plan);
  all.pop_back();
  for (std::size_t k = 0; k < all.size(); ++k) {
    const bool last = k + 1 == all.size();
    if (!last && all[k].mesh.size() > 0.5 * all[k + 1].mesh.size()) continue;
    result.sizes.push_back(std::move(all[k]));
  }
  return result;
}

PatchMesh finer_than(PatchMesh mesh, const PatchMesh& other) {
  const PatchLookup lookup(other);
  for (;;) {
    std::vector<std::uint8_t> cut(mesh.size(), 0);
    for (PatchIndex i = 0; i < mesh.size(); ++i) {
      const auto there = lookup.patch_at(mesh.polygon[i], mesh.side[i], mesh.centroid[i]);
      cut[i] = there && mesh.area[i] > 0.25 * (1 + tolerance_of_coordinates) * other.area[*there] ? 1 : 0;
    }
    if (std::count(cut.begin(), cut.end(), 1) == 0) return mesh;
    mesh = refine(mesh, cut).mesh;
  }
}

Reference reference_from(const Simulation& finer) {
  return {std::nullopt, finer.mesh, finer.problem, finer.solution.radiosity};
}

std::optional<Spectrum> furnace_radiosity(const RadiosityProblem& problem) {
  const Field absorbed = absorb(problem.scattering, Field::Ones(problem.exitance.rows(), problem.exitance.cols()));
  const Eigen::ArrayXd absorbed_sum = sum_over_patches(absorbed);
  const Eigen::ArrayXd exitance_sum = sum_over_patches(problem.exitance);
  Spectrum c = Spectrum::Zero(absorbed.cols());
  for (Eigen::Index band = 0; band < c.size(); ++band) {
    if (absorbed_sum[band] > 0) c[band] = exitance_sum[band] / absorbed_sum[band];
  }
  const Field expected = absorbed.rowwise() * c;
  const Field difference = (problem.exitance - expected).abs();
  const bool holds = ((difference.rowwise() - tolerance_of_shapes * c) <= 0).all();
  return holds && (c > 0).any() ? std::optional(c) : std::nullopt;
}

Discrepancy discrepancy(const Simulation& simulation, const Reference& reference) {
  const Eigen::VectorXd& area = simulation.problem.area;
  const Means means = means_over(simulation, reference);
  const double patches = simulation.mesh.size();
  const double hidden = reference.uniform ? 1 : std::max(0.1, 1 - patches / reference.mesh.size());

  Discrepancy result;
  result.of_means = relative_error(means.radiosity, simulation.solution.radiosity, simulation.problem);
  result.squares = Eigen::VectorXd::Zero(area.size());
  const Eigen::ArrayXd size = area_norm(means.radiosity - simulation.problem.exitance, area).square();
  const Field squares = (means.radiosity - simulation.solution.radiosity).square().colwise() * area.array();
  const Field spread = means.spread.colwise() * area.array();
  double worst = 0;
  for (Eigen::Index band = 0; band < size.size(); ++band) {
    if (!(size[band] > 0)) continue;
    const double of_means = squares.col(band).sum() / size[band];
    const double of_display = of_means + spread.col(band).sum() / hidden / size[band];
    result.of_display = std::max(result.of_display, std::sqrt(of_display));
    if (of_means < worst) continue;
    worst = of_means;
    result.squares = squares.col(band).matrix() / size[band];
  }
  return result;
}

}  // namespace patchlight
