#include "accuracy/unseen_differences.h"

#include "accuracy/means_around.h"
#include "accuracy/quarters_gather.h"
#include "accuracy/refinement.h"
#include "base/sampling.h"
#include "solve/scattering.h"

#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

namespace patchlight {
namespace {

// The differences of radiosity inside patches, as one set of rays finds them.
struct Differences {
  GatheredQuarters rays;
  Field of_quarters;           // from the mean of the patch, W/m^2
  Field at_patches;            // what they change of the irradiance of each patch, W/m^2
  Eigen::ArrayXd part_of_ray;  // per quarter: what part of the mean over its patch one ray is

  // Those that are met from a quarter.
  std::span<const PatchIndex> met_from(PatchIndex quarter) const {
    return std::span(rays.met).subspan(quarter * rays_per_quarter, rays_per_quarter);
  }
};

// rho (H_q - H), where H is the mean over what is exposed of the quarters.
Field differences_of_quarters(const GatheredQuarters& rays, const FieldView& irradiance, const Scattering& scattering) {
  Field difference = Field::Zero(irradiance.rows(), irradiance.cols());
  for (Eigen::Index i = 0; i < irradiance.rows() / 4; ++i) {
    const auto exposed = rays.exposed.segment<4>(4 * i);
    if (exposed.sum() == 0) continue;
    const Field mean = (irradiance.middleRows<4>(4 * i).colwise() * exposed).colwise().sum() / exposed.sum();
    for (Eigen::Index q = 4 * i; q < 4 * (i + 1); ++q)
      if (rays.exposed[q] > 0) difference.row(q) = reflect_at(scattering, i, Field(irradiance.row(q) - mean));
  }
  return difference;
}

// What part of the mean over its patch one ray from each quarter is.
Eigen::ArrayXd parts_of_rays(const GatheredQuarters& rays, const PatchMesh& quarters) {
  Eigen::ArrayXd part(rays.exposed.size());
  for (Eigen::Index q = 0; q < part.size(); ++q) {
    const double exposed = rays.exposed.segment<4>(q - q % 4).sum();
    part[q] = exposed > 0 ? quarters.area[static_cast<std::size_t>(q)] / (exposed * rays_per_quarter) : 0;
  }
  return part;
}

// As much flux arrives as the differences send, sum_q A_q dB_q over what sees patches: next to none, where nothing is
// lost. What noise adds to it, all reflections would multiply.
Field with_flux_sent(const QuarteredMesh& mesh, const Eigen::VectorXd& area, const Differences& differences) {
  Field off = Field::Zero(1, differences.of_quarters.cols());
  for (PatchIndex q = 0; q < mesh.quarters.size(); ++q)
    off += differences.rays.exposed[q] * differences.rays.seen[q] * differences.of_quarters.row(q);
  off -= (differences.at_patches.colwise() * area.array()).colwise().sum();
  return differences.at_patches + (off / area.sum()).replicate(area.size(), 1);
}

Differences find_differences(GatheredQuarters rays, const PatchMesh& quarters, const Field& direct,
                             const Scattering& scattering) {
  const Field irradiance = direct.size() > 0 ? Field(rays.irradiance + direct) : rays.irradiance;
  Differences found{std::move(rays), {}, Field::Zero(irradiance.rows() / 4, irradiance.cols()), {}};
  found.part_of_ray = parts_of_rays(found.rays, quarters);
  found.of_quarters = differences_of_quarters(found.rays, irradiance, scattering);
  for (PatchIndex q = 0; q < quarters.size(); ++q) {
    for (const PatchIndex met : found.met_from(q))
      if (met != no_patch) found.at_patches.row(q / 4) += found.part_of_ray[q] * found.of_quarters.row(met);
  }
  return found;
}

// What the differences of each patch have in common with the changes that other rays find: sum_i w_i c_i dH_i.
Eigen::VectorXd parts_in(const Field& weighted_changes, const Differences& differences) {
  Eigen::VectorXd parts = Eigen::VectorXd::Zero(weighted_changes.rows());
  for (PatchIndex q = 0; q < differences.part_of_ray.size(); ++q) {
    for (const PatchIndex met : differences.met_from(q)) {
      if (met == no_patch) continue;
      const double change = (weighted_changes.row(q / 4) * differences.of_quarters.row(met)).sum();
      parts[met / 4] += differences.part_of_ray[q] * change;
    }
  }
  return parts;
}

}  // namespace

UnseenDifferences unseen_differences(const QuarteredMesh& mesh, const Occluder& occluder, const RowTransport& transport,
                                     const SolvedProblem& solved, const Eigen::VectorXd& weight, std::uint64_t seed,
                                     const Observer& observer) {
  // 1. Twice, with other rays.
  const auto found = [&](std::size_t half) {
    GatheredQuarters rays = gather_at_quarters(mesh, occluder, solved, hash({seed, half, 0x9a7}), observer);
    return find_differences(std::move(rays), mesh.quarters, mesh.direct[half], solved.problem.scattering);
  };
  const Differences one = found(0);
  const Differences other = found(1);

  // 2. Through all reflections; what is finer than the quarters is extrapolated.
  const double scale = 1 / (1 - std::pow(2.0, -mesh_order));
  const auto through_reflections = [&](const Differences& differences) {
    return followed(transport, solved.problem, with_flux_sent(mesh, solved.problem.area, differences));
  };
  const Field square = through_reflections(one) * through_reflections(other);
  UnseenDifferences unseen;
  unseen.error = scale * mean_around(mesh.whole, solved.problem.area, square).max(0.0).sqrt();

  // 3. Where it comes from.
  const Field weights = weight_of_squares(solved, weight).colwise() * solved.problem.area.array().square();
  unseen.effects =
      (parts_in(weights * one.at_patches, other) + parts_in(weights * other.at_patches, one)) * (scale * scale / 2);
  unseen.effects = unseen.effects.cwiseMax(0.0);
  return unseen;
}

}  // namespace patchlight
