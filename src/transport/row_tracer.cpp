#include "transport/row_tracer.h"

#include "base/sampling.h"
#include "base/streams.h"
#include "form_factor/patch_shape.h"
#include "optics/surface_optics.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace patchlight {
namespace {

// Rays of a patch in each of two halves: between these, and a power of two.
constexpr std::uint32_t fewest_rays = 8;

// The power of two next to factor A_i^0.4.
std::uint32_t rounded(double rays) {
  const double power = std::round(std::log2(std::clamp<double>(rays, fewest_rays, most_rays)));
  return 1U << static_cast<unsigned>(power);
}

}  // namespace

std::vector<std::uint32_t> ray_counts(std::span<const double> areas, int mean) {
  // The error of patch i's irradiance falls with its rays, and counts by its area: more rays pay for large patches. The
  // exponent is measured: docs/theory/ray-method.md.
  std::vector<double> size;
  size.reserve(areas.size());
  for (const double area : areas) size.push_back(std::pow(area, 0.4));
  const auto sum = [&](double factor) {
    double all = 0;
    for (const double s : size) all += rounded(factor * s);
    return all;
  };
  // The largest factor that does not exceed the requested number of rays, by bisection of its logarithm; sizes are
  // positive.
  const double wanted = 0.5 * mean * static_cast<double>(areas.size());
  const auto [least, most] = std::minmax_element(size.begin(), size.end());
  double low = std::log(fewest_rays / (2 * *most));
  double high = std::log(2 * most_rays / *least);
  for (int step = 0; step < 40; ++step) {
    const double middle = 0.5 * (low + high);
    (sum(std::exp(middle)) > wanted ? high : low) = middle;
  }
  std::vector<std::uint32_t> counts;
  counts.reserve(areas.size());
  for (const double s : size) counts.push_back(rounded(std::exp(low) * s));
  return counts;
}

namespace {

// The variance of radiosity over the area, of those values that are not above a limit; the others are 0.
double variance_up_to(const Eigen::VectorXd& radiosity, const Eigen::Map<const Eigen::VectorXd>& area, double limit) {
  const Eigen::ArrayXd kept = (radiosity.array() > limit).select(0, radiosity.array());
  const double mean = (area.array() * kept).sum() / area.sum();
  return (area.array() * (kept - mean).square()).sum() / area.sum();
}

// The share of the area that is brighter.
double share_above(const Eigen::VectorXd& radiosity, const Eigen::Map<const Eigen::VectorXd>& area, double limit) {
  return (radiosity.array() > limit).select(area.array(), 0).sum() / area.sum();
}

}  // namespace

BrightPatches::BrightPatches(const PatchMesh& mesh, const Eigen::VectorXd& expected, double threshold,
                             const Occluder& occluder)
    : density_(mesh.size(), 0) {
  // 1. Those above the threshold, if rays towards them are worth it.
  const Eigen::Map<const Eigen::VectorXd> area(mesh.area.data(), static_cast<Eigen::Index>(mesh.size()));
  const double least = threshold * expected.dot(area) / area.sum();
  const double all = variance_up_to(expected, area, std::numeric_limits<double>::infinity());
  // Rays of 32 neighbors, 64 each, must hit bright patches about 16 times, so that the halves show their scatter.
  const bool meets_by_chance = share_above(expected, area, least) >= 1.0 / 128;
  // Rays toward bright patches, half as many as hemisphere rays, cost three quarters of these. The same time spent on
  // hemisphere rays would divide the variance by 1.75.
  if (meets_by_chance && all < 1.75 * variance_up_to(expected, area, least)) return;
  double flux = 0;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (!(expected[i] > least)) continue;
    flux += area[i] * expected[i];
    patches_.push_back(i);
    upto_.push_back(flux);
  }

  // 2. Their probabilities.
  for (std::size_t k = 0; k < patches_.size(); ++k) {
    const PatchIndex i = patches_[k];
    upto_[k] /= flux;
    density_[i] = static_cast<float>(expected[i] / flux);
    sampled_.push_back(sampled_patch(patch_shape(mesh, i), mesh.polygon[i], occluder.frame()));
  }
  if (!patches_.empty()) upto_.back() = 1;

  // 3. Where to begin to look: as many parts as patches.
  for (std::size_t part = 0; part < patches_.size(); ++part) {
    const double begin = static_cast<double>(part) / static_cast<double>(patches_.size());
    guide_.push_back(static_cast<std::uint32_t>(std::upper_bound(upto_.begin(), upto_.end(), begin) - upto_.begin()));
  }
}

