#include "accuracy/quarters_gather.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "form_factor/pair_samples.h"
#include "form_factor/patch_keys.h"
#include "form_factor/point_polygon.h"
#include "mesh/patch_lookup.h"
#include "mesh/small_patches.h"
#include "transport/sights.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

namespace patchlight {

ChoiceOfLamps::Chosen ChoiceOfLamps::at(double u) const {
  const double place = u * before.back();
  const auto next = std::upper_bound(before.begin(), before.end() - 1, place);
  const auto k = static_cast<std::size_t>(next - before.begin()) - 1;
  const double of_lamp = before[k + 1] - before[k];
  return {lamps[k], of_lamp / before.back(), std::clamp((place - before[k]) / of_lamp, 0.0, 1.0)};
}

double ChoiceOfLamps::probability_of(PatchIndex patch) const {
  const auto place = std::lower_bound(lamps.begin(), lamps.end(), patch);
  if (place == lamps.end() || *place != patch) return 0;
  const auto k = static_cast<std::size_t>(place - lamps.begin());
  return (before[k + 1] - before[k]) / before.back();
}

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

ChoiceOfLamps choice_by_flux(const PatchMesh& mesh, const std::vector<PatchIndex>& lamps, const Field& exitance) {
  ChoiceOfLamps choice{lamps, {0}};
  for (const PatchIndex lamp : lamps)
    choice.before.push_back(choice.before.back() + exitance.row(lamp).mean() * mesh.area[lamp]);
  return choice;
}

namespace {

// More evaluations of lamps at patches than this are not worth their time: lamps are chosen by their flux then.
constexpr double most_evaluations = 2e7;

// From so far away, a distance in metres, the quarters of a patch look alike, but for what hides some of them.
bool is_far_from(const PatchCorners& corners, double distance) {
  constexpr double edges = 8;
  return distance * distance > edges * edges * longest_edge_squared(corners);
}

// How many rays have met a patch that is far from where they start.
int count_far(const PatchCorners& from, std::span<const Seen> seen) {
  return static_cast<int>(std::count_if(seen.begin(), seen.end(), [&](const Seen& one) {
    return one.sight == Sight::patch && is_far_from(from, one.hit->distance);
  }));
}

class Gather {
 public:
  // Lamps that are many patches are left in what rays over the hemisphere find.
  Gather(const SolvedPatches& patches, const RaysOfQuarters& rays)
      : mesh_(patches.mesh),
        occluder_(patches.occluder),
        sights_(patches.mesh, patches.occluder),
        lookup_(patches.mesh),
        keys_(patch_keys(patches.mesh)),
        covered_(patches.lost.covered),
        exitance_(patches.solved.problem.exitance),
        sent_(patches.solved.solution.radiosity),
        irradiance_(patches.solved.solution.irradiance),
        from_no_patch_(patches.solved.problem.direct_irradiance),
        rays_(rays) {
    for (PatchIndex i = 0; i < mesh_.size(); ++i)
      if ((exitance_.row(i) > 0).any()) lamps_.push_back(i);
    const auto lamps = static_cast<double>(lamps_.size());
    if (lamps > most_lamps * mesh_.size()) lamps_.clear();
    if (!lamps_.empty()) sent_ -= exitance_;
    takes_by_flux_ = lamps * mesh_.size() > most_evaluations;
    by_flux_ = choice_by_flux(mesh_, lamps_, exitance_);
  }

  void at(PatchIndex patch, GatheredQuarters& into) const;

 private:
  enum class Purpose : std::uint64_t { hemisphere, lamps, clear, at_points };
  std::uint32_t seed_of(PatchIndex patch, Purpose purpose) const {
    return hash({rays_.seed, keys_[patch], static_cast<std::uint64_t>(purpose)});
  }
  std::vector<Ray> hemisphere_rays(PatchIndex patch) const;
  std::vector<Seen> seen_along(PatchIndex patch, const std::vector<Ray>& rays) const;
  Field straight_from_lamps(PatchIndex patch, const std::vector<Ray>& rays) const;
  void add_hemisphere(PatchIndex patch, std::span<const Seen> seen, GatheredQuarters& into) const;
  bool may_be_darker_there(PatchIndex patch, PatchIndex met, const Hit& hit) const;
  bool finds_lamps(const Hit& hit) const;
  double part_by_shadow_rays(const ChoiceOfLamps& choice, PatchIndex lamp, double geometry) const;
  double from_a_lamp(const ChoiceOfLamps& choice, PatchIndex patch, const Point& point,
                     const std::array<double, 4>& sample) const;
  double from_hemisphere(const ChoiceOfLamps& choice, PatchIndex patch, const Point& point, const Seen& seen) const;
  double more_at(PatchIndex patch, const Point& point, std::uint32_t key) const;

