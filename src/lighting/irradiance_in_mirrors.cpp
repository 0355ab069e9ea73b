#include "lighting/irradiance_in_mirrors.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "base/streams.h"
#include "lighting/mirror_paths.h"
#include "lighting/receiver.h"
#include "mesh/nested_mesh.h"
#include "visibility/walk.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

constexpr int doublings_at_points = 4;

Ball ball_of(const Receiver& receiver) {
  return receiver.is_point() ? Ball{receiver.place(0, 0).point, 0} : ball_around(receiver.corners);
}

// Receivers that follow each other mostly lie together: which chains may lead to any of them is found first.
constexpr std::size_t receivers_at_once = 64;

Ball ball_around_all(std::span<const Receiver> receivers) {
  std::vector<Point> points;
  for (const Receiver& receiver : receivers) {
    if (receiver.is_point()) points.push_back(receiver.place(0, 0).point);
    points.insert(points.end(), receiver.corners.begin(), receiver.corners.end());
  }
  return ball_around(points);
}

SurfacePoint image_of(const MirrorChain& chain, const SurfacePoint& at) {
  return {chain.image * at.point, chain.image.linear() * at.normal, at.polygon};
}

// A chain of mirrors, and the sources whose light may come by it.
struct WantedChain {
  const MirrorChain* chain;
  std::vector<const LightSource*> sources;
};

// The relative error of a sum over n chains with k samples each is proportional to 1 / sqrt(n k). Above this number of
// chains, each takes fewer samples.
constexpr std::size_t chains_with_all_samples = 32;

// A place of the receiver, which samples lead on from it, and which replicate it belongs to.
struct SampledPlace {
  SurfacePoint at;
  std::array<double, 4> sample;
  Eigen::Index replicate;
};

// How many replicates a receiver takes, and of how many points each.
struct MirrorEffort {
  std::size_t replicates = 0;
  std::size_t points = 0;
};

// Irradiance of each replicate.
struct OverChains {
  Field light;
  Field beyond;  // bound of the light of chains that are not followed
};

// The first places of each replicate.
std::vector<SampledPlace> places_for_chains(std::span<const SampledPlace> places, std::size_t chains) {
  const std::size_t times = std::bit_floor(std::max<std::size_t>(1, chains / chains_with_all_samples));
  std::vector<SampledPlace> chosen;
  for (auto first = places.begin(); first != places.end();) {
    const auto last = std::find_if(first, places.end(), [&](const auto& p) { return p.replicate != first->replicate; });
    const auto count =
        static_cast<std::ptrdiff_t>(std::max<std::size_t>(1, static_cast<std::size_t>(last - first) / times));
    chosen.insert(chosen.end(), first, first + count);
    first = last;
  }
  return chosen;
}

// How a receiver looks for sky in mirrors.
struct SkyInMirrors {
  bool is_point = false;
  Chooser targets = {};  // SpecularAim::targets_from() the middle
};

SkyInMirrors sky_in_mirrors(const Lighting& lighting, const Receiver& receiver) {
  SkyInMirrors how{.is_point = receiver.is_point()};
  if (lighting.sky) how.targets = lighting.mirrors->aim.targets_from(receiver.place(0.5, 0.5));
  return how;
}

struct MirrorSampler {
  const LightSampler& lights;
  const Lighting& lighting = lights.lighting();
  std::vector<std::vector<std::array<double, 4>>> points = {};  // per replicate, the most that any takes

  std::vector<WantedChain> all_chains() const;
  std::vector<WantedChain> chains_to(const Ball& ball, std::span<const WantedChain> among) const;
  OverChains over_chains(std::span<const WantedChain> chains, std::span<const SampledPlace> places) const;
  std::vector<SampledPlace> places_on(const Receiver& receiver, std::uint32_t key, const MirrorEffort& effort) const;
  OverChains replicates_at(const Receiver& receiver, std::uint32_t key, const MirrorEffort& effort,
                           std::span<const WantedChain> among) const;
};

