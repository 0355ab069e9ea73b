#include "annual/sun_year.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "base/streams.h"
#include "lighting/direct_irradiance.h"
#include "lighting/mirror_paths.h"
#include "lighting/shades.h"
#include "scene/light_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <numeric>

namespace patchlight {
namespace {

// The suns that light a patch, with a share for each band.
struct SunsOfPatch {
  std::vector<std::uint32_t> suns;
  std::vector<float> shares;

  void add(std::uint32_t sun, const Spectrum& share) {
    if (!(share > 0).any()) return;
    suns.push_back(sun);
    for (const double of_band : share) shares.push_back(static_cast<float>(of_band));
  }
};

// The suns of each division, and the divisions with suns that touch each.
struct SunsInDivisions {
  std::vector<std::vector<std::uint32_t>> suns;
  std::vector<std::vector<std::size_t>> around;
};

std::vector<std::vector<std::uint32_t>> suns_of_each(const SkyDivisions& divisions, std::span<const Vector> suns) {
  std::vector<std::vector<std::uint32_t>> found(divisions.size());
  for (std::size_t k = 0; k < suns.size(); ++k) found[divisions.at(suns[k])].push_back(static_cast<std::uint32_t>(k));
  return found;
}

// Places of a division of Tregenza are about two degrees apart, so that those of neighbors are nearer than five; those
// of smaller ones in proportion.
SunsInDivisions suns_in(const SkyDivisions& coarse, std::span<const Vector> suns) {
  SunsInDivisions found{suns_of_each(coarse, suns), std::vector<std::vector<std::size_t>>(coarse.size())};
  const double degrees = 5.0 / coarse.factor();
  const double near = std::cos(degrees * std::numbers::pi / 180);
  const double far = std::cos((24.0 / coarse.factor() + degrees) * std::numbers::pi / 180);
  std::vector<std::vector<Vector>> places(coarse.size());
  for (std::size_t d = 1; d < coarse.size(); ++d) places[d] = coarse.directions(d, 6);
  const auto touch = [&](std::size_t a, std::size_t b) {
    if (places[a].front().dot(places[b].front()) < far) return false;
    return std::ranges::any_of(places[a], [&](const Vector& one) {
      return std::ranges::any_of(places[b], [&](const Vector& other) { return one.dot(other) > near; });
    });
  };
  for (std::size_t a = 1; a < coarse.size(); ++a) {
    if (found.suns[a].empty()) continue;
    for (std::size_t b = 1; b < coarse.size(); ++b)
      if (a == b || touch(a, b)) found.around[b].push_back(a);
  }
  return found;
}

// The coarse division around the middle of each fine one.
std::vector<std::size_t> coarse_of(const SkyDivisions& coarse, const SkyDivisions& fine) {
  std::vector<std::size_t> found = {0};
  for (std::size_t d = 1; d < fine.size(); ++d) found.push_back(coarse.at(fine.directions(d, 1).front()));
  return found;
}

// The mean share that arrives on a patch, by rays from places of it.
Spectrum share_by_rays(const Lighting& lighting, const Receiver& receiver, const Vector& sun, SamplePoints places) {
  std::vector<Segment> segments;
  for (const auto& [u, v, s, t] : places) {
    const SurfacePoint at = receiver.place(u, v);
    if (is_covered(lighting, receiver, at)) continue;
    segments.push_back({at.point, lighting.paths.beyond(at.point, sun), at.polygon, no_polygon});
  }
  if (segments.empty()) return Spectrum::Zero(lighting.bands);
  return lighting.paths.transmittance(segments).colwise().mean();
}

// Adds the light of some suns on a patch, exact where the outlines of all shadows are found in reasonable time.
void add_exactly(const Lighting& lighting, const Shades& shades, const Receiver& receiver,
                 std::span<const std::uint32_t> which, std::span<const Vector> suns, std::uint64_t key,
                 SunsOfPatch& found) {
  static const auto samples = scrambled_sobol(256, 7);
  const Vector normal = receiver.place(0.5, 0.5).normal;
  for (const std::uint32_t sun : which) {
    const auto exact = shades.transmittance(receiver, LightPlace{suns[sun], 0});
    const Spectrum share =
        exact ? *exact : share_by_rays(lighting, receiver, suns[sun], shifted(samples, hash({key, sun})));
    found.add(sun, normal.dot(suns[sun]) * share);
  }
}

// The same by one ray from a random place to each sun, whose mean over the suns is unbiased.
void add_by_single_rays(const Lighting& lighting, const Receiver& receiver, std::span<const std::uint32_t> which,
                        std::span<const Vector> suns, std::uint64_t key, SunsOfPatch& found) {
  std::vector<Segment> segments;
  for (const std::uint32_t sun : which) {
    const SurfacePoint at = receiver.place(hash({key, sun, 0}) * 0x1p-32, hash({key, sun, 1}) * 0x1p-32);
    segments.push_back({at.point, lighting.paths.beyond(at.point, suns[sun]), at.polygon, no_polygon});
  }
  const Field shares = lighting.paths.transmittance(segments);
  const Vector normal = receiver.place(0.5, 0.5).normal;
  for (std::size_t k = 0; k < which.size(); ++k)
    found.add(which[k], normal.dot(suns[which[k]]) * shares.row(static_cast<Eigen::Index>(k)));
}

// A lighting by one sun of normal irradiance 1 alone, with the mirrors by which its light goes.
Lighting lighting_of_sun(const SunWays& ways, const Vector& direction) {
  Lighting lighting = ways.lighting;
  lighting.sky.reset();
  lighting.openings.clear();
  lighting.sun = Sun{direction, Spectrum::Ones(lighting.bands)};
  lighting.mirrors = std::make_shared<const Mirrors>(ways.scene, ways.tracing, lighting);
  return lighting;
}

// Light over mirrors alone. A patch takes four places.
const LightingOptions in_mirrors_alone{.mirrored_samples = 4, .only_in_mirrors = true};

// Adds the light of suns that gets to patches over mirrors: that of all suns of a division from their mean direction.
void add_over_mirrors(const SunWays& ways, const PatchMesh& mesh, const SkyDivisions& divisions,
                      std::span<const Vector> suns, const Observer& observer, std::vector<SunsOfPatch>& of_patches) {
  const std::vector<std::vector<std::uint32_t>> in = suns_of_each(divisions, suns);
  std::vector<Field> of_division(in.size());
  parallel_for(in.size(), Stage::direct_light, observer, [&](std::size_t d) {
    if (in[d].empty()) return;
    Vector sum = Vector::Zero();
    for (const std::uint32_t sun : in[d]) sum += suns[sun];
    const Lighting by_sun = lighting_of_sun(ways, sum.normalized());
    if (by_sun.mirrors->paths.chains().empty()) return;
    of_division[d] = direct_irradiance(by_sun, mesh, in_mirrors_alone).irradiance;
  });
  for (std::size_t d = 0; d < in.size(); ++d)
    for (Eigen::Index patch = 0; patch < of_division[d].rows(); ++patch) {
      for (const std::uint32_t sun : in[d])
        of_patches[static_cast<std::size_t>(patch)].add(sun, of_division[d].row(patch));
    }
}

// Suns by patches of one band; light of one sun by several ways is added up.
SparseSunlight matrix_of(const std::vector<SunsOfPatch>& of_patches, std::size_t suns, std::size_t band,
                         std::size_t bands) {
  Eigen::Index count = 0;
  for (const SunsOfPatch& of_patch : of_patches) count += static_cast<Eigen::Index>(of_patch.suns.size());
  SparseSunlight by_patch(static_cast<Eigen::Index>(of_patches.size()), static_cast<Eigen::Index>(suns));
  by_patch.reserve(count);
  for (std::size_t patch = 0; patch < of_patches.size(); ++patch) {
    const auto& [of_suns, shares] = of_patches[patch];
    const auto row = static_cast<Eigen::Index>(patch);
    std::vector<std::size_t> order(of_suns.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return of_suns[a] < of_suns[b]; });
    by_patch.startVec(row);
    float* last = nullptr;
    for (std::size_t n = 0; n < order.size(); ++n) {
      const float share = shares[order[n] * bands + band];
      if (n > 0 && of_suns[order[n]] == of_suns[order[n - 1]])
        *last += share;
      else
        last = &(by_patch.insertBack(row, of_suns[order[n]]) = share);
    }
  }
  by_patch.finalize();
  return by_patch.transpose();
}

}  // namespace

