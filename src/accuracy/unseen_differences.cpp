#include "accuracy/unseen_differences.h"

#include "accuracy/refinement.h"
#include "base/parallel.h"
#include "base/sampling.h"
#include "base/streams.h"
#include "form_factor/pair_samples.h"
#include "form_factor/patch_shape.h"
#include "form_factor/point_polygon.h"
#include "mesh/interpolate.h"
#include "mesh/nested_mesh.h"
#include "mesh/patch_lookup.h"
#include "transport/sights.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

namespace patchlight {

EmitterChoice::Chosen EmitterChoice::at(double u) const {
  const double place = u * before.back();
  const auto next = std::upper_bound(before.begin(), before.end() - 1, place);
  const auto k = static_cast<std::size_t>(next - before.begin()) - 1;
  const double of_emitter = before[k + 1] - before[k];
  return {emitters[k], of_emitter / before.back(), std::clamp((place - before[k]) / of_emitter, 0.0, 1.0)};
}

double EmitterChoice::probability_of(PatchIndex patch) const {
  const auto place = std::lower_bound(emitters.begin(), emitters.end(), patch);
  if (place == emitters.end() || *place != patch) return 0;
  const auto k = static_cast<std::size_t>(place - emitters.begin());
  return (before[k + 1] - before[k]) / before.back();
}

EmitterChoice emitter_choice_for(const PatchMesh& mesh, PatchIndex patch, const std::vector<PatchIndex>& emitters,
                                 const Field& exitance) {
  constexpr double least_cosine = 0.05;  // of an emitter whose centroid is below the horizon some may be above it
  EmitterChoice choice{emitters, {0}};
  for (const PatchIndex emitter : emitters) {
    const Vector toward = mesh.centroid[emitter] - mesh.centroid[patch];
    const double squared = toward.squaredNorm() + mesh.area[emitter];
    const double distance = std::sqrt(squared);
    const double cosines = std::max(least_cosine, mesh.normal[patch].dot(toward) / distance) *
                           std::max(least_cosine, -mesh.normal[emitter].dot(toward) / distance);
    choice.before.push_back(choice.before.back() +
                            exitance.row(emitter).mean() * mesh.area[emitter] * cosines / squared);
  }
  return choice;
}

EmitterChoice choice_by_flux(const PatchMesh& mesh, const std::vector<PatchIndex>& emitters, const Field& exitance) {
  EmitterChoice choice{emitters, {0}};
  for (const PatchIndex emitter : emitters)
    choice.before.push_back(choice.before.back() + exitance.row(emitter).mean() * mesh.area[emitter]);
  return choice;
}

namespace {

// If lamps are a larger share of the patches, they are treated as other light, because rays find them as well.
constexpr double most_emitters = 0.125;

// True when a patch is so far away, `distance` in meters, that its quarters look alike, unless something hides some of
// them.
bool is_far_from(const PatchCorners& corners, double distance) {
  return distance * distance > 8 * 8 * longest_edge_squared(corners);
}

// The number of rays that have hit a patch far from their start.
int count_far(const PatchCorners& from, std::span<const Seen> seen) {
  return static_cast<int>(std::count_if(seen.begin(), seen.end(), [&](const Seen& one) {
    return one.sight == Sight::patch && is_far_from(from, one.met->distance);
  }));
}

class Gather {
 public:
  // Emitters that are many patches are left to the rays over the hemisphere.
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
      if ((exitance_.row(i) > 0).any()) emitters_.push_back(i);
    const auto emitters = static_cast<double>(emitters_.size());
    if (emitters > most_emitters * mesh_.size()) emitters_.clear();
    if (!emitters_.empty()) sent_ -= exitance_;
    // More evaluations of emitters at patches are not worth their time.
    takes_by_flux_ = emitters * mesh_.size() > 2e7;
    by_flux_ = choice_by_flux(mesh_, emitters_, exitance_);
  }

  void at(PatchIndex patch, GatheredQuarters& into) const;

