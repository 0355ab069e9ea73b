#include "accuracy/quarters_gather.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "form_factor/patch_keys.h"
#include "form_factor/point_polygon.h"
#include "mesh/patch_lookup.h"
#include "transport/patch_frame.h"
#include "transport/sights.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace patchlight {
namespace {

// Emitting patches as another one sees them, to be chosen by about what they send there when nothing is in the way.
struct ChoiceOfLamps {
  const std::vector<PatchIndex>& lamps;
  std::vector<double> before;  // of those before each; one more entry at the end

  struct Chosen {
    PatchIndex lamp;
    double probability;
    double u;  // what the choice leaves of the number, in [0, 1) again
  };

  // The one that belongs to this number of [0, 1).
  Chosen at(double u) const {
    const double place = u * before.back();
    const auto next = std::upper_bound(before.begin(), before.end() - 1, place);
    const auto k = static_cast<std::size_t>(next - before.begin()) - 1;
    const double of_lamp = before[k + 1] - before[k];
    return {lamps[k], of_lamp / before.back(), std::clamp((place - before[k]) / of_lamp, 0.0, 1.0)};
  }
};

ChoiceOfLamps choice_of_lamps(const PatchMesh& mesh, PatchIndex patch, const std::vector<PatchIndex>& lamps,
                              const Field& exitance) {
  constexpr double least_cosine = 0.05;  // of a lamp whose centroid is below the horizon some may be above it
  ChoiceOfLamps choice{lamps, {0}};
  for (const PatchIndex lamp : lamps) {
    const Vector toward = mesh.centroid[lamp] - mesh.centroid[patch];
    const double squared = toward.squaredNorm() + mesh.area[lamp];
    const double distance = std::sqrt(squared);
    const double cosines = std::max(least_cosine, mesh.normal[patch].dot(toward) / distance) *
                           std::max(least_cosine, -mesh.normal[lamp].dot(toward) / distance);
    choice.before.push_back(choice.before.back() + exitance.row(lamp).mean() * mesh.area[lamp] * cosines / squared);
  }
  return choice;
}

class Gather {
 public:
  // Lamps that are many patches are left in the reflected light: rays over the hemisphere find them.
  Gather(const QuarteredMesh& mesh, const Occluder& occluder, const SolvedProblem& solved, std::uint64_t with_seed)
      : whole_(mesh.whole),
        quarters_(mesh.quarters),
        occluder_(occluder),
        sights_(mesh.quarters, occluder),
        lookup_(mesh.quarters),
        keys_(patch_keys(mesh.whole)),
        covered_(mesh.covered),
        exitance_(solved.problem.exitance),
        sent_(solved.solution.radiosity),
        seed_(with_seed) {
    for (PatchIndex i = 0; i < whole_.size(); ++i)
      if ((exitance_.row(i) > 0).any()) lamps_.push_back(i);
    if (static_cast<double>(lamps_.size()) > most_lamps * whole_.size()) lamps_.clear();
    if (!lamps_.empty()) sent_ -= exitance_;
  }

  void at(PatchIndex patch, GatheredQuarters& into) const;

 private:
  enum class Purpose : std::uint64_t { hemisphere, lamps, clear };
  std::uint32_t seed_of(PatchIndex patch, Purpose purpose) const {
    return hash({seed_, keys_[patch], static_cast<std::uint64_t>(purpose)});
  }
  std::vector<Ray> hemisphere_rays(PatchIndex quarter) const;
  Field straight_from_lamps(PatchIndex patch, std::span<const std::vector<Ray>> rays) const;
  void add_hemisphere(PatchIndex quarter, std::span<const Seen> seen, GatheredQuarters& into) const;