BrightPatches::Chosen BrightPatches::at(double u) const {
  std::size_t k = guide_[static_cast<std::size_t>(u * static_cast<double>(patches_.size()))];
  while (k + 1 < upto_.size() && upto_[k] <= u) ++k;
  const double before = k == 0 ? 0 : upto_[k - 1];
  const auto stretched = static_cast<float>(std::clamp((u - before) / (upto_[k] - before), 0.0, 1 - 0x1p-24));
  return {patches_[k], &sampled_[k], stretched};
}

namespace {

// Coordinate d of sample k, in (0, 1).
double coordinate(const SampleSet& set, std::size_t d, std::size_t k) {
  return (static_cast<double>(set.net[d * set.stride + k] ^ set.shift[d]) + 0.5) * 0x1p-32;
}

float dot(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

struct SamplePlace {
  std::array<float, 3> point;
  float density;
};

// The place of a patch with these coordinates, and the weight of its samples there.
SamplePlace place_on(const SampledPatch& patch, float u, float v) {
  if (patch.is_triangle) {
    const float root = std::sqrt(u);
    u = root - root * v;
    v = root - u;
  }
  SamplePlace place{};
  for (std::size_t d = 0; d < 3; ++d)
    place.point[d] = patch.origin[d] + u * patch.along_u[d] + v * (patch.along_v[d] + u * patch.twist[d]);
  place.density = patch.density[0] + u * patch.density[1] + v * patch.density[2];
  return place;
}

std::vector<std::uint32_t> doubled(std::vector<std::uint32_t> counts, std::span<const std::uint8_t> doublings) {
  for (std::size_t i = 0; i < doublings.size(); ++i) counts[i] = std::min(counts[i] << doublings[i], most_rays);
  return counts;
}

}  // namespace

// The shadow rays of one patch towards bright ones, in one half.
struct RowTracer::TowardBright {
  SampledPatch from;
  SampleSet set;
  float hemisphere = 0;  // n: rays over the hemisphere
  float factor = 0;      // of a geometry term in the occluder's frame, to have it in 1/m^2
};

RowTracer::RowTracer(const PatchMesh& mesh, const Occluder& occluder, const BrightPatches& bright,
                     const RayOptions& options)
    : mesh_(mesh),
      occluder_(occluder),
      bright_(bright),
      seed_(options.seed),
      toward_bright_(static_cast<std::uint32_t>(options.toward_bright) / 2),
      sights_(mesh, occluder),
      lookup_(mesh),
      keys_(patch_keys(mesh)),
      counts_(doubled(ray_counts(options.areas.empty() ? mesh.area : options.areas, options.rays), options.doublings)),
      table_(std::max(*std::max_element(counts_.begin(), counts_.end()), toward_bright_), options.seed) {
  assert(toward_bright_ % ShadowPacket::size == 0);
}

SampleSet RowTracer::samples(PatchIndex patch, std::uint32_t purpose, std::uint32_t half) const {
  return table_.of_pair(keys_[patch], purpose, half);
}

// Those of the first half, then those of the second.
std::vector<Ray> RowTracer::hemisphere_rays(PatchIndex patch) const {
  const QuadPoints points(mesh_.corner_points(patch).points);
  const Eigen::Matrix3d frame = patch_frame(mesh_, patch);
  std::vector<Ray> rays;
  rays.reserve(2 * std::size_t{counts_[patch]});
  for (const std::uint32_t half : {0U, 1U}) {
    const SampleSet set = samples(patch, stream::hemisphere, half);
    for (std::size_t k = 0; k < counts_[patch]; ++k) {
      const Vector direction = square_to_cosine_hemisphere(coordinate(set, 0, k), coordinate(set, 1, k));
      rays.push_back(
          {points.at(coordinate(set, 2, k), coordinate(set, 3, k)), frame * direction, mesh_.polygon[patch]});
    }
  }
  return rays;
}

// The contribution of a hemisphere ray that hits a bright patch, by the balance heuristic: G / (n G + m p). Shadow rays
// do not follow mirrors: there it is 1 / n.
float RowTracer::entry_of(PatchIndex patch, const Ray& ray, const Hit& hit, PatchIndex met) const {
  if (hit.reflections > 0) return 1 / static_cast<float>(counts_[patch]);
  const double cosines = mesh_.normal[patch].dot(ray.direction) * std::abs(mesh_.normal[met].dot(ray.direction));
  const double density = toward_bright_ * static_cast<double>(bright_.density(met));
  const double squared = std::numbers::pi * hit.distance * hit.distance;
  return static_cast<float>(cosines / (counts_[patch] * cosines + density * squared));
}

// Fills one lane with a shadow ray to a point of a bright patch; its contribution if the ray is free: G / (n G + m p).
RayEntry RowTracer::fill_lane(ShadowPacket& packet, std::size_t lane, const TowardBright& rays, std::size_t k) const {
  const auto at = [&](std::size_t d) { return static_cast<float>(coordinate(rays.set, d, k)); };
  const BrightPatches::Chosen chosen = bright_.at(coordinate(rays.set, 0, k));
  const SampledPatch& to = *chosen.sampled;
  const SamplePlace x = place_on(rays.from, at(2), at(3));
  const SamplePlace y = place_on(to, chosen.u, at(1));
  std::array<float, 3> toward{};
  for (std::size_t d = 0; d < 3; ++d) toward[d] = y.point[d] - x.point[d];
  packet.from_x[lane] = x.point[0], packet.from_y[lane] = x.point[1], packet.from_z[lane] = x.point[2];
  packet.toward_x[lane] = toward[0], packet.toward_y[lane] = toward[1], packet.toward_z[lane] = toward[2];
  packet.from_polygon[lane] = rays.from.polygon, packet.to_polygon[lane] = to.polygon;

  const float cosines = std::max(0.0F, dot(toward, rays.from.normal)) * std::max(0.0F, -dot(toward, to.normal));
  if (!(cosines > 0)) return {};
  const float squared = dot(toward, toward);
  const float geometry = rays.factor * cosines / (squared * squared);
  const float density = static_cast<float>(toward_bright_) * bright_.density(chosen.patch);
  const float weight = x.density * y.density;
  return {chosen.patch, weight * geometry / (rays.hemisphere * geometry + density)};
}

void RowTracer::add_toward_bright(const TowardBright& rays, PatchIndex patch, std::size_t half,
                                  RowEntries& into) const {
  for (std::size_t first = 0; first < toward_bright_; first += ShadowPacket::size) {
    ShadowPacket packet;
    std::array<RayEntry, ShadowPacket::size> entries;
    for (std::size_t lane = 0; lane < ShadowPacket::size; ++lane)
      entries[lane] = fill_lane(packet, lane, rays, first + lane);
    if (std::none_of(entries.begin(), entries.end(), [](const RayEntry& e) { return e.form_factor > 0; })) continue;
    into.shadow_rays += ShadowPacket::size;
    if (is_specular()) {
      add_arriving(packet, patch, entries, half, into);
      continue;
    }
    const auto arriving = occluder_.transmittance(packet);
    for (std::size_t lane = 0; lane < ShadowPacket::size; ++lane) {
      entries[lane].form_factor *= arriving[lane];
      if (entries[lane].form_factor > 0) into.halves[half].push_back(entries[lane]);
    }
  }
}

void RowTracer::add_toward_bright(PatchIndex patch, RowEntries& entries) const {
  const double scale = occluder_.frame().scale;
  TowardBright rays{sampled_patch(patch_shape(mesh_, patch), mesh_.polygon[patch], occluder_.frame()),
                    {},
                    static_cast<float>(counts_[patch]),
                    static_cast<float>(scale * scale / std::numbers::pi)};
  for (const std::uint32_t half : {0U, 1U}) {
    rays.set = samples(patch, stream::toward_bright_patches, half);
    add_toward_bright(rays, patch, half, entries);
  }
}

// Rays over the hemisphere that have met a patch, with nothing specular on their way, those of the first half first.
void RowTracer::add_hits(PatchIndex patch, std::span<const Ray> rays, std::span<const PlainHit> hits, PatchRays& told,
                         RowEntries& entries) const {
  std::vector<SidePoint> points;
  points.reserve(hits.size());
  for (const auto& [ray, hit] : hits) points.push_back({hit->polygon, hit->side, hit->point});
  const std::vector<PatchIndex> met = lookup_.patches_at(points);
  bright_.prefetch_densities(met);
  for (std::size_t k = 0; k < hits.size(); ++k) {
    assert(met[k] != no_patch);
    const std::size_t half = hits[k].ray / counts_[patch];
    if (bright_.density(met[k]) > 0) {
      entries.halves[half].push_back({met[k], entry_of(patch, rays[hits[k].ray], *hits[k].hit, met[k])});
    } else {
      told.hits[half].push_back(met[k]);
    }
  }
}

PatchRays RowTracer::trace_plain(PatchIndex patch, RowEntries& entries) const {
  const std::vector<Ray> rays = hemisphere_rays(patch);
  const std::vector<Seen> seen = sights_.of_rays(patch, rays, hash({seed_, keys_[patch], stream::ways_at_panes}));
  PatchRays told{{}, 0, count(seen, Sight::nothing), unseen(seen)};
  std::vector<PlainHit> hits;
  hits.reserve(rays.size());
  for (std::size_t k = 0; k < rays.size(); ++k) {
    if (!seen[k].met) continue;
    const Hit& hit = *seen[k].met;
    if (hit.distance > 0) told.inverse_lengths += 1 / hit.distance;
    if (seen[k].sight == Sight::patch) hits.push_back({k, &hit});
  }
  add_hits(patch, rays, hits, told, entries);
  return told;
}

PatchRays RowTracer::trace(PatchIndex patch, RowEntries& entries) const {
  PatchRays told = is_specular() ? trace_specular(patch, entries) : trace_plain(patch, entries);
  if (!bright_.empty()) add_toward_bright(patch, entries);
  return told;
}

namespace {

bool is_specular_side(const SurfaceOptics& faces, PolygonIndex polygon, Side side) {
  const SpecularSurface* const face = faces.at(polygon);
  return face && face->is_specular(side);
}

}  // namespace

// Every ray of a clear patch counts by the share that the patch holds at its angle.
bool RowTracer::starts_clear(PatchIndex patch) const {
  const SpecularSurface* const face = occluder_.optics().at(mesh_.polygon[patch]);
  return face && face->is_clear();
}

// A stop of a ray over the hemisphere on its way.
SpecularStop RowTracer::stop_at(PatchIndex patch, const Ray& ray, const WayStop& at) const {
  const SurfaceOptics& faces = occluder_.optics();
  const Hit& hit = at.hit;
  SpecularStop stop;
  stop.patch = SpecularStop::at_back;
  stop.form_factor = 1 / static_cast<float>(counts_[patch]);
  if (sights_.has_patches(hit)) {
    stop.patch = lookup_.patch_at(hit.polygon, hit.side, hit.point).value();
    if (bright_.density(stop.patch) > 0) stop.form_factor = entry_of(patch, ray, hit, stop.patch);
  }
  if (at.onward == Onward::ends) {
    stop.set(RayStep::ends, hit.side, 0);
    return stop;
  }
  stop.polygon = hit.polygon;
  stop.set(at.onward == Onward::through ? RayStep::through : RayStep::mirrored, hit.side,
           cosine_between(faces.normal(hit.polygon), hit.direction));
  return stop;
}

void RowTracer::add_stops(PatchIndex patch, const Ray& ray, const SeenWay& seen,
                          std::vector<SpecularStop>& stops) const {
  if (starts_clear(patch)) {
    SpecularStop start;
    start.polygon = mesh_.polygon[patch];
    start.set(RayStep::sent, mesh_.side[patch], cosine_between(mesh_.normal[patch], ray.direction));
    stops.push_back(start);
  }
  for (const WayStop& stop : seen.met) stops.push_back(stop_at(patch, ray, stop));
  if (!has_left(seen.met)) {
    if (seen.sight == Sight::contact) stops.back().patch = SpecularStop::at_back;
    return;
  }
  SpecularStop last;
  last.patch = seen.sight == Sight::nothing ? SpecularStop::in_the_open : SpecularStop::at_back;
  last.form_factor = 1 / static_cast<float>(counts_[patch]);
  last.set(RayStep::ends, Side::front, 0);
  stops.push_back(last);
}

PatchRays RowTracer::trace_specular(PatchIndex patch, RowEntries& entries) const {
  const std::vector<Ray> rays = hemisphere_rays(patch);
  const std::vector<SeenWay> seen = sights_.along_ways(patch, rays, hash({seed_, keys_[patch], stream::ways_at_panes}));
  const bool is_clear = starts_clear(patch);
  PatchRays told;
  std::vector<PlainHit> hits;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const std::size_t half = k / counts_[patch];
    const auto& [way, end] = seen[k];
    if (!way.empty() && way.back().hit.distance > 0) told.inverse_lengths += 1 / way.back().hit.distance;
    const bool is_plain = way.empty() || (way.size() == 1 && !has_left(way));
    const bool is_unseen = is_plain && (end == Sight::back || end == Sight::contact);
    if (is_unseen) ++told.unseen;
    if (is_clear || !is_plain) {
      add_stops(patch, rays[k], seen[k], entries.stops[half]);
    } else if (end == Sight::nothing) {
      ++told.escaped;
    } else if (!is_unseen) {
      hits.push_back({k, &way[0].hit});
    }
  }
  add_hits(patch, rays, hits, told, entries);
  return told;
}