 private:
  std::uint32_t seed_of(PatchIndex patch, stream::Stream purpose) const {
    return hash({rays_.seed, keys_[patch], purpose});
  }
  std::vector<Ray> hemisphere_rays(PatchIndex patch) const;
  std::vector<Seen> seen_along(PatchIndex patch, const std::vector<Ray>& rays) const;
  Field straight_from_emitters(PatchIndex patch, const std::vector<Ray>& rays) const;
  void add_hemisphere(PatchIndex patch, std::span<const Seen> seen, GatheredQuarters& into) const;
  bool may_be_darker_there(PatchIndex patch, PatchIndex met, const Hit& hit) const;
  bool finds_emitters(const Hit& hit) const;
  double part_by_shadow_rays(const EmitterChoice& choice, PatchIndex emitter, double geometry) const;
  double from_an_emitter(const EmitterChoice& choice, PatchIndex patch, const Point& point,
                         const std::array<double, 4>& sample) const;
  double from_hemisphere(const EmitterChoice& choice, PatchIndex patch, const Point& point, const Seen& seen) const;
  double more_at(PatchIndex patch, const Point& point, std::uint32_t key) const;

  const PatchMesh& mesh_;
  const Occluder& occluder_;
  Sights sights_;
  PatchLookup lookup_;
  std::vector<std::uint32_t> keys_;
  std::vector<PatchIndex> emitters_;
  EmitterChoice by_flux_;
  bool takes_by_flux_ = false;  // everywhere
  const Eigen::VectorXd& covered_;
  const Field& exitance_;
  Field sent_;  // the radiosity that rays over the hemisphere find
  const Field& irradiance_;
  const Field& from_no_patch_;
  RaysOfQuarters rays_;
};

// The same directions from the same places of all quarters, those of the first one first.
std::vector<Ray> Gather::hemisphere_rays(PatchIndex patch) const {
  const PatchCorners corners = mesh_.corner_points(patch);
  const Eigen::Matrix3d frame = patch_frame(mesh_, patch);
  const auto samples = scrambled_sobol(static_cast<std::uint32_t>(rays_.rays), seed_of(patch, stream::hemisphere));
  std::vector<Ray> rays;
  rays.reserve(4 * samples.size());
  for (std::size_t q = 0; q < 4; ++q) {
    const QuadPoints points(quarter_of(corners, static_cast<int>(q)).points);
    for (const auto& sample : samples)
      rays.push_back(
          {points.at(sample[0], sample[1]),
           frame * occluder_.optics().sample_nonspecular_direction(mesh_.polygon[patch], sample[2], sample[3]),
           mesh_.polygon[patch]});
  }
  return rays;
}

// Clear polygons let the same rays of all quarters through.
std::vector<Seen> Gather::seen_along(PatchIndex patch, const std::vector<Ray>& rays) const {
  const std::uint32_t of_patch = seed_of(patch, stream::clear_at_quarters);
  if (occluder_.optics().empty()) return sights_.of_rays(patch, rays, of_patch);
  std::vector<Seen> seen;
  for (auto first = rays.begin(); first != rays.end(); first += rays_.rays) {
    const std::vector<Seen> of_quarter = sights_.of_rays(patch, {first, first + rays_.rays}, of_patch);
    seen.insert(seen.end(), of_quarter.begin(), of_quarter.end());
  }
  return seen;
}

// E h F V / p for an emitter that is chosen with probability p: F is exact, and h is the share of the light that the
// emitter holds back. One row for each ray, by its origin, those of the first quarter first. All quarters sample the
// same points of the same emitters.
Field Gather::straight_from_emitters(PatchIndex patch, const std::vector<Ray>& rays) const {
  Field irradiance = Field::Zero(4 * Eigen::Index{rays_.rays}, exitance_.cols());
  if (emitters_.empty()) return irradiance;
  const EmitterChoice for_patch =
      takes_by_flux_ ? EmitterChoice{} : emitter_choice_for(mesh_, patch, emitters_, exitance_);
  const EmitterChoice& choice = takes_by_flux_ ? by_flux_ : for_patch;
  const auto samples =
      scrambled_sobol(static_cast<std::uint32_t>(rays_.rays), seed_of(patch, stream::emitters_at_quarters));
  std::vector<Segment> segments;
  segments.reserve(rays.size());
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const auto& sample = samples[k % samples.size()];
    const auto [emitter, probability, u] = choice.at(sample[0]);
    const PatchCorners corners = mesh_.corner_points(emitter);
    const double nonspecular = occluder_.optics().nonspecular_fraction(mesh_.polygon[emitter], mesh_.side[emitter]);
    const double factor = point_to_polygon(rays[k].origin, mesh_.normal[patch], corners);
    irradiance.row(static_cast<Eigen::Index>(k)) = factor * nonspecular / probability * exitance_.row(emitter);
    const Point to = square_to_quad(corners.points, u, sample[1]);
    segments.push_back({rays[k].origin, to, mesh_.polygon[patch], mesh_.polygon[emitter]});
  }
  const std::vector<float> arriving = occluder_.transmittance(segments);
  return irradiance.colwise() * Eigen::Map<const Eigen::ArrayXf>(arriving.data(), irradiance.rows()).cast<double>();
}

