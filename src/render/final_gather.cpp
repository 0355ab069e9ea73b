#include "render/final_gather.h"

#include "patchlight/base/error.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "render/pixel_samples.h"
#include "render/pixel_statistics.h"
#include "render/seen.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

constexpr int gather_tile_edge = 32;  // pixels
constexpr std::uint32_t first_samples = 4;
constexpr std::uint32_t next_samples = 16;   // at most, before the number of all is chosen
constexpr std::uint32_t rays_to_lights = 4;  // of each sample

// Records are wanted at every so many pixels, first far from each other; where the weights around are less than enough.
constexpr int first_stride = 32;
constexpr int last_stride = 2;
constexpr double enough_weight = 0.35;

// A record serves as many pixels around it, at least and at most.
constexpr double least_pixels = 3;
constexpr double most_pixels = 64;

// Points without a record take so many rays of their own.
constexpr int rays_without_record = 64;

struct PixelTile {
  int left, top, right, bottom;
};

// A sample of a pixel.
struct EyeSample {
  Eigen::Index pixel = 0;
  std::uint32_t index = 0;
};

struct EyeSamples {
  std::vector<EyeSample> all;
  std::vector<Ray> rays;
  std::vector<std::size_t> of_rays;  // the sample of each; beyond the edge of a fisheye's picture there is no ray
};

// What each sample of a batch brings, and how far it may be off by the records.
struct Brought {
  Field radiance;
  Eigen::VectorXd deviation;
  Eigen::VectorXd outlook;
};

// Tells an observer of a part of a stage.
Observer part_of(const Observer& observer, double from, double to) {
  if (!observer) return {};
  return [&observer, from, to](const Progress& progress) {
    Progress all = progress;
    all.fraction = from + (to - from) * progress.fraction;
    return observer(all);
  };
}

class FinalGather {
 public:
  FinalGather(const SolvedLight& solved, const SmoothField& radiance, const Lens& lens,
              const FinalGatherOptions& options);

  void place_records(const Observer& observer);
  void take_samples(const std::vector<std::uint32_t>& counts, const Observer& observer);
  std::vector<std::uint32_t> wanted(std::uint32_t most) const;
  void see_layers();
  Image image() const;
  double error_of(const Image& image) const { return mean_relative_error(pixels_, image.error); }

 private:
  struct Candidate {
    PatchPoint at;
    bool other_side = false;
    double pixel_width = 0;
  };
  std::vector<Candidate> candidates_in_row(int y, int stride) const;
  std::vector<Candidate> apart(const std::vector<Candidate>& all) const;
  EyeSamples eye_samples(const PixelTile& tile, const std::vector<std::uint32_t>& counts) const;
  Brought brought(const EyeSamples& samples) const;
  Spectrum gathered(const PatchPoint& at, const EyeSample& sample, double& deviation) const;
  bool is_plain(PatchIndex patch) const;
  std::optional<PatchIndex> behind(PatchIndex patch) const;
  Eigen::Index index(int x, int y) const { return static_cast<Eigen::Index>(y) * options_.width + x; }

  const SolvedLight& solved_;
  const SmoothField& radiance_;
  const Lens& lens_;
  const FinalGatherOptions& options_;
  GatheredLight gather_;
  std::vector<SeenSphere> spheres_;
  IrradianceCache cache_;
  std::vector<PixelTile> tiles_;
  std::vector<PixelSamples> pixels_;
  Eigen::VectorXd deviations_;  // sums over samples of what records may be off
  Image sums_;
};

FinalGather::FinalGather(const SolvedLight& solved, const SmoothField& radiance, const Lens& lens,
                         const FinalGatherOptions& options)
    : solved_(solved),
      radiance_(radiance),
      lens_(lens),
      options_(options),
      gather_(solved),
      spheres_(spheres_of(solved.lights.lighting.luminaires)),
      cache_(solved.luminous_weights) {
  for (int top = 0; top < options.height; top += gather_tile_edge)
    for (int left = 0; left < options.width; left += gather_tile_edge)
      tiles_.push_back({left, top, std::min(left + gather_tile_edge, options.width),
                        std::min(top + gather_tile_edge, options.height)});
  const Eigen::Index count = static_cast<Eigen::Index>(options.width) * options.height;
  pixels_.resize(static_cast<std::size_t>(count));
  deviations_ = Eigen::VectorXd::Zero(count);
  sums_ = {options.width, options.height, Field::Zero(count, solved.exitance.cols()), Eigen::VectorXd::Zero(count)};
  sums_.patch.assign(static_cast<std::size_t>(count), -1);
  sums_.depth = Eigen::VectorXd::Constant(count, std::numeric_limits<double>::infinity());
  sums_.normal = Field::Zero(count, 3);
}