std::vector<Eigen::MatrixXf> sunlight_at(const SunWays& ways, std::span<const SurfacePoint> points,
                                         std::span<const Vector> suns, const Observer& observer) {
  const Lighting& lighting = ways.lighting;
  std::vector<Eigen::MatrixXf> all(
      static_cast<std::size_t>(lighting.bands),
      Eigen::MatrixXf::Zero(static_cast<Eigen::Index>(suns.size()), static_cast<Eigen::Index>(points.size())));
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
        all[band](static_cast<Eigen::Index>(of_sun[n]), static_cast<Eigen::Index>(k)) =
            static_cast<float>(cosine * share(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(band)));
    }
  });
  if (!lighting.mirrors) return all;
  parallel_for(suns.size(), Stage::direct_light, observer, [&](std::size_t s) {
    const Lighting by_sun = lighting_of_sun(ways, suns[s]);
    if (by_sun.mirrors->paths.chains().empty()) return;
    const Field more = direct_irradiance(by_sun, points, in_mirrors_alone).irradiance;
    for (std::size_t band = 0; band < all.size(); ++band)
      all[band].row(static_cast<Eigen::Index>(s)) +=
          more.col(static_cast<Eigen::Index>(band)).transpose().cast<float>().matrix();
  });
  return all;
}

