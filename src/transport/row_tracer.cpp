#include "transport/row_tracer.h"

#include "base/sampling.h"
#include "form_factor/patch_keys.h"
#include "form_factor/patch_shape.h"
#include "transport/patch_frame.h"
#include "transport/ray_counts.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace patchlight {
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

// The place of a patch with these coordinates, and what its samples weigh there.
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

// What the random points of a patch are for: they are independent.
enum class RowTracer::Purpose : std::uint32_t { hemisphere, toward_bright };

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

SampleSet RowTracer::samples(PatchIndex patch, Purpose purpose, std::uint32_t half) const {
  return table_.of_pair(keys_[patch], static_cast<std::uint32_t>(purpose), half);
}

// Those of the first half, then those of the second.
std::vector<Ray> RowTracer::hemisphere_rays(PatchIndex patch) const {
  const QuadPoints points(mesh_.corner_points(patch).points);
  const Eigen::Matrix3d frame = patch_frame(mesh_, patch);
  std::vector<Ray> rays;
  rays.reserve(2 * std::size_t{counts_[patch]});
  for (const std::uint32_t half : {0U, 1U}) {
    const SampleSet set = samples(patch, Purpose::hemisphere, half);
    for (std::size_t k = 0; k < counts_[patch]; ++k) {
      const Vector direction = square_to_cosine_hemisphere(coordinate(set, 0, k), coordinate(set, 1, k));
      rays.push_back(
          {points.at(coordinate(set, 2, k), coordinate(set, 3, k)), frame * direction, mesh_.polygon[patch]});
    }
  }
  return rays;
}

// The contribution of a ray over the hemisphere that meets a bright patch, by the balance heuristic: G / (n G + m p).
// No shadow ray comes by way of a mirror: there it is 1 / n.
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
    rays.set = samples(patch, Purpose::toward_bright, half);
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
  const std::vector<Seen> seen = sights_.of_rays(patch, rays, hash({seed_, keys_[patch], 2}));
  PatchRays told{{}, 0, count(seen, Sight::nothing), unseen(seen)};
  std::vector<PlainHit> hits;
  hits.reserve(rays.size());
  for (std::size_t k = 0; k < rays.size(); ++k) {
    if (!seen[k].hit) continue;
    const Hit& hit = *seen[k].hit;
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

}  // namespace patchlight