// False where only the solution knows what is scattered: at clear faces and mirrors.
bool FinalGather::is_plain(PatchIndex patch) const {
  return solved_.occluder.specular_faces().at(solved_.mesh.polygon[patch]) == nullptr;
}

// The patch on the other side of a sheet.
std::optional<PatchIndex> FinalGather::behind(PatchIndex patch) const {
  if (solved_.other_side.empty() || solved_.other_side[patch] == patch) return std::nullopt;
  return solved_.other_side[patch];
}

// Points of every so many pixels that the records there are do not serve.
std::vector<FinalGather::Candidate> FinalGather::candidates_in_row(int y, int stride) const {
  std::vector<Ray> rays;
  for (int x = stride / 2; x < options_.width; x += stride) {
    const auto ray = lens_.ray(x + 0.5, y + 0.5);
    if (ray) rays.push_back(*ray);
  }
  std::vector<Candidate> wanted;
  const auto add = [&](const PatchPoint& at, double distance) {
    if ((solved_.reflectance.row(at.patch) == 0).all()) return;
    if (cache_.weight_at(at.point, solved_.mesh.normal[at.patch]) < enough_weight)
      wanted.push_back({at, false, lens_.pixel_width(distance)});
  };
  for (const SeenPatch& seen : seen_by(solved_.occluder, gather_.lookup(), rays, spheres_)) {
    if (!seen.patch || !is_plain(*seen.patch)) continue;
    add({seen.point, *seen.patch}, seen.distance);
    if (const auto other = behind(*seen.patch)) add({seen.point, *other}, seen.distance);
  }
  return wanted;
}

// Of several that would serve the same pixels the first.
std::vector<FinalGather::Candidate> FinalGather::apart(const std::vector<Candidate>& all) const {
  // Only where these would serve counts.
  const Eigen::Index bands = solved_.luminous_weights.size();
  const Spectrum no_light = Spectrum::Zero(bands);
  const Field no_slope = Field::Zero(3, bands);
  IrradianceCache taken(solved_.luminous_weights);
  std::vector<Candidate> some;
  for (const Candidate& one : all) {
    const Vector& normal = solved_.mesh.normal[one.at.patch];
    if (taken.weight_at(one.at.point, normal) > 0) continue;
    taken.add({one.at.point, normal, least_pixels * one.pixel_width / 2, no_light, no_slope, 0});
    some.push_back(one);
  }
  return some;
}

void FinalGather::place_records(const Observer& observer) {
  const int strides = std::countr_zero(static_cast<unsigned>(first_stride / last_stride)) + 1;
  for (int k = 0; k < strides; ++k) {
    const int stride = first_stride >> k;
    const int rows = (options_.height - stride / 2 + stride - 1) / stride;
    std::vector<std::vector<Candidate>> found(static_cast<std::size_t>(std::max(0, rows)));
    parallel_for(found.size(), [&](std::size_t row) {
      found[row] = candidates_in_row(static_cast<int>(row) * stride + stride / 2, stride);
    });
    std::vector<Candidate> all;
    for (const auto& row : found) all.insert(all.end(), row.begin(), row.end());
    all = apart(all);
    std::vector<IrradianceRecord> records(all.size());
    const double part = 1.0 / strides;
    parallel_for(all.size(), Stage::render, part_of(observer, k * part, (k + 1) * part), [&](std::size_t n) {
      const Candidate& one = all[n];
      records[n] =
          gather_.record_at(one.at, hash({options_.seed, static_cast<std::uint64_t>(stride), n}),
                            least_pixels * one.pixel_width, most_pixels * one.pixel_width, options_.hemisphere);
    });
    cache_.add_graded(records);
  }
}