  const PatchMesh& mesh_;
  const Occluder& occluder_;
  Sights sights_;
  PatchLookup lookup_;
  std::vector<std::uint32_t> keys_;
  std::vector<PatchIndex> lamps_;
  ChoiceOfLamps by_flux_;
  bool takes_by_flux_ = false;  // everywhere
  const Eigen::VectorXd& covered_;
  const Field& exitance_;
  Field sent_;  // what rays over the hemisphere find of the radiosity
  const Field& irradiance_;
  const Field& from_no_patch_;
  RaysOfQuarters rays_;
};

// The same directions from the same places of all quarters, those of the first one first.
std::vector<Ray> Gather::hemisphere_rays(PatchIndex patch) const {
  const PatchCorners corners = mesh_.corner_points(patch);
  const Eigen::Matrix3d frame = patch_frame(mesh_, patch);
  const auto samples = scrambled_sobol(static_cast<std::uint32_t>(rays_.rays), seed_of(patch, Purpose::hemisphere));
  std::vector<Ray> rays;
  rays.reserve(4 * samples.size());
  for (std::size_t q = 0; q < 4; ++q) {
    const QuadPoints points(quarter_of(corners, static_cast<int>(q)).points);
    for (const auto& sample : samples)
      rays.push_back({points.at(sample[0], sample[1]),
                      frame * occluder_.held_direction(mesh_.polygon[patch], sample[2], sample[3]),
                      mesh_.polygon[patch]});
  }
  return rays;
}

// Clear polygons let the same rays of all quarters through.
std::vector<Seen> Gather::seen_along(PatchIndex patch, const std::vector<Ray>& rays) const {
  const std::uint32_t of_patch = seed_of(patch, Purpose::clear);
  if (occluder_.specular_faces().empty()) return sights_.of_rays(patch, rays, of_patch);
  std::vector<Seen> seen;
  for (auto first = rays.begin(); first != rays.end(); first += rays_.rays) {
    const std::vector<Seen> of_quarter = sights_.of_rays(patch, {first, first + rays_.rays}, of_patch);
    seen.insert(seen.end(), of_quarter.begin(), of_quarter.end());
  }
  return seen;
}

// E h F V / p for a lamp that is chosen with probability p, F exact, h what it holds back of light: a row for each ray,
// by its origin, those of the first quarter first. All quarters look to the same points of the same lamps.
Field Gather::straight_from_lamps(PatchIndex patch, const std::vector<Ray>& rays) const {
  Field irradiance = Field::Zero(4 * Eigen::Index{rays_.rays}, exitance_.cols());
  if (lamps_.empty()) return irradiance;
  const ChoiceOfLamps for_patch = takes_by_flux_ ? ChoiceOfLamps{} : choice_of_lamps(mesh_, patch, lamps_, exitance_);
  const ChoiceOfLamps& choice = takes_by_flux_ ? by_flux_ : for_patch;
  const auto samples = scrambled_sobol(static_cast<std::uint32_t>(rays_.rays), seed_of(patch, Purpose::lamps));
  std::vector<Segment> segments;
  segments.reserve(rays.size());
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const auto& sample = samples[k % samples.size()];
    const auto [lamp, probability, u] = choice.at(sample[0]);
    const PatchCorners corners = mesh_.corner_points(lamp);
    const double held = occluder_.held_share(mesh_.polygon[lamp], mesh_.side[lamp]);
    const double factor = point_to_polygon(rays[k].origin, mesh_.normal[patch], corners);
    irradiance.row(static_cast<Eigen::Index>(k)) = factor * held / probability * exitance_.row(lamp);
    const Point to = square_to_quad(corners.points, u, sample[1]);
    segments.push_back({rays[k].origin, to, mesh_.polygon[patch], mesh_.polygon[lamp]});
  }
  const std::vector<float> arriving = occluder_.transmittance(segments);
  return irradiance.colwise() * Eigen::Map<const Eigen::ArrayXf>(arriving.data(), irradiance.rows()).cast<double>();
}

// Does a dark patch meet a bright one close by?
bool Gather::may_be_darker_there(PatchIndex patch, PatchIndex met, const Hit& hit) const {
  constexpr double brighter = 2;
  return hit.reflections == 0 && brighter * irradiance_.row(patch).sum() < irradiance_.row(met).sum() &&
         hit.distance * hit.distance < longest_edge_squared(mesh_.corner_points(met));
}

// No ray to a lamp goes over mirrors: what lamps send over these is found with the rest.
bool Gather::finds_lamps(const Hit& hit) const { return !lamps_.empty() && hit.reflections > 0; }

// Shadow rays go to points of lamps with the density q_j / A_j, q_j the probability of lamp j, and rays over the
// hemisphere meet these with the density G: the share of the former by the balance heuristic (Veach and Guibas 1995).
double Gather::part_by_shadow_rays(const ChoiceOfLamps& choice, PatchIndex lamp, double geometry) const {
  const double density = choice.probability_of(lamp) / mesh_.area[lamp];
  return density / (density + geometry);
}

// E h G V / p summed over the bands, times its part, for a point of a lamp that is chosen with the density p.
double Gather::from_a_lamp(const ChoiceOfLamps& choice, PatchIndex patch, const Point& point,
                           const std::array<double, 4>& sample) const {
  const auto [lamp, probability, u] = choice.at(sample[2]);
  const Point to = square_to_quad(mesh_.corner_points(lamp).points, u, sample[3]);
  const double geometry = geometry_term(point, mesh_.normal[patch], to, mesh_.normal[lamp]);
  if (!(geometry > 0)) return 0;
  const Segment segment{point, to, mesh_.polygon[patch], mesh_.polygon[lamp]};
  const double held = occluder_.held_share(mesh_.polygon[lamp], mesh_.side[lamp]);
  return exitance_.row(lamp).sum() * held * geometry * mesh_.area[lamp] / probability *
         part_by_shadow_rays(choice, lamp, geometry) *
         static_cast<double>(occluder_.transmittance({&segment, 1}).front());
}

// What a ray over the hemisphere brings to a point of a patch, summed over the bands.
double Gather::from_hemisphere(const ChoiceOfLamps& choice, PatchIndex patch, const Point& point,
                               const Seen& seen) const {
  if (seen.sight != Sight::patch) return 0;
  const SidePoint at{seen.hit->polygon, seen.hit->side, seen.hit->point};
  const PatchIndex sender = lookup_.patches_at({&at, 1}).front();
  if (sender == no_patch) return 0;
  const double sent = sent_.row(sender).sum();
  const double emitted = lamps_.empty() ? 0 : exitance_.row(sender).sum();
  if (!(emitted > 0)) return sent;
  // No shadow ray goes over mirrors.
  if (seen.hit->reflections > 0) return sent + emitted;
  const double geometry = geometry_term(point, mesh_.normal[patch], at.point, mesh_.normal[sender]);
  return sent + emitted * (1 - part_by_shadow_rays(choice, sender, geometry));
}

// By what share more light arrives at a point of a patch than in the mean over it. That from no patch is taken to be
// even.
double Gather::more_at(PatchIndex patch, const Point& point, std::uint32_t key) const {
  constexpr std::uint32_t rays_from_point = 2;
  constexpr std::size_t few_lamps = 16;  // of which each is told apart for each point
  const double whole = irradiance_.row(patch).sum();
  const bool takes_by_flux = lamps_.empty() || lamps_.size() > few_lamps;
  const ChoiceOfLamps for_patch = takes_by_flux ? ChoiceOfLamps{} : choice_of_lamps(mesh_, patch, lamps_, exitance_);
  const ChoiceOfLamps& choice = takes_by_flux ? by_flux_ : for_patch;
  const Eigen::Matrix3d frame = patch_frame(mesh_, patch);
  double there = 0;
  std::vector<Ray> rays;
  for (const auto& sample : scrambled_sobol(rays_from_point, key)) {
    if (!lamps_.empty()) there += from_a_lamp(choice, patch, point, sample) / rays_from_point;
    rays.push_back(
        {point, frame * occluder_.held_direction(mesh_.polygon[patch], sample[0], sample[1]), mesh_.polygon[patch]});
  }
  for (const Seen& seen : sights_.of_rays(patch, rays, key))
    there += from_hemisphere(choice, patch, point, seen) / rays_from_point;
  const double from_no_patch = from_no_patch_.size() > 0 ? from_no_patch_.row(patch).sum() : 0;
  return (there + from_no_patch) / whole - 1;
}

// What the rays of all quarters find, those of the first one first.
void Gather::add_hemisphere(PatchIndex patch, std::span<const Seen> seen, GatheredQuarters& into) const {
  const auto rays = static_cast<std::size_t>(rays_.rays);
  const std::size_t first = 4 * std::size_t{patch};
  std::vector<SidePoint> points;
  std::vector<std::size_t> rays_that_meet;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (seen[k].sight != Sight::patch) continue;
    points.push_back({seen[k].hit->polygon, seen[k].hit->side, seen[k].hit->point});
    rays_that_meet.push_back(k);
  }
  const std::vector<PatchIndex> met = lookup_.patches_at(points);
  const bool is_open = 2 * count_far(mesh_.corner_points(patch), seen) >= static_cast<int>(seen.size());
  for (std::size_t m = 0; m < met.size(); ++m) {
    if (met[m] == no_patch) continue;
    const std::size_t k = rays_that_meet[m];
    const Hit& hit = *seen[k].hit;
    const auto quarter = static_cast<Eigen::Index>(first + k / rays);
    const PatchCorners corners = mesh_.corner_points(met[m]);
    const int of_met = quarter_at(corners, mesh_.normal[met[m]], hit.point);
    into.met[first * rays + k] = 4 * met[m] + static_cast<PatchIndex>(of_met);
    into.seen_as[first * rays + k] = is_open && is_far_from(corners, hit.distance) ? seen_as_whole : seen_as_quarter;
    if (may_be_darker_there(patch, met[m], hit))
      into.seen_as[first * rays + k] = as_point(
          more_at(met[m], hit.point, hash({seed_of(patch, Purpose::at_points), static_cast<std::uint64_t>(k)})));
    into.irradiance.row(quarter) += sent_.row(met[m]);
    if (finds_lamps(hit)) into.irradiance.row(quarter) += exitance_.row(met[m]);
  }
}

