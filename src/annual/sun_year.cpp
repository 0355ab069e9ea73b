#include "annual/sun_year.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "base/streams.h"
#include "lighting/shades.h"
#include "scene/light_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace patchlight {
namespace {

// What arrives on one patch from one position of the sun.
struct OfSun {
  std::uint32_t sun = 0;
  Spectrum share;
};

// The suns of each division, and for each division the ones that touch it with itself.
struct SunsInDivisions {
  std::vector<std::vector<std::uint32_t>> suns;
  std::vector<std::vector<std::size_t>> around;
};

SunsInDivisions suns_in(const SkyDivisions& divisions, std::span<const Vector> suns) {
  SunsInDivisions found{std::vector<std::vector<std::uint32_t>>(divisions.size()),
                        std::vector<std::vector<std::size_t>>(divisions.size())};
  for (std::size_t k = 0; k < suns.size(); ++k)
    found.suns[divisions.at(suns[k])].push_back(static_cast<std::uint32_t>(k));
  constexpr int across = 6;
  const double near = std::cos(5 * 3.14159265358979 / 180);
  std::vector<std::vector<Vector>> places(divisions.size());
  for (std::size_t d = 1; d < divisions.size(); ++d) places[d] = divisions.directions(d, across);
  const auto touch = [&](std::size_t a, std::size_t b) {
    return std::ranges::any_of(places[a], [&](const Vector& one) {
      return std::ranges::any_of(places[b], [&](const Vector& other) { return one.dot(other) > near; });
    });
  };
  for (std::size_t a = 1; a < divisions.size(); ++a) {
    if (found.suns[a].empty()) continue;
    for (std::size_t b = 1; b < divisions.size(); ++b)
      if (a == b || touch(a, b)) found.around[b].push_back(a);
  }
  return found;
}

// The mean share that arrives on a patch, by rays: where shadows are too many for their outlines.
Spectrum share_by_rays(const Lighting& lighting, const Receiver& receiver, const Vector& sun, std::uint32_t key) {
  static const auto samples = scrambled_sobol(256, 7);
  std::vector<Segment> segments;
  for (const auto& [u, v, s, t] : shifted(samples, key)) {
    const SurfacePoint at = receiver.place(u, v);
    if (is_covered(lighting, receiver, at)) continue;
    segments.push_back({at.point, lighting.paths.beyond(at.point, sun), at.polygon, no_polygon});
  }
  if (segments.empty()) return Spectrum::Zero(lighting.bands);
  return lighting.paths.transmittance(segments).colwise().mean();
}

std::vector<SparseSunlight> matrices_of(const std::vector<std::vector<OfSun>>& of_patches, std::size_t suns,
                                        Eigen::Index bands) {
  std::vector<SparseSunlight> all;
  std::size_t count = 0;
  for (const auto& of_patch : of_patches) count += of_patch.size();
  for (Eigen::Index band = 0; band < bands; ++band) {
    std::vector<Eigen::Triplet<float>> entries;
    entries.reserve(count);
    for (std::size_t patch = 0; patch < of_patches.size(); ++patch)
      for (const auto& [sun, share] : of_patches[patch])
        entries.emplace_back(static_cast<int>(sun), static_cast<int>(patch), static_cast<float>(share[band]));
    SparseSunlight matrix(static_cast<Eigen::Index>(suns), static_cast<Eigen::Index>(of_patches.size()));
    matrix.setFromTriplets(entries.begin(), entries.end());
    all.push_back(std::move(matrix));
  }
  return all;
}

}  // namespace

std::vector<Eigen::MatrixXf> sunlight_at(const Lighting& lighting, std::span<const SurfacePoint> points,
                                         std::span<const Vector> suns, const Observer& observer) {
  const auto rows = static_cast<Eigen::Index>(suns.size());
  std::vector<Eigen::MatrixXf> all(static_cast<std::size_t>(lighting.bands),
                                   Eigen::MatrixXf::Zero(rows, static_cast<Eigen::Index>(points.size())));
  parallel_for(points.size(), Stage::direct_light, observer, [&](std::size_t k) {
    const SurfacePoint& at = points[k];
    std::vector<Segment> segments;
    std::vector<std::size_t> of_sun;
    for (std::size_t s = 0; s < suns.size(); ++s) {
      if (!(at.normal.dot(suns[s]) > 0)) continue;
      segments.push_back({at.point, lighting.paths.beyond(at.point, suns[s]), at.polygon, no_polygon});
      of_sun.push_back(s);
    }
    const Field share = lighting.paths.transmittance(segments);
    for (std::size_t n = 0; n < of_sun.size(); ++n) {
      const double cosine = at.normal.dot(suns[of_sun[n]]);
      for (std::size_t band = 0; band < all.size(); ++band)
        all[band](static_cast<Eigen::Index>(of_sun[n]), static_cast<Eigen::Index>(k)) = static_cast<float>(
            cosine * share(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(band)));
    }
  });
  return all;
}

std::vector<SparseSunlight> sunlight_on(const Lighting& lighting, const Shades& shades, const PatchMesh& mesh,
                                        const SparseCoefficients& visible, const SkyDivisions& divisions,
                                        std::span<const Vector> suns, std::uint64_t seed, const Observer& observer) {
  const SunsInDivisions in = suns_in(divisions, suns);
  std::vector<std::vector<OfSun>> of_patches(mesh.size());
  parallel_for(mesh.size(), Stage::direct_light, observer, [&](std::size_t k) {
    const auto patch = static_cast<PatchIndex>(k);
    const Receiver receiver = receiver_of(mesh, patch);
    std::vector<std::uint8_t> takes_part(divisions.size(), 0);
    for (SparseCoefficients::InnerIterator seen(visible, static_cast<Eigen::Index>(k)); seen; ++seen)
      for (const std::size_t d : in.around[static_cast<std::size_t>(seen.col())]) takes_part[d] = 1;
    for (std::size_t d = 1; d < divisions.size(); ++d) {
      if (takes_part[d] == 0) continue;
      for (const std::uint32_t sun : in.suns[d]) {
        const double cosine = mesh.normal[patch].dot(suns[sun]);
        if (!(cosine > 0)) continue;
        const auto exact = shades.transmittance(receiver, LightPlace{suns[sun], 0});
        const Spectrum share =
            exact ? *exact : share_by_rays(lighting, receiver, suns[sun], hash({seed, k, sun, stream::places_in_sun}));
        if ((share > 0).any()) of_patches[k].push_back({sun, cosine * share});
      }
    }
  });
  return matrices_of(of_patches, suns.size(), lighting.bands);
}

}  // namespace patchlight
