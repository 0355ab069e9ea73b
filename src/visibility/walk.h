#pragma once

#include "patchlight/base/field.h"

#include "base/sampling.h"
#include "base/streams.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace patchlight {

/// A path that follows light backwards from a place through clear faces and mirrors.
struct SpecularPath {
  std::size_t start = 0;  ///< the number of the ray that the path began with
  std::uint32_t key = 0;  ///< of its random numbers
  Ray ray;                ///< its last segment
  Spectrum throughput;    ///< per band, the share of the radiance at the end of this segment that reaches the start
  double distance = 0;    ///< meters from the start to the origin of `ray`, along the path
  std::uint32_t reflections = 0;
  std::uint32_t crossings = 0;  ///< of clear faces
};

/// How a path continues from a face that it meets.
enum class Continuation {
  ends,
  specular,  ///< it splits: straight through a clear face, and mirrored; it ends at all others
  straight   ///< the face is ignored
};

struct WalkOptions {
  double min_throughput = 1e-3;  ///< Russian roulette ends weaker paths and keeps the mean (Arvo and Kirk 1990)
  std::uint64_t seed = 1;
  std::span<const std::uint64_t> keys = {};  ///< of the rays' random numbers; empty: the index of each ray
};

/// The largest number of faces on a path. Between mirrors of reflectance 0.99 this cuts off 3e-5 of the light.
inline constexpr std::uint64_t max_meetings_of_walk = 1024;

namespace walk_detail {

// Adds the continuation of a path if it survives. Below the limit it does so with probability throughput / limit.
inline void add_if_alive(std::vector<SpecularPath>& paths, const SpecularPath& path, const Hit& hit,
                         const Vector& direction, const Spectrum& fraction, bool is_mirrored, double min_throughput) {
  const Spectrum throughput = path.throughput * fraction;
  const double largest = throughput.maxCoeff();
  if (!(largest > 0)) return;
  const std::uint32_t key = hash({path.key, stream::survival_of_path, static_cast<std::uint64_t>(is_mirrored)});
  const double survival = std::min(1.0, largest / min_throughput);
  if (key * 0x1p-32 >= survival) return;
  paths.push_back({path.start, key, Ray{hit.point, direction, hit.polygon}, throughput / survival,
                   path.distance + hit.distance, path.reflections + (is_mirrored ? 1 : 0),
                   path.crossings + (is_mirrored ? 0 : 1)});
}

}  // namespace walk_detail

/// Follows one path from its first hit. `draw(hit, meeting)` returns the direction in which it continues, or nothing
/// where it ends. The result is the last hit, with the distance and the reflections of the whole path; nothing if it
/// leaves the scene.
template <typename Draw>
std::optional<Hit> follow_path(const Occluder& occluder, std::optional<Hit> hit, const Draw& draw) {
  for (std::uint64_t meeting = 0; hit && meeting < Occluder::most_meetings; ++meeting) {
    const Hit before = *hit;
    const std::optional<Vector> direction = draw(before, meeting);
    if (!direction) break;
    const Ray onward{before.point, *direction, before.polygon};
    hit = occluder.first_hits({&onward, 1}).front();
    if (!hit) break;
    hit->distance += before.distance;
    hit->reflections = before.reflections + (*direction == before.direction ? 0 : 1);
  }
  return hit;
}

/// Follows rays through the clear faces and mirrors that `optics` has, and calls `visit(path, hit)` wherever a path
/// meets a polygon, or leaves the scene without a hit. `visit` returns the Continuation. Throughputs have
/// optics.bands() bands. O(hits).
template <typename Visit>
void walk(const Occluder& occluder, const SurfaceOptics& optics, std::vector<Ray> rays, const WalkOptions& options,
          const Visit& visit) {
  std::vector<SpecularPath> paths;
  paths.reserve(rays.size());
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const std::uint32_t key = hash({options.seed, options.keys.empty() ? k : options.keys[k]});
    paths.push_back({k, key, rays[k], Spectrum::Ones(optics.bands())});
  }
  for (std::uint64_t meeting = 0; !paths.empty() && meeting < max_meetings_of_walk; ++meeting) {
    const std::vector<std::optional<Hit>> hits = occluder.first_hits(rays);
    std::vector<SpecularPath> next;
    for (std::size_t k = 0; k < paths.size(); ++k) {
      const SpecularPath& path = paths[k];
      const Continuation continuation = visit(path, hits[k]);
      if (!hits[k] || continuation == Continuation::ends) continue;
      const Hit& hit = *hits[k];
      if (continuation == Continuation::straight) {
        next.push_back(path);
        next.back().ray = {hit.point, hit.direction, hit.polygon};
        next.back().distance += hit.distance;
      } else if (optics.at(hit.polygon) != nullptr) {
        const auto add = [&](const Vector& direction, const Spectrum& fraction, bool is_mirrored) {
          walk_detail::add_if_alive(next, path, hit, direction, fraction, is_mirrored, options.min_throughput);
        };
        add(hit.direction, optics.spectral_transmittance(hit.polygon, hit.direction), false);
        add(optics.mirrored(hit.polygon, hit.direction), optics.spectral_reflectance(hit.polygon, hit.direction), true);
      }
    }
    paths = std::move(next);
    rays.clear();
    for (const SpecularPath& path : paths) rays.push_back(path.ray);
  }
}

}  // namespace patchlight