std::vector<WantedChain> MirrorSampler::all_chains() const {
  std::vector<WantedChain> all;
  const MirrorPaths& paths = lighting.mirrors->paths;
  for (const MirrorChain& chain : paths.chains()) {
    WantedChain one{&chain, {}};
    for (const LightSource& source : lights.sources())
      if (paths.carries(chain, source.id())) one.sources.push_back(&source);
    if (!one.sources.empty()) all.push_back(std::move(one));
  }
  return all;
}

// Those by which light may get to a ball.
std::vector<WantedChain> MirrorSampler::chains_to(const Ball& ball, std::span<const WantedChain> among) const {
  std::vector<WantedChain> wanted;
  const MirrorPaths& paths = lighting.mirrors->paths;
  for (const auto& [chain, may_come] : among) {
    const MirrorSide& first = chain->mirrors.front();
    if (!(first.normal.dot(ball.centre - first.on_plane) > -ball.radius)) continue;
    WantedChain one{chain, {}};
    for (const LightSource* const source : may_come) {
      const SourceExtent& extent = source->extent();
      const bool passes = extent.direction ? paths.may_pass(*chain, ball, *extent.direction)
                                           : paths.may_pass(*chain, ball, extent.ball);
      if (passes) one.sources.push_back(source);
    }
    if (!one.sources.empty()) wanted.push_back(std::move(one));
  }
  return wanted;
}

// The means over the places of each replicate. The shadow rays of all of them are traced together.
OverChains MirrorSampler::over_chains(std::span<const WantedChain> chains, std::span<const SampledPlace> places) const {
  struct Arriving {
    Eigen::Index replicate;
    LightSample sample;
  };
  const Field none = Field::Zero(places.empty() ? 0 : places.back().replicate + 1, lighting.bands);
  OverChains sums{none, none};
  for (const auto& [chain, wanted] : chains) {
    std::vector<Segment> segments;
    std::vector<Arriving> unoccluded;
    for (const SampledPlace& place : places) {
      const MirrorSide& first = chain->mirrors.front();
      if (!(first.normal.dot(place.at.point - first.on_plane) > 0)) continue;
      const SurfacePoint image = image_of(*chain, place.at);
      for (const LightSource* const source : wanted) {
        const LightSample sample = source->sample(image, {place.sample[2], place.sample[3]});
        if (!(sample.irradiance > 0)) continue;
        segments.push_back(segment_to(sample, place.at));
        unoccluded.push_back({place.replicate, sample});
      }
    }
    if (segments.empty()) continue;
    const Field share = lighting.mirrors->paths.transmittance(*chain, lighting.paths, segments);
    for (std::size_t k = 0; k < segments.size(); ++k) {
      const auto& [replicate, sample] = unoccluded[k];
      const auto arriving = sample.irradiance * *sample.color * share.row(static_cast<Eigen::Index>(k));
      sums.light.row(replicate) += arriving;
      sums.beyond.row(replicate) += chain->beyond * arriving;
    }
  }
  Eigen::ArrayXd count = Eigen::ArrayXd::Zero(sums.light.rows());
  for (const SampledPlace& place : places) count[place.replicate] += 1;
  for (Field* const field : {&sums.light, &sums.beyond}) field->colwise() /= count;
  return sums;
}

// Sky that paths from places of one replicate see after one or more reflections: its mean irradiance. A point is one
// place, with all of the samples. All places share the probabilities of the middle, which cost more than the rays;
// places that see other targets find them by the rays that are distributed as the cosine.
void visit_sky_from(const Lighting& lighting, std::span<const SampledPlace> places, const SkyInMirrors& how,
                    std::uint32_t key, const AtSky& at_sky) {
  const auto& [paths, aim, occluder] = *lighting.mirrors;
  const auto set = static_cast<std::size_t>(places.front().replicate);
  const std::size_t each = how.is_point ? places.size() : 2;
  std::vector<Ray> rays;
  std::vector<double> weights;
  for (std::size_t k = 0; k < (how.is_point ? 1 : places.size()); ++k) {
    std::vector<std::array<double, 2>> samples;
    for (std::size_t n = 0; n < each; ++n) {
      const std::array<double, 4>& sample = places[(k + n) % places.size()].sample;
      samples.push_back({sample[2], sample[3]});
    }
    const Chooser targets = how.targets.empty() ? aim.targets_from(places[k].at) : how.targets;
    if (targets.empty() && aim.has_all_faces()) continue;  // no reflection can be seen
    for (const auto& [ray, weight] : aim.rays(places[k].at, targets, samples)) {
      rays.push_back(ray);
      weights.push_back(how.is_point ? weight : weight / static_cast<double>(places.size()));
    }
  }
  walk(occluder, *lighting.paths.optics(), std::move(rays), {.seed = key},
       [&](const SpecularPath& path, const std::optional<Hit>& hit) {
         if (!hit && path.reflections > 0) at_sky(set, path.ray.direction, weights[path.start] * path.throughput);
         return Continuation::specular;
       });
}

