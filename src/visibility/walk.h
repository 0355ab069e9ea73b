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
  double least_throughput = 1e-3;  ///< Russian roulette ends weaker paths and keeps the mean (Arvo and Kirk 1990)
  std::uint64_t seed = 1;
};

namespace walk_detail {

// The path from a face that `path` has met.
inline SpecularPath next_path(const SpecularPath& path, const Hit& hit, const Vector& direction) {
  SpecularPath next = path;
  next.ray = {hit.point, direction, hit.polygon};
  next.distance += hit.distance;
  return next;
}

// Russian roulette: a path whose throughput t is below the limit survives with probability t / limit.
inline void add_survivor(std::vector<SpecularPath>& paths, SpecularPath path, const WalkOptions& options,
                         std::uint64_t meeting) {
  const double most = path.throughput.maxCoeff();
  if (!(most > 0)) return;
  if (most < options.least_throughput) {
    const double survival = most / options.least_throughput;
    if (hash({options.seed, stream::survival_of_path, path.start, meeting, path.reflections}) * 0x1p-32 >= survival)
      return;
    path.throughput /= survival;
  }
  paths.push_back(std::move(path));
}

inline void add_specular(std::vector<SpecularPath>& paths, const SpecularPath& path, const Hit& hit,
                         const SurfaceOptics& optics, const WalkOptions& options, std::uint64_t meeting) {
  if (!optics.at(hit.polygon)) return;
  SpecularPath through = next_path(path, hit, hit.direction);
  through.throughput *= optics.spectral_transmittance(hit.polygon, hit.direction);
  ++through.crossings;
  SpecularPath mirrored = next_path(path, hit, optics.mirrored(hit.polygon, hit.direction));
  mirrored.throughput *= optics.spectral_reflectance(hit.polygon, hit.direction);
  ++mirrored.reflections;
  add_survivor(paths, std::move(through), options, meeting);
  add_survivor(paths, std::move(mirrored), options, meeting);
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
/// meets a polygon, or leaves the scene without a hit. `visit` returns the Continuation. A path has at most
/// Occluder::most_meetings hits. O(hits).
template <typename Visit>
void walk(const Occluder& occluder, const SurfaceOptics& optics, std::vector<Ray> rays, const WalkOptions& options,
          const Visit& visit) {
  std::vector<SpecularPath> paths;
  paths.reserve(rays.size());
  for (std::size_t k = 0; k < rays.size(); ++k) paths.push_back({k, rays[k], Spectrum::Ones(optics.bands())});
  for (std::uint64_t meeting = 0; !paths.empty() && meeting < Occluder::most_meetings; ++meeting) {
    const std::vector<std::optional<Hit>> hits = occluder.first_hits(rays);
    std::vector<SpecularPath> next;
    for (std::size_t k = 0; k < paths.size(); ++k) {
      const Continuation continuation = visit(std::as_const(paths[k]), hits[k]);
      if (!hits[k] || continuation == Continuation::ends) continue;
      if (continuation == Continuation::straight)
        next.push_back(walk_detail::next_path(paths[k], *hits[k], hits[k]->direction));
      else
        walk_detail::add_specular(next, paths[k], *hits[k], optics, options, meeting);
    }
    paths = std::move(next);
    rays.clear();
    for (const SpecularPath& path : paths) rays.push_back(path.ray);
  }
}

}  // namespace patchlight