EyeSamples FinalGather::eye_samples(const PixelTile& tile, const std::vector<std::uint32_t>& counts) const {
  EyeSamples samples;
  for (int y = tile.top; y < tile.bottom; ++y) {
    for (int x = tile.left; x < tile.right; ++x) {
      const Eigen::Index pixel = index(x, y);
      const std::uint32_t end = counts[static_cast<std::size_t>(pixel)];
      for (std::uint32_t k = pixels_[static_cast<std::size_t>(pixel)].count(); k < end; ++k) {
        const auto u = pixel_sample(k, hash({options_.seed, static_cast<std::uint64_t>(pixel), 1}));
        const auto ray = lens_.ray(x + 0.5 + tent(u[0]), y + 0.5 + tent(u[1]));
        samples.all.push_back({pixel, k});
        if (!ray) continue;
        samples.rays.push_back(*ray);
        samples.of_rays.push_back(samples.all.size() - 1);
      }
    }
  }
  return samples;
}

// The irradiance by other patches, from the records around or by rays of its own.
Spectrum FinalGather::gathered(const PatchPoint& at, const EyeSample& sample, double& deviation) const {
  if (const auto cached = cache_.at(at.point, solved_.mesh.normal[at.patch])) {
    deviation = cached->deviation;
    return cached->irradiance;
  }
  HemisphereOptions few = options_.hemisphere;
  few.rays = rays_without_record;
  const auto key = hash({options_.seed, static_cast<std::uint64_t>(sample.pixel), sample.index, 2});
  const IrradianceRecord own = gather_.record_at(at, key, 1, 1, few);
  deviation = 0;  // its scatter is that of samples
  return own.irradiance;
}

Brought FinalGather::brought(const EyeSamples& samples) const {
  const auto count = static_cast<Eigen::Index>(samples.all.size());
  const Eigen::Index bands = solved_.exitance.cols();
  Brought all{Field::Zero(count, bands), Eigen::VectorXd::Zero(count), Eigen::VectorXd::Zero(count)};

  // 1. Points that are seen, and both of their sides where they are of sheets
  struct Lit {
    std::size_t sample;
    PatchPoint at;
    Spectrum factor;  // of the irradiance in the radiance that is seen
  };
  std::vector<Lit> lit;
  std::vector<LitPoint> points;
  std::map<PatchIndex, SkyAim> aims;
  const auto add = [&](const SeenPatch& seen, PatchIndex patch, const Spectrum& factor) {
    if (!(factor > 0).any()) return;
    const EyeSample& sample = samples.all[samples.of_rays[seen.ray]];
    lit.push_back({samples.of_rays[seen.ray], {seen.point, patch}, factor});
    const SkyAim* aim = nullptr;
    if (solved_.lights.lighting.sky) {
      auto place = aims.find(patch);
      if (place == aims.end()) place = aims.emplace(patch, gather_.aim_at(patch)).first;
      aim = &place->second;
    }
    const SurfacePoint at{seen.point, solved_.mesh.normal[patch], solved_.mesh.polygon[patch]};
    points.push_back({at, sample.index, hash({options_.seed, static_cast<std::uint64_t>(sample.pixel), 3}), aim});
  };
  for (const SeenPatch& seen : seen_by(solved_.occluder, gather_.lookup(), samples.rays, spheres_)) {
    const auto ray = static_cast<Eigen::Index>(samples.of_rays[seen.ray]);
    if (seen.outlook) all.outlook[ray] += seen.share;
    if (seen.sphere != nullptr) {
      all.radiance.row(ray) += seen.share * seen.sphere->radiance;
      continue;
    }
    if (!seen.patch) {
      if (options_.surroundings) all.radiance.row(ray) += seen.share * options_.surroundings(seen.direction);
      continue;
    }
    const PatchIndex patch = *seen.patch;
    if (!is_plain(patch)) {
      all.radiance.row(ray) += seen.share * value_at(solved_.mesh, radiance_, solved_.occluder, patch, seen.point);
      continue;
    }
    // L = (E + rho H + t H_behind) / pi
    const double share = seen.share / std::numbers::pi;
    all.radiance.row(ray) += share * solved_.exitance.row(patch);
    add(seen, patch, share * reflectance_at(solved_, patch, seen.point));
    if (const auto other = behind(patch)) add(seen, *other, share * solved_.transmittance.row(patch));
  }

  // 2. Their light
  const Field direct = light_samples(solved_.lights, points, rays_to_lights);
  for (std::size_t k = 0; k < lit.size(); ++k) {
    double deviation = 0;
    const auto row = static_cast<Eigen::Index>(lit[k].sample);
    const Spectrum irradiance =
        direct.row(static_cast<Eigen::Index>(k)) + gathered(lit[k].at, samples.all[lit[k].sample], deviation);
    all.radiance.row(row) += lit[k].factor * irradiance;
    all.deviation[row] += deviation * lit[k].factor.maxCoeff();
  }
  return all;
}