// Those over which no other polygon lies; replicates without such a place are left out of the numbers.
std::vector<SampledPlace> MirrorSampler::places_on(const Receiver& receiver, std::uint32_t key,
                                                   const MirrorEffort& effort) const {
  std::vector<SampledPlace> places;
  Eigen::Index replicate = 0;
  for (std::uint32_t r = 0; r < effort.replicates; ++r) {
    const std::size_t before = places.size();
    for (const auto& sample : shifted(std::span(points[r]).first(effort.points), hash({key, r}))) {
      const SurfacePoint at = receiver.place(sample[0], sample[1]);
      if (!is_covered(lighting, receiver, at)) places.push_back({at, sample, replicate});
    }
    if (places.size() > before) ++replicate;
  }
  return places;
}

// One row for each replicate that has a place over which no other polygon lies.
OverChains MirrorSampler::replicates_at(const Receiver& receiver, std::uint32_t key, const MirrorEffort& effort,
                                        std::span<const WantedChain> among) const {
  const std::vector<WantedChain> chains = chains_to(ball_of(receiver), among);
  const SurfacePoint middle = receiver.place(0.5, 0.5);
  const Spectrum unfollowed = lighting.mirrors->paths.unfollowed_irradiance(lights, middle.point, middle.normal);
  if (chains.empty() && !lighting.sky) return {Field::Zero(1, lighting.bands), unfollowed};
  const std::vector<SampledPlace> places = places_on(receiver, key, effort);
  OverChains found = over_chains(chains, places_for_chains(places, chains.size()));
  const SkyInMirrors to_sky = sky_in_mirrors(lighting, receiver);
  const std::span all(places);
  for (auto first = all.begin(); first != all.end();) {
    const auto last = std::find_if(first, all.end(), [&](const auto& p) { return p.replicate != first->replicate; });
    if (lighting.sky)
      visit_sky_from(lighting, {first, last}, to_sky, hash({key, static_cast<std::uint64_t>(first->replicate)}),
                     [&](std::size_t, const Vector& direction, const Spectrum& weight) {
                       found.light.row(first->replicate) += weight * radiance(*lighting.sky, direction);
                     });
    first = last;
  }
  found.beyond.rowwise() += unfollowed;
  return found;
}

// Receivers, the share of the replicates that each takes, and how often the points of these are doubled.
struct MirrorReceivers {
  std::size_t count = 0;
  std::function<Receiver(std::size_t)> at;
  std::function<double(std::size_t)> share_at;
  std::function<unsigned(std::size_t)> doublings_at;
  int most_doublings = 0;
};