// A shadow ray that is specular on its way.
std::vector<SpecularStop> RowTracer::crossing_stops(const ShadowPacket& packet, std::size_t lane, PatchIndex patch,
                                                    const RayEntry& entry,
                                                    std::span<const PolygonIndex> crossed) const {
  const SurfaceOptics& faces = occluder_.optics();
  const Vector direction = Vector(packet.toward_x[lane], packet.toward_y[lane], packet.toward_z[lane]).normalized();
  std::vector<SpecularStop> stops;
  const auto add = [&](RayStep step, PolygonIndex polygon, Side side) {
    SpecularStop stop;
    stop.polygon = polygon;
    stop.set(step, side, cosine_between(faces.normal(polygon), direction));
    stops.push_back(stop);
  };
  if (starts_clear(patch)) add(RayStep::sent, mesh_.polygon[patch], mesh_.side[patch]);
  for (const PolygonIndex polygon : crossed)
    add(RayStep::crossed, polygon, faces.normal(polygon).dot(direction) < 0 ? Side::front : Side::back);
  const PolygonIndex end = mesh_.polygon[entry.patch];
  const bool is_held = is_specular_side(faces, end, mesh_.side[entry.patch]);
  add(is_held ? RayStep::kept : RayStep::ends, end, mesh_.side[entry.patch]);
  stops.back().patch = entry.patch;
  stops.back().form_factor = entry.form_factor;
  return stops;
}

// Those of a packet that no opaque polygon blocks.
void RowTracer::add_arriving(const ShadowPacket& packet, PatchIndex patch, std::span<const RayEntry> entries,
                             std::size_t half, RowEntries& into) const {
  const SurfaceOptics& faces = occluder_.optics();
  const auto crossings = occluder_.crossings(packet);
  for (std::size_t lane = 0; lane < ShadowPacket::size; ++lane) {
    const RayEntry& entry = entries[lane];
    if (!(entry.form_factor > 0) || !crossings[lane]) continue;
    const bool is_plain = crossings[lane]->empty() && !starts_clear(patch) &&
                          !is_specular_side(faces, mesh_.polygon[entry.patch], mesh_.side[entry.patch]);
    if (is_plain) {
      into.halves[half].push_back(entry);
      continue;
    }
    const std::vector<SpecularStop> stops = crossing_stops(packet, lane, patch, entry, *crossings[lane]);
    into.stops[half].insert(into.stops[half].end(), stops.begin(), stops.end());
  }
}

}  // namespace patchlight
