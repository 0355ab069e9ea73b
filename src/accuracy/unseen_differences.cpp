#include "accuracy/unseen_differences.h"

#include "accuracy/refinement.h"
#include "base/sampling.h"
#include "mesh/interpolate.h"
#include "mesh/small_patches.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>

namespace patchlight {
namespace {

// What is seen of each patch from afar.
struct SeenFromAfar {
  Field difference;                    // of its radiosity from the patch's mean, W/m^2
  std::vector<std::uint8_t> is_known;  // 0: no ray has told
};

// The differences of radiosity inside patches, as one set of rays finds them.
struct Differences {
  GatheredQuarters rays;  // without their irradiance
  Field of_irradiance;    // of each quarter from the mean of its patch, W/m^2, as long as it is needed
  Field of_quarters;      // of radiosity, the same
  SeenFromAfar from_afar;
  Field at_patches;  // what they change of the irradiance of each patch, W/m^2
  Field by_points;   // W: the part of these by single points, which quarters do not send; one row

  // Calls `visit` with each patch that is met from a quarter, the difference of radiosity there, one row, and whether
  // it is that of the point.
  void for_met_from(PatchIndex quarter, const Field& reflected, const auto& visit) const {
    const auto count = static_cast<std::size_t>(rays.rays);
    for (std::size_t ray = quarter * count; ray < (quarter + 1) * count; ++ray) {
      const PatchIndex met = rays.met[ray];
      if (met == no_patch) continue;
      if (const std::optional<double> more = more_at_point(rays.seen_as[ray])) {
        visit(met / 4, *more * reflected.row(met / 4), true);
        continue;
      }
      const bool by_patch = rays.seen_as[ray] == seen_as_whole && from_afar.is_known[met / 4] != 0;
      visit(met / 4, by_patch ? from_afar.difference.row(met / 4) : of_quarters.row(met), false);
    }
  }
};

// H_q - H, where H is the mean over what is exposed of the quarters.
Field differences_of_irradiance(const GatheredQuarters& rays, const FieldView& irradiance) {
  Field difference = Field::Zero(irradiance.rows(), irradiance.cols());
  for (Eigen::Index first = 0; first < irradiance.rows(); first += 4) {
    const auto exposed = rays.exposed.segment<4>(first);
    if (exposed.sum() == 0) continue;
    const Field mean = (irradiance.middleRows<4>(first).colwise() * exposed).colwise().sum() / exposed.sum();
    for (Eigen::Index q = first; q < first + 4; ++q)
      if (rays.exposed[q] > 0) difference.row(q) = irradiance.row(q) - mean;
  }
  return difference;
}

// Every value four times.
Field of_quarters(const Field& of_patches) {
  Field values(4 * of_patches.rows(), of_patches.cols());
  for (Eigen::Index q = 0; q < values.rows(); ++q) values.row(q) = of_patches.row(q / 4);
  return values;
}

// The quarter that lies on the other side of a sheet from this one of a patch.
PatchIndex quarter_behind(const PatchMesh& mesh, PatchIndex quarter, PatchIndex other_patch) {
  if (other_patch == quarter / 4) return quarter;
  const PatchCorners corners = quarter_of(mesh.corner_points(quarter / 4), static_cast<int>(quarter % 4));
  const PatchCorners behind = mesh.corner_points(other_patch);
  return 4 * other_patch +
         static_cast<PatchIndex>(quarter_at(behind, mesh.normal[other_patch], area_centroid(corners)));
}

// R H of quarters, R that of their patches.
Field reflected_at_quarters(const PatchMesh& mesh, const Scattering& scattering, const Field& irradiance) {
  if (scattering.is_diagonal()) {
    Field radiosity = irradiance;
    for (Eigen::Index q = 0; q < radiosity.rows(); ++q) radiosity.row(q) *= scattering.reflectance.row(q / 4);
    return radiosity;
  }
  Scattering by_quarters{of_quarters(scattering.reflectance)};
  by_quarters.transmittance = of_quarters(scattering.transmittance);
  for (PatchIndex q = 0; q < 4 * mesh.size(); ++q)
    by_quarters.other_side.push_back(quarter_behind(mesh, q, scattering.other_side[q / 4]));
  return by_quarters.reflect(irradiance);
}

// Root mean squares over the quarters of each patch of what both sets of rays find; quarters of a field that is linear
// have three quarters of the variance of its points.
Field display_of(const Differences& one, const Differences& other) {
  const Field product = one.of_irradiance * other.of_irradiance;
  Field mean = Field::Zero(product.rows() / 4, product.cols());
  for (Eigen::Index q = 0; q < product.rows(); ++q) mean.row(q / 4) += product.row(q) / 3;
  return mean;
}

// As much flux arrives as the differences send, sum_q A_q dB_q over what sees patches: next to none, where nothing is
// lost. What noise adds to it, all reflections would multiply. What is seen is that of other rays, as what one set
// finds of it goes with what it finds of the light. Where points stand for quarters, only the
// arriving side is without them, which is taken to be little.
Field with_flux_sent(const Eigen::VectorXd& area, const Differences& differences, const GatheredQuarters& other) {
  Field off = Field::Zero(1, differences.of_quarters.cols());
  for (Eigen::Index q = 0; q < differences.of_quarters.rows(); ++q) {
    const double exposed = differences.rays.exposed.segment<4>(q - q % 4).sum();
    if (exposed == 0) continue;
    const double of_patch = differences.rays.exposed[q] / exposed;
    off += area[q / 4] * of_patch * other.seen[q] * differences.of_quarters.row(q);
  }
  off -= (differences.at_patches.colwise() * area.array()).colwise().sum() - differences.by_points;
  return differences.at_patches + (off / area.sum()).replicate(area.size(), 1);
}

// From afar the quarters of a patch are seen alike, and their differences cancel, unless something close to some of
// them hides these. By reciprocity each of them counts by how much of what is far can be seen from it: that is told by
// other rays, as in these it goes with the light.
SeenFromAfar seen_from_afar(const Field& of_quarters, const GatheredQuarters& rays, const Eigen::ArrayXd& open) {
  const Eigen::ArrayXd weight = rays.exposed * open;
  const Eigen::Index patches = of_quarters.rows() / 4;
  SeenFromAfar seen{Field::Zero(patches, of_quarters.cols()),
                    std::vector<std::uint8_t>(static_cast<std::size_t>(patches), 0)};
  for (Eigen::Index i = 0; i < patches; ++i) {
    const double sum = weight.segment<4>(4 * i).sum();
    if (!(sum > 0)) continue;
    seen.is_known[static_cast<std::size_t>(i)] = 1;
    for (Eigen::Index q = 4 * i; q < 4 * i + 4; ++q) seen.difference.row(i) += weight[q] / sum * of_quarters.row(q);
  }
  return seen;
}

Differences find_differences(GatheredQuarters rays, const Field& direct, const Eigen::ArrayXd& open,
                             const SolvedPatches& patches, const Field& reflected) {
  Field irradiance = std::exchange(rays.irradiance, {});
  if (direct.size() > 0) irradiance += direct;
  const Scattering& scattering = patches.solved.problem.scattering;
  Differences found{std::move(rays),
                    {},
                    {},
                    {},
                    Field::Zero(irradiance.rows() / 4, irradiance.cols()),
                    Field::Zero(1, irradiance.cols())};
  found.of_irradiance = differences_of_irradiance(found.rays, irradiance);
  found.of_quarters = reflected_at_quarters(patches.mesh, scattering, found.of_irradiance);
  found.from_afar = seen_from_afar(found.of_quarters, found.rays, open);
  for (PatchIndex q = 0; q < found.of_quarters.rows(); ++q) {
    found.for_met_from(q, reflected, [&](PatchIndex, const auto& difference, bool of_point) {
      const auto part = found.rays.part_of_ray[q] * difference;
      found.at_patches.row(q / 4) += part;
      if (of_point) found.by_points += patches.solved.problem.area[q / 4] * part;
    });
  }
  return found;
}

// What the differences of each patch have in common with the changes that other rays find: sum_i w_i c_i dH_i.
Eigen::VectorXd parts_in(const Field& weighted_changes, const Differences& differences, const Field& reflected) {
  Eigen::VectorXd parts = Eigen::VectorXd::Zero(weighted_changes.rows());
  for (PatchIndex q = 0; q < differences.rays.part_of_ray.size(); ++q) {
    differences.for_met_from(q, reflected, [&](PatchIndex met, const auto& difference, bool) {
      parts[met] += differences.rays.part_of_ray[q] * (weighted_changes.row(q / 4) * difference).sum();
    });
  }
  return parts;
}

}  // namespace

UnseenDifferences unseen_differences(const SolvedPatches& patches, const TransportOperator& transport,
                                     const Eigen::VectorXd& weight, const QuarterLook& look, const Observer& observer) {
  const SolvedProblem& solved = patches.solved;
  const Eigen::VectorXd& area = solved.problem.area;
  // 1. Twice, with other rays.
  const auto gathered = [&](std::size_t half) {
    return gather_at_quarters(patches, {look.rays, hash({look.seed, half, 0x9a7})}, observer);
  };
  std::array<GatheredQuarters, 2> rays{gathered(0), gathered(1)};
  const std::array<Eigen::ArrayXd, 2> open{std::exchange(rays[0].open, {}), std::exchange(rays[1].open, {})};
  const Field reflected = solved.solution.radiosity - solved.problem.exitance;
  const auto found = [&](std::size_t half) {
    return find_differences(std::move(rays[half]), look.direct[half], open[1 - half], patches, reflected);
  };
  Differences one = found(0);
  Differences other = found(1);
  // Where the two differ in sign the error is not known any better than that.
  const auto root_of_mean = [&](const Field& square) -> Field {
    return mean_around(patches.mesh, area, square).abs().sqrt();
  };
  UnseenDifferences unseen;
  unseen.display = root_of_mean(display_of(one, other));
  one.of_irradiance = other.of_irradiance = {};

  // 2. Through all reflections; what is finer than the quarters is extrapolated.
  const double scale = 1 / (1 - std::pow(2.0, -mesh_order));
  const auto through_reflections = [&](const Differences& differences, const Differences& of_other) -> Field {
    const Field change = followed(transport, solved.problem, with_flux_sent(area, differences, of_other.rays));
    // No more light can be too much than there is.
    return (scale * change).max(-solved.solution.irradiance);
  };
  const Field square =
      mean_around(patches.mesh, area, through_reflections(one, other) * through_reflections(other, one));
  unseen.error = square.abs().sqrt();
  unseen.noise = (square.abs() - square).sqrt();

  // 3. Where it comes from.
  const Field weights = weight_of_squares(solved, weight).colwise() * area.array().square();
  unseen.effects =
      parts_in(weights * one.at_patches, other, reflected) + parts_in(weights * other.at_patches, one, reflected);
  return unseen;
}

}  // namespace patchlight