DirectIrradiance in_mirrors_at(const LightSampler& lights, const MirrorReceivers& all, const LightingOptions& options,
                               const Observer& observer) {
  const Lighting& lighting = lights.lighting();
  MirrorSampler sampler{lights};
  const auto samples = std::bit_ceil(static_cast<std::uint32_t>(std::max(2, options.mirrored_samples)));
  const std::uint32_t replicates = std::clamp(samples / 2, 2U, 8U);
  const std::uint32_t of_each = samples / replicates;
  for (std::uint32_t r = 0; r < replicates; ++r)
    sampler.points.push_back(scrambled_sobol(of_each << static_cast<unsigned>(all.most_doublings),
                                             hash({options.seed, r, stream::points_of_mirror_chains})));
  const std::vector<WantedChain> chains = sampler.all_chains();
  const std::size_t count = all.count;
  const auto rows = static_cast<Eigen::Index>(count);
  const Field none = Field::Zero(rows, lighting.bands);
  DirectIrradiance direct{none, none, none};
  const std::size_t groups = (count + receivers_at_once - 1) / receivers_at_once;
  parallel_for(groups, Stage::direct_light, observer, [&](std::size_t group) {
    const std::size_t begin = group * receivers_at_once;
    std::vector<Receiver> receivers;
    for (std::size_t k = begin; k < std::min(count, begin + receivers_at_once); ++k) receivers.push_back(all.at(k));
    const std::vector<WantedChain> near = sampler.chains_to(ball_around_all(receivers), chains);
    for (std::size_t k = begin; k < begin + receivers.size(); ++k) {
      const auto share = static_cast<std::size_t>(std::lround(all.share_at(k) * replicates));
      const MirrorEffort effort{std::max<std::size_t>(2, share), std::size_t{of_each} << all.doublings_at(k)};
      const std::uint32_t key = hash({options.seed, k / options.alike, stream::shift_at_receiver});
      const auto [light, not_followed] = sampler.replicates_at(receivers[k - begin], key, effort, near);
      if (light.rows() == 0) continue;
      const auto [mean, variance] = estimate_of(light);
      const Spectrum bound = not_followed.colwise().mean();
      direct.irradiance.row(static_cast<Eigen::Index>(k)) = mean;
      direct.standard_error.row(static_cast<Eigen::Index>(k)) = (variance + bound.square()).sqrt();
      direct.unfollowed.row(static_cast<Eigen::Index>(k)) = bound;
    }
  });
  return direct;
}

}  // namespace

DirectIrradiance irradiance_in_mirrors(const LightSampler& lights, const PatchMesh& mesh,
                                       const LightingOptions& options, const Observer& observer) {
  const auto patch = [&](std::size_t k) { return receiver_of(mesh, static_cast<PatchIndex>(k)); };
  const std::vector<double>& areas = options.areas.empty() ? mesh.area : options.areas;
  const double usual = options.usual_area > 0 ? options.usual_area : mean_area(areas);
  const std::span<const std::uint8_t> more = options.doublings;
  const auto share = [&](std::size_t k) { return std::clamp(std::sqrt(areas[k] / usual), 0.25, 1.0); };
  const auto doublings = [&](std::size_t k) -> unsigned { return more.empty() ? 0 : more[k]; };
  const int most = more.empty() ? 0 : *std::max_element(more.begin(), more.end());
  return in_mirrors_at(lights, {std::size_t{mesh.size()}, patch, share, doublings, most}, options, observer);
}

DirectIrradiance irradiance_in_mirrors(const LightSampler& lights, std::span<const SurfacePoint> points,
                                       const LightingOptions& options, const Observer& observer) {
  const auto point = [&](std::size_t k) { return receiver_of(points[k]); };
  const auto all = [](std::size_t) { return 1.0; };
  // All samples of a light without extent are alike at a point.
  const bool are_delta = std::ranges::all_of(lights.sources(), &LightSource::is_delta) && !lights.lighting().sky;
  const int most = are_delta ? 0 : doublings_at_points;
  const auto doublings = [most](std::size_t) { return static_cast<unsigned>(most); };
  return in_mirrors_at(lights, {points.size(), point, all, doublings, most}, options, observer);
}

void visit_sky_in_mirrors(const Lighting& lighting, const Receiver& receiver, SamplePoints samples, std::uint32_t key,
                          const AtSky& at_sky) {
  std::vector<SampledPlace> places;
  for (const auto& sample : shifted(samples, key)) {
    const SurfacePoint at = receiver.place(sample[0], sample[1]);
    if (!is_covered(lighting, receiver, at)) places.push_back({at, sample, 0});
  }
  if (!places.empty()) visit_sky_from(lighting, places, sky_in_mirrors(lighting, receiver), key, at_sky);
}

}  // namespace patchlight