// Whether a dark patch sees a bright one close by.
bool Gather::may_be_darker_there(PatchIndex patch, PatchIndex met, const Hit& hit) const {
  return hit.reflections == 0 && 2 * irradiance_.row(patch).sum() < irradiance_.row(met).sum() &&
         hit.distance * hit.distance < longest_edge_squared(mesh_.corner_points(met));
}

// No ray to an emitter goes over mirrors: light of emitters over these is found with the rest.
bool Gather::finds_emitters(const Hit& hit) const { return !emitters_.empty() && hit.reflections > 0; }

// Shadow rays go to points of emitters with the density q_j / A_j, q_j the probability of emitter j, and rays over the
// hemisphere meet these with the density G: the share of the former by the balance heuristic (Veach and Guibas 1995).
double Gather::part_by_shadow_rays(const EmitterChoice& choice, PatchIndex emitter, double geometry) const {
  const double density = choice.probability_of(emitter) / mesh_.area[emitter];
  return density / (density + geometry);
}

// E h G V / p summed over the bands, times its part, for a point of an emitter that is chosen with the density p.
double Gather::from_an_emitter(const EmitterChoice& choice, PatchIndex patch, const Point& point,
                               const std::array<double, 4>& sample) const {
  const auto [emitter, probability, u] = choice.at(sample[2]);
  const Point to = square_to_quad(mesh_.corner_points(emitter).points, u, sample[3]);
  const double geometry = geometry_term(point, mesh_.normal[patch], to, mesh_.normal[emitter]);
  if (!(geometry > 0)) return 0;
  const Segment segment{point, to, mesh_.polygon[patch], mesh_.polygon[emitter]};
  const double nonspecular = occluder_.optics().nonspecular_fraction(mesh_.polygon[emitter], mesh_.side[emitter]);
  return exitance_.row(emitter).sum() * nonspecular * geometry * mesh_.area[emitter] / probability *
         part_by_shadow_rays(choice, emitter, geometry) *
         static_cast<double>(occluder_.transmittance({&segment, 1}).front());
}

// The light of a ray over the hemisphere at a point of a patch, summed over the bands.
double Gather::from_hemisphere(const EmitterChoice& choice, PatchIndex patch, const Point& point,
                               const Seen& seen) const {
  if (seen.sight != Sight::patch) return 0;
  const SidePoint at{seen.met->polygon, seen.met->side, seen.met->point};
  const PatchIndex sender = lookup_.patches_at({&at, 1}).front();
  if (sender == no_patch) return 0;
  const double sent = sent_.row(sender).sum();
  const double emitted = emitters_.empty() ? 0 : exitance_.row(sender).sum();
  if (!(emitted > 0)) return sent;
  // No shadow ray goes over mirrors.
  if (seen.met->reflections > 0) return sent + emitted;
  const double geometry = geometry_term(point, mesh_.normal[patch], at.point, mesh_.normal[sender]);
  return sent + emitted * (1 - part_by_shadow_rays(choice, sender, geometry));
}

// The relative excess of light at a point of a patch over the mean of the patch. Light from no patch counts as uniform.
double Gather::more_at(PatchIndex patch, const Point& point, std::uint32_t key) const {
  constexpr std::uint32_t rays_from_point = 2;
  const double whole = irradiance_.row(patch).sum();
  // With few emitters, each is weighed for each point.
  const bool takes_by_flux = emitters_.empty() || emitters_.size() > 16;
  const EmitterChoice for_patch =
      takes_by_flux ? EmitterChoice{} : emitter_choice_for(mesh_, patch, emitters_, exitance_);
  const EmitterChoice& choice = takes_by_flux ? by_flux_ : for_patch;
  const Eigen::Matrix3d frame = patch_frame(mesh_, patch);
  double there = 0;
  std::vector<Ray> rays;
  for (const auto& sample : scrambled_sobol(rays_from_point, key)) {
    if (!emitters_.empty()) there += from_an_emitter(choice, patch, point, sample) / rays_from_point;
    rays.push_back({point,
                    frame * occluder_.optics().sample_nonspecular_direction(mesh_.polygon[patch], sample[0], sample[1]),
                    mesh_.polygon[patch]});
  }
  for (const Seen& seen : sights_.of_rays(patch, rays, key))
    there += from_hemisphere(choice, patch, point, seen) / rays_from_point;
  const double from_no_patch = from_no_patch_.size() > 0 ? from_no_patch_.row(patch).sum() : 0;
  return (there + from_no_patch) / whole - 1;
}