  const PatchMesh& whole_;
  const PatchMesh& quarters_;
  const Occluder& occluder_;
  Sights sights_;
  PatchLookup lookup_;
  std::vector<std::uint32_t> keys_;
  std::vector<PatchIndex> lamps_;
  const Eigen::VectorXd& covered_;
  const Field& exitance_;
  Field sent_;  // what rays over the hemisphere find of the radiosity
  std::uint64_t seed_;
};

// The same directions from the same places of all quarters.
std::vector<Ray> Gather::hemisphere_rays(PatchIndex quarter) const {
  const PatchIndex patch = quarter / 4;
  const PatchCorners corners = quarters_.corner_points(quarter);
  const Eigen::Matrix3d frame = patch_frame(whole_, patch);
  std::vector<Ray> rays;
  for (const auto& sample : scrambled_sobol(rays_per_quarter, seed_of(patch, Purpose::hemisphere)))
    rays.push_back({square_to_quad(corners.points, sample[0], sample[1]),
                    frame * square_to_cosine_hemisphere(sample[2], sample[3]), whole_.polygon[patch]});
  return rays;
}

// E F V / p for a lamp that is chosen with probability p, F exact: a row for each ray, by its origin, those of the
// first quarter first. All quarters look to the same points of the same lamps.
Field Gather::straight_from_lamps(PatchIndex patch, std::span<const std::vector<Ray>> rays) const {
  Field irradiance = Field::Zero(4 * rays_per_quarter, exitance_.cols());
  if (lamps_.empty()) return irradiance;
  const ChoiceOfLamps choice = choice_of_lamps(whole_, patch, lamps_, exitance_);
  const auto samples = scrambled_sobol(rays_per_quarter, seed_of(patch, Purpose::lamps));
  std::vector<Segment> segments;
  for (std::size_t q = 0; q < 4; ++q) {
    for (std::size_t k = 0; k < rays_per_quarter; ++k) {
      const auto [lamp, probability, u] = choice.at(samples[k][0]);
      const PatchCorners corners = whole_.corner_points(lamp);
      const Point& from = rays[q][k].origin;
      const double factor = point_to_polygon(from, whole_.normal[patch], corners);
      irradiance.row(static_cast<Eigen::Index>(segments.size())) = factor / probability * exitance_.row(lamp);
      const Point to = square_to_quad(corners.points, u, samples[k][1]);
      segments.push_back({from, to, whole_.polygon[patch], whole_.polygon[lamp]});
    }
  }
  const std::vector<float> arriving = occluder_.transmittance(segments);
  return irradiance.colwise() * Eigen::Map<const Eigen::ArrayXf>(arriving.data(), irradiance.rows()).cast<double>();
}

void Gather::add_hemisphere(PatchIndex quarter, std::span<const Seen> seen, GatheredQuarters& into) const {
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (seen[k].sight != Sight::patch) continue;
    const auto met = lookup_.patch_at(seen[k].hit->polygon, seen[k].hit->side, seen[k].hit->point);
    if (!met) continue;
    into.met[quarter * rays_per_quarter + k] = *met;
    into.irradiance.row(quarter) += sent_.row(*met / 4);
  }
}

// The mean is that over what is exposed: of a patch that solids cover in part, rays that meet backs start inside one.
void Gather::at(PatchIndex patch, GatheredQuarters& into) const {
  std::array<std::vector<Ray>, 4> rays;
  for (PatchIndex q = 0; q < 4; ++q) rays[q] = hemisphere_rays(4 * patch + q);
  const Field direct = straight_from_lamps(patch, rays);
  for (PatchIndex q = 4 * patch; q < 4 * (patch + 1); ++q) {
    const std::vector<Seen> seen = sights_.of_rays(q, rays[q % 4], seed_of(patch, Purpose::clear));
    int exposed = 0;
    for (std::size_t k = 0; k < seen.size(); ++k) {
      if (covered_[patch] > 0 && unseen({&seen[k], 1}) > 0) continue;
      ++exposed;
      into.irradiance.row(q) += direct.row(static_cast<Eigen::Index>((q % 4) * rays_per_quarter + k));
    }
    add_hemisphere(q, seen, into);
    into.irradiance.row(q) /= std::max(1, exposed);
    into.exposed[q] = quarters_.area[q] * exposed / rays_per_quarter;
    into.seen[q] = static_cast<double>(count(seen, Sight::patch)) / std::max(1, exposed);
  }
}

}  // namespace

GatheredQuarters gather_at_quarters(const QuarteredMesh& mesh, const Occluder& occluder, const SolvedProblem& solved,
                                    std::uint64_t seed, const Observer& observer) {
  const Gather gather(mesh, occluder, solved, seed);
  const Eigen::Index quarters = mesh.quarters.size();
  GatheredQuarters found{Field::Zero(quarters, solved.problem.exitance.cols()),
                         std::vector<PatchIndex>(mesh.quarters.size() * rays_per_quarter, no_patch),
                         Eigen::ArrayXd::Zero(quarters), Eigen::ArrayXd::Zero(quarters)};
  parallel_for(mesh.whole.size(), Stage::error_bars, observer,
               [&](std::size_t patch) { gather.at(static_cast<PatchIndex>(patch), found); });
  return found;
}

}  // namespace patchlight