// The mean is that over what is exposed: of a patch that solids cover in part, rays that meet backs start inside one.
void Gather::at(PatchIndex patch, GatheredQuarters& into) const {
  const std::vector<Ray> rays = hemisphere_rays(patch);
  const Field direct = straight_from_lamps(patch, rays);
  const std::vector<Seen> all_seen = seen_along(patch, rays);
  add_hemisphere(patch, all_seen, into);
  const auto count_of_one = static_cast<std::size_t>(rays_.rays);
  for (std::size_t k = 0; k < 4; ++k) {
    const auto q = static_cast<Eigen::Index>(4 * std::size_t{patch} + k);
    const std::span<const Seen> seen = std::span(all_seen).subspan(k * count_of_one, count_of_one);
    int exposed = 0;
    for (std::size_t ray = 0; ray < seen.size(); ++ray) {
      if (covered_[patch] > 0 && unseen({&seen[ray], 1}) > 0) continue;
      ++exposed;
      into.irradiance.row(q) += direct.row(static_cast<Eigen::Index>(k * seen.size() + ray));
    }
    into.irradiance.row(q) /= std::max(1, exposed);
    const double area = area_vector(quarter_of(mesh_.corner_points(patch), static_cast<int>(k))).norm();
    into.part_of_ray[q] = area / rays_.rays;
    into.exposed[q] = area * exposed / rays_.rays;
    into.seen[q] = static_cast<double>(count(seen, Sight::patch)) / std::max(1, exposed);
    into.open[q] = static_cast<double>(count_far(mesh_.corner_points(patch), seen)) / std::max(1, exposed);
  }
  const double exposed = into.exposed.segment<4>(4 * Eigen::Index{patch}).sum();
  into.part_of_ray.segment<4>(4 * Eigen::Index{patch}) *= exposed > 0 ? 1 / exposed : 0;
}