// Adds the light of the rays of all quarters, those of the first one first.
void Gather::add_hemisphere(PatchIndex patch, std::span<const Seen> seen, GatheredQuarters& into) const {
  const auto rays = static_cast<std::size_t>(rays_.rays);
  const std::size_t first = 4 * std::size_t{patch};
  std::vector<SidePoint> points;
  std::vector<std::size_t> rays_that_meet;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (seen[k].sight != Sight::patch) continue;
    points.push_back({seen[k].met->polygon, seen[k].met->side, seen[k].met->point});
    rays_that_meet.push_back(k);
  }
  const std::vector<PatchIndex> met = lookup_.patches_at(points);
  const bool is_open = 2 * count_far(mesh_.corner_points(patch), seen) >= static_cast<int>(seen.size());
  for (std::size_t m = 0; m < met.size(); ++m) {
    if (met[m] == no_patch) continue;
    const std::size_t k = rays_that_meet[m];
    const Hit& hit = *seen[k].met;
    const auto quarter = static_cast<Eigen::Index>(first + k / rays);
    const PatchCorners corners = mesh_.corner_points(met[m]);
    const int of_met = quarter_at(corners, mesh_.normal[met[m]], hit.point);
    into.met[first * rays + k] = 4 * met[m] + static_cast<PatchIndex>(of_met);
    into.seen_as[first * rays + k] = is_open && is_far_from(corners, hit.distance) ? seen_as_whole : seen_as_quarter;
    if (may_be_darker_there(patch, met[m], hit))
      into.seen_as[first * rays + k] = as_point(more_at(
          met[m], hit.point, hash({seed_of(patch, stream::points_at_quarters), static_cast<std::uint64_t>(k)})));
    into.irradiance.row(quarter) += sent_.row(met[m]);
    if (finds_emitters(hit)) into.irradiance.row(quarter) += exitance_.row(met[m]);
  }
}

// The mean is over the exposed part: on a patch partly covered by solids, rays that hit backs start inside one.
void Gather::at(PatchIndex patch, GatheredQuarters& into) const {
  const std::vector<Ray> rays = hemisphere_rays(patch);
  const Field direct = straight_from_emitters(patch, rays);
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
  return static_cast<std::uint8_t>(first_code + std::lround(steps_of_share * (1 + std::clamp(more, -1.0, 4.0))));
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

namespace {

// Each patch as seen from afar.
struct SeenFromAfar {
  Field difference;                    // of its radiosity from the patch's mean, W/m^2
  std::vector<std::uint8_t> is_known;  // 0: no ray has met it
};

// The differences of radiosity inside patches, as one set of rays finds them.
struct Differences {
  GatheredQuarters rays;  // without their irradiance
  Field of_irradiance;    // of each quarter from the mean of its patch, W/m^2, as long as it is needed
  Field of_quarters;      // of radiosity, the same
  SeenFromAfar from_afar;
  Field at_patches;  // the change of the irradiance of each patch by them, W/m^2
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

// H_q - H, where H is the mean over the exposed parts of the quarters.
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

// Root mean squares over the quarters of each patch, from both sets of rays. For a linear field the quarters have three
// quarters of the variance of its points.
Field display_of(const Differences& one, const Differences& other) {
  const Field product = one.of_irradiance * other.of_irradiance;
  Field mean = Field::Zero(product.rows() / 4, product.cols());
  for (Eigen::Index q = 0; q < product.rows(); ++q) mean.row(q / 4) += product.row(q) / 3;
  return mean;
}

// Makes the arriving flux equal the flux that the differences send: sum_q A_q dB_q over the visible share, which is
// nearly 0 if nothing is lost. Otherwise all reflections would multiply the noise in it. The visible share comes from
// the other set of rays, because within one set it is correlated with the light. Where points replace quarters, only
// the arriving side omits them, a small error.
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

// From far away the quarters of a patch look alike and their differences cancel, unless something near hides some of
// them. By reciprocity each quarter counts by its view of far surfaces. The other rays measure that view, since in
// these rays it is correlated with the light.
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

// The product of the differences of each patch with the changes that other rays find: sum_i w_i c_i dH_i.
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
    return gather_at_quarters(patches, {look.rays, hash({look.seed, half, stream::halves_of_quarters})}, observer);
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

  // 2. Through all reflections; differences inside the quarters are extrapolated.
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