std::vector<SparseSunlight> sunlight_on(const SunWays& ways, const PatchMesh& mesh, const SparseCoefficients& sky,
                                        const SkyDivisions& divisions, std::span<const Vector> suns,
                                        const SunSampling& sampling, const Observer& observer) {
  const Lighting& lighting = ways.lighting;
  const Shades shades(ways.scene, ways.tracing.coverings(), lighting.paths.optics());
  const SkyDivisions coarse = divisions.cut(std::min(2, divisions.factor()));
  const SunsInDivisions in = suns_in(coarse, suns);
  const std::vector<std::size_t> coarse_division = coarse_of(coarse, divisions);
  std::vector<SunsOfPatch> of_patches(mesh.size());
  parallel_for(mesh.size(), Stage::direct_light, observer, [&](std::size_t k) {
    const auto patch = static_cast<PatchIndex>(k);
    std::vector<std::uint8_t> is_near(coarse.size(), 0);
    for (SparseCoefficients::InnerIterator seen(sky, static_cast<Eigen::Index>(k)); seen; ++seen)
      for (const std::size_t d : in.around[coarse_division[static_cast<std::size_t>(seen.col())]]) is_near[d] = 1;
    std::vector<std::uint32_t> which;
    for (std::size_t d = 1; d < coarse.size(); ++d)
      for (const std::uint32_t sun : in.suns[d])
        if (is_near[d] != 0 && mesh.normal[patch].dot(suns[sun]) > 0) which.push_back(sun);
    const Receiver receiver = receiver_of(mesh, patch);
    const std::uint64_t key = hash({sampling.seed, k, stream::places_in_sun});
    const bool is_exact =
        sampling.is_important[k] != 0 || lighting.paths.is_covered_in_part(mesh.polygon[k], mesh.side[k]);
    if (is_exact)
      add_exactly(lighting, shades, receiver, which, suns, key, of_patches[k]);
    else
      add_by_single_rays(lighting, receiver, which, suns, key, of_patches[k]);
  });
  if (lighting.mirrors) add_over_mirrors(ways, mesh, divisions, suns, observer, of_patches);
  std::vector<SparseSunlight> all;
  const auto bands = static_cast<std::size_t>(lighting.bands);
  for (std::size_t band = 0; band < bands; ++band) all.push_back(matrix_of(of_patches, suns.size(), band, bands));
  return all;
}

}  // namespace patchlight