// 2 + 50 (1 + 4) fits into a byte.
constexpr int first_code = 2;
constexpr double steps_of_share = 50;

}  // namespace

std::uint8_t as_point(double more) {
  constexpr double most = 4;
  return static_cast<std::uint8_t>(first_code + std::lround(steps_of_share * (1 + std::clamp(more, -1.0, most))));
}

std::optional<double> more_at_point(std::uint8_t seen_as) {
  if (seen_as < first_code) return std::nullopt;
  return (seen_as - first_code) / steps_of_share - 1;
}

GatheredQuarters gather_at_quarters(const SolvedPatches& patches, const RaysOfQuarters& rays,
                                    const Observer& observer) {
  const Gather gather(patches, rays);
  const std::size_t quarters = 4 * std::size_t{patches.mesh.size()};
  const auto size = static_cast<Eigen::Index>(quarters);
  const std::size_t count = quarters * static_cast<std::size_t>(rays.rays);
  GatheredQuarters found{.rays = rays.rays,
                         .irradiance = Field::Zero(size, patches.solved.problem.exitance.cols()),
                         .met = std::vector<PatchIndex>(count, no_patch),
                         .seen_as = std::vector<std::uint8_t>(count, seen_as_quarter),
                         .part_of_ray = Eigen::ArrayXd::Zero(size),
                         .exposed = Eigen::ArrayXd::Zero(size),
                         .seen = Eigen::ArrayXd::Zero(size),
                         .open = Eigen::ArrayXd::Zero(size)};
  parallel_for(patches.mesh.size(), Stage::error_bars, observer,
               [&](std::size_t patch) { gather.at(static_cast<PatchIndex>(patch), found); });
  return found;
}

}  // namespace patchlight