// Samples up to a count of each pixel.
void FinalGather::take_samples(const std::vector<std::uint32_t>& counts, const Observer& observer) {
  parallel_for(tiles_.size(), Stage::render, observer, [&](std::size_t t) {
    const EyeSamples samples = eye_samples(tiles_[t], counts);
    if (samples.all.empty()) return;
    const Brought found = brought(samples);
    for (std::size_t k = 0; k < samples.all.size(); ++k) {
      const Eigen::Index at = samples.all[k].pixel;
      const auto row = static_cast<Eigen::Index>(k);
      PixelSamples& pixel = pixels_[static_cast<std::size_t>(at)];
      pixel.extend(counts[static_cast<std::size_t>(at)]);
      pixel.add((found.radiance.row(row).matrix() * solved_.luminous_weights).value());
      deviations_[at] += found.deviation[row];
      sums_.pixels.row(at) += found.radiance.row(row);
      sums_.outlook[at] += found.outlook[row];
    }
  });
}

std::vector<std::uint32_t> FinalGather::wanted(std::uint32_t most) const {
  const auto limit = std::min(most, static_cast<std::uint32_t>(options_.most_samples));
  return wanted_samples(pixels_, options_.width, options_.error, limit);
}

// What the middle of each pixel shows.
void FinalGather::see_layers() {
  parallel_for(tiles_.size(), [&](std::size_t t) {
    const PixelTile& tile = tiles_[t];
    std::vector<Ray> rays;
    std::vector<Eigen::Index> at;
    for (int y = tile.top; y < tile.bottom; ++y) {
      for (int x = tile.left; x < tile.right; ++x) {
        const auto ray = lens_.ray(x + 0.5, y + 0.5);
        if (!ray) continue;
        rays.push_back(*ray);
        at.push_back(index(x, y));
      }
    }
    for (const SeenPatch& seen : seen_by(solved_.occluder, gather_.lookup(), rays, spheres_)) {
      const Eigen::Index pixel = at[seen.ray];
      // The first on the way of a ray comes first.
      if (!seen.patch || sums_.patch[static_cast<std::size_t>(pixel)] >= 0) continue;
      sums_.patch[static_cast<std::size_t>(pixel)] = *seen.patch;
      sums_.depth[pixel] = seen.distance;
      sums_.normal.row(pixel) = solved_.mesh.normal[*seen.patch].transpose();
    }
  });
}

Image FinalGather::image() const {
  Image image = sums_;
  const Eigen::VectorXd variances = pooled_variances(pixels_, options_.width);
  image.error = Eigen::VectorXd(variances.size());
  for (Eigen::Index k = 0; k < variances.size(); ++k) {
    const double samples = pixels_[static_cast<std::size_t>(k)].count();
    image.pixels.row(k) /= samples;
    image.outlook[k] /= samples;
    image.error[k] = std::hypot(std::sqrt(variances[k]), deviations_[k] / samples);
  }
  return image;
}

}  // namespace

GatheredImage final_gather(const SolvedLight& solved, const SmoothField& radiance, const Lens& lens,
                           const FinalGatherOptions& options, const Observer& observer) {
  FinalGather gather(solved, radiance, lens, options);
  // 1. Records of the light from other patches
  gather.place_records(part_of(observer, 0, 0.4));
  // 2. Some samples of all pixels
  const std::vector<std::uint32_t> first(
      static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height), first_samples);
  gather.take_samples(first, part_of(observer, 0.4, 0.6));
  gather.see_layers();
  // 3. More where they differ; twice, as few samples tell little of how many are wanted, and nothing of what more gain
  bool unfinished = false;
  try {
    gather.take_samples(gather.wanted(next_samples), part_of(observer, 0.6, 0.75));
    gather.take_samples(gather.wanted(static_cast<std::uint32_t>(options.most_samples)), part_of(observer, 0.75, 1));
  } catch (const Cancelled&) {
    unfinished = true;
  }
  Image image = gather.image();
  const double error = gather.error_of(image);
  return {std::move(image), unfinished, error};
}

}  // namespace patchlight
