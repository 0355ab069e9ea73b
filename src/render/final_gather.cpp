#include "render/final_gather.h"

#include "patchlight/base/error.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "base/streams.h"
#include "render/tone_map.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

namespace patchlight {
namespace {

// Reports a part of a stage to an observer, which is copied, as the fractions from one to another of the stage.
Observer part_of_stage(const Observer& observer, double from, double to) {
  if (!observer) return {};
  return [observer, from, to](const Progress& progress) {
    Progress all = progress;
    all.fraction = from + (to - from) * progress.fraction;
    return observer(all);
  };
}

// A twentieth of the luminance that nine of ten lit pixels stay below: the errors of darker pixels are relative to it.
double least_luminance(const std::vector<PixelSamples>& pixels) {
  std::vector<double> values;
  for (const PixelSamples& pixel : pixels) {
    if (pixel.mean() > 0) values.push_back(pixel.mean());
  }
  return values.empty() ? 0 : 0.05 * quantile(std::move(values), 0.9);
}

// The luminance that the error of each pixel is relative to: its mean, or least_luminance(); 0 where no pixel is lit.
Eigen::VectorXd reference_luminances(const std::vector<PixelSamples>& pixels) {
  const double least = least_luminance(pixels);
  Eigen::VectorXd references(static_cast<Eigen::Index>(pixels.size()));
  for (std::size_t k = 0; k < pixels.size(); ++k)
    references[static_cast<Eigen::Index>(k)] = std::max(least, pixels[k].mean());
  return references;
}

struct PictureView {
  const SolvedLight& solved;
  const GatheredLight& gather;
  const std::vector<SeenLuminaire>& luminaires;
  const Lens& lens;
};

// Strides, in pixels, at which records are placed, from coarse to fine.
constexpr int first_stride = 32;
constexpr int last_stride = 2;

// The least number of pixels around a record that it serves.
constexpr double least_pixels = 3;

struct Candidate {
  PatchPoint at;
  double pixel_width = 0;
};

// Points of every so many pixels of a row.
std::vector<Candidate> seen_in_row(const PictureView& view, int width, int y, int stride) {
  std::vector<Ray> rays;
  for (int x = stride / 2; x < width; x += stride) {
    const auto ray = view.lens.ray(x + 0.5, y + 0.5);
    if (ray) rays.push_back(*ray);
  }
  std::vector<Candidate> all;
  for (const SeenPatch& seen :
       seen_by(view.solved.occluder, optics_of(view.solved), view.gather.lookup(), rays, {}, view.luminaires)) {
    if (!seen.patch || !is_plain(view.solved, *seen.patch)) continue;
    const double pixel_width = view.lens.pixel_width(seen.distance);
    all.push_back({{seen.point, *seen.patch}, pixel_width});
    if (const auto other = behind(view.solved, *seen.patch)) all.push_back({{seen.point, *other}, pixel_width});
  }
  return all;
}

// Those that the records there are do not serve.
std::vector<Candidate> not_served(std::vector<Candidate> candidates, const SolvedLight& solved,
                                  const IrradianceCache& records) {
  std::erase_if(candidates, [&](const Candidate& one) {
    return (solved.reflectance.row(one.at.patch) == 0).all() ||
           records.weight_at(one.at.point, solved.mesh.normal[one.at.patch]) >= 0.35;
  });
  return candidates;
}

// The first of several candidates that would serve the same pixels.
std::vector<Candidate> apart(const std::vector<Candidate>& all, const SolvedLight& solved) {
  // Only where these would serve counts.
  const Eigen::Index bands = solved.luminous_weights.size();
  const Spectrum no_light = Spectrum::Zero(bands);
  const Field no_slope = Field::Zero(3, bands);
  IrradianceCache taken(solved.luminous_weights);
  std::vector<Candidate> some;
  for (const Candidate& one : all) {
    const Vector& normal = solved.mesh.normal[one.at.patch];
    if (taken.weight_at(one.at.point, normal) > 0) continue;
    taken.add({one.at.point, normal, least_pixels * one.pixel_width / 2, no_light, no_slope, 0});
    some.push_back(one);
  }
  return some;
}

std::vector<Candidate> candidates(const PictureView& view, const FinalGatherOptions& options, int stride,
                                  const IrradianceCache& records) {
  const int rows = (options.height - stride / 2 + stride - 1) / stride;
  std::vector<std::vector<Candidate>> found(static_cast<std::size_t>(std::max(0, rows)));
  parallel_for(found.size(), [&](std::size_t row) {
    const int y = static_cast<int>(row) * stride + stride / 2;
    found[row] = not_served(seen_in_row(view, options.width, y, stride), view.solved, records);
  });
  std::vector<Candidate> all;
  for (const auto& row : found) all.insert(all.end(), row.begin(), row.end());
  return apart(all, view.solved);
}

// Records of the light from other patches where a picture sees patches that reflect: first far from each other, then
// closer where those that are there serve too little. Same bits for any number of threads. Throws Canceled.
IrradianceCache gathered_records(const PictureView& view, const FinalGatherOptions& options, const Observer& observer) {
  IrradianceCache records(view.solved.luminous_weights);
  const int strides = std::countr_zero(static_cast<unsigned>(first_stride / last_stride)) + 1;
  for (int k = 0; k < strides; ++k) {
    const int stride = first_stride >> k;
    const std::vector<Candidate> wanted = candidates(view, options, stride, records);
    std::vector<IrradianceRecord> gathered(wanted.size());
    const double part = 1.0 / strides;
    parallel_for(wanted.size(), Stage::render, part_of_stage(observer, k * part, (k + 1) * part), [&](std::size_t n) {
      const Candidate& one = wanted[n];
      gathered[n] = view.gather.record_at(one.at, hash({options.seed, static_cast<std::uint64_t>(stride), n}),
                                          least_pixels * one.pixel_width, 64 * one.pixel_width, options.hemisphere);
    });
    records.add_graded(gathered);
  }
  return records;
}

// A sample of a pixel.
struct EyeSample {
  Eigen::Index pixel = 0;
  std::uint32_t index = 0;
};

struct EyeSamples {
  std::vector<EyeSample> all;
  std::vector<Ray> rays;
  std::vector<std::uint64_t> keys;   // of the rays
  std::vector<std::size_t> of_rays;  // the sample of each; beyond the edge of a fisheye's picture there is no ray
};

// The light that each sample of a batch brings, and how far it may be off by the records.
struct Brought {
  Field radiance;
  Eigen::VectorXd deviation;
  Eigen::VectorXd outlook;
};

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
  struct SeenPoint {
    std::size_t sample;
    PatchPoint at;
    Spectrum factor;  // of the irradiance in the radiance that is seen
  };
  struct Seen {
    Brought brought;
    std::vector<SeenPoint> points;
  };
  EyeSamples eye_samples(const PixelTile& tile, const std::vector<std::uint32_t>& counts) const;
  Seen seen(const EyeSamples& samples) const;
  Field direct(const std::vector<SeenPoint>& seen, const EyeSamples& samples) const;
  Brought brought(const EyeSamples& samples) const;
  CachedIrradiance gathered(const PatchPoint& at, const EyeSample& sample) const;
  Eigen::Index index(int x, int y) const { return static_cast<Eigen::Index>(y) * options_.width + x; }

  const SolvedLight& solved_;
  const SmoothField& radiance_;
  const Lens& lens_;
  const FinalGatherOptions& options_;
  GatheredLight gather_;
  std::vector<SeenLuminaire> luminaires_;
  IrradianceCache records_;
  std::vector<PixelTile> tiles_;
  std::vector<PixelSamples> pixels_;
  Eigen::VectorXd deviations_;  // sums over samples of the errors of records
  Image sums_;
};

FinalGather::FinalGather(const SolvedLight& solved, const SmoothField& radiance, const Lens& lens,
                         const FinalGatherOptions& options)
    : solved_(solved),
      radiance_(radiance),
      lens_(lens),
      options_(options),
      gather_(solved),
      luminaires_(seen_luminaires(solved.lights.lighting().luminaires, solved.lights.lighting().up)),
      records_(solved.luminous_weights),
      tiles_(tiles_of(options.width, options.height)) {
  const Eigen::Index count = static_cast<Eigen::Index>(options.width) * options.height;
  pixels_.resize(static_cast<std::size_t>(count));
  deviations_ = Eigen::VectorXd::Zero(count);
  sums_ = {options.width, options.height, Field::Zero(count, solved.exitance.cols()), Eigen::VectorXd::Zero(count)};
  sums_.patch.assign(static_cast<std::size_t>(count), -1);
  sums_.depth = Eigen::VectorXd::Constant(count, std::numeric_limits<double>::infinity());
  sums_.normal = Field::Zero(count, 3);
}

void FinalGather::place_records(const Observer& observer) {
  records_ = gathered_records({solved_, gather_, luminaires_, lens_}, options_, observer);
}

EyeSamples FinalGather::eye_samples(const PixelTile& tile, const std::vector<std::uint32_t>& counts) const {
  EyeSamples samples;
  for (int y = tile.top; y < tile.bottom; ++y) {
    for (int x = tile.left; x < tile.right; ++x) {
      const Eigen::Index pixel = index(x, y);
      const std::uint32_t end = counts[static_cast<std::size_t>(pixel)];
      for (std::uint32_t k = pixels_[static_cast<std::size_t>(pixel)].count(); k < end; ++k) {
        const auto u = pixel_sample(k, hash({options_.seed, static_cast<std::uint64_t>(pixel), stream::pixel_places}));
        const auto ray = lens_.ray(x + 0.5 + tent(u[0]), y + 0.5 + tent(u[1]));
        samples.all.push_back({pixel, k});
        if (!ray) continue;
        samples.rays.push_back(*ray);
        samples.keys.push_back(hash({options_.seed, static_cast<std::uint64_t>(pixel), k, stream::survival_of_path}));
        samples.of_rays.push_back(samples.all.size() - 1);
      }
    }
  }
  return samples;
}

// The irradiance by other patches, from the records around or by 64 rays of its own, whose scatter is that of samples.
CachedIrradiance FinalGather::gathered(const PatchPoint& at, const EyeSample& sample) const {
  if (const auto cached = records_.at(at.point, solved_.mesh.normal[at.patch])) return *cached;
  HemisphereOptions few = options_.hemisphere;
  few.rays = 64;
  const auto key =
      hash({options_.seed, static_cast<std::uint64_t>(sample.pixel), sample.index, stream::gather_without_record});
  return {gather_.record_at(at, key, 1, 1, few).irradiance, 0};
}

// The light that samples see without the irradiance of points, and these points: on both sides of sheets.
FinalGather::Seen FinalGather::seen(const EyeSamples& samples) const {
  const auto count = static_cast<Eigen::Index>(samples.all.size());
  const Eigen::Index bands = solved_.exitance.cols();
  Seen all{{Field::Zero(count, bands), Eigen::VectorXd::Zero(count), Eigen::VectorXd::Zero(count)}, {}};
  Field& radiance = all.brought.radiance;
  const auto add = [&](const SeenPatch& seen, PatchIndex patch, const Spectrum& factor) {
    if ((factor > 0).any()) all.points.push_back({samples.of_rays[seen.ray], {seen.point, patch}, factor});
  };
  for (const SeenPatch& seen :
       seen_by(solved_.occluder, optics_of(solved_), gather_.lookup(), samples.rays, samples.keys, luminaires_)) {
    const auto ray = static_cast<Eigen::Index>(samples.of_rays[seen.ray]);
    if (seen.outlook) all.brought.outlook[ray] += seen.share.mean();
    if (seen.luminaire != nullptr) {
      radiance.row(ray) += seen.share * seen.luminaire->radiance(-seen.direction);
      continue;
    }
    if (!seen.patch) {
      if (options_.surroundings) radiance.row(ray) += seen.share * options_.surroundings(seen.direction);
      continue;
    }
    const PatchIndex patch = *seen.patch;
    if (!is_plain(solved_, patch)) {
      radiance.row(ray) += seen.share * value_at(solved_.mesh, radiance_, solved_.occluder, patch, seen.point);
      continue;
    }
    // L = (E + rho H + t H_behind) / pi
    const Spectrum share = seen.share / std::numbers::pi;
    radiance.row(ray) += share * solved_.exitance.row(patch);
    add(seen, patch, share * reflectance_at(solved_, patch, seen.point));
    if (const auto other = behind(solved_, patch)) add(seen, *other, share * solved_.transmittance.row(patch));
  }
  return all;
}

// The irradiance of points by lights that shine on them.
Field FinalGather::direct(const std::vector<SeenPoint>& seen, const EyeSamples& samples) const {
  std::vector<LitPoint> points;
  SkyAims aims;
  for (const auto& [sample, at, factor] : seen) {
    const auto& [pixel, index] = samples.all[sample];
    const std::uint32_t seed = hash({options_.seed, static_cast<std::uint64_t>(pixel), stream::lights_of_pixel});
    points.push_back(gather_.lit_point(at, index, seed, aims));
  }
  return light_samples(solved_.lights, points, 4);
}

Brought FinalGather::brought(const EyeSamples& samples) const {
  auto [all, points] = seen(samples);
  const Field light = direct(points, samples);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto& [sample, at, factor] = points[k];
    const auto row = static_cast<Eigen::Index>(sample);
    const CachedIrradiance others = gathered(at, samples.all[sample]);
    const Spectrum irradiance = light.row(static_cast<Eigen::Index>(k)) + others.irradiance;
    all.radiance.row(row) += factor * irradiance;
    all.deviation[row] += others.deviation * factor.maxCoeff();
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

// The patch in the middle of each pixel.
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
    for (const SeenPatch& seen :
         seen_by(solved_.occluder, optics_of(solved_), gather_.lookup(), rays, {}, luminaires_)) {
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

void PixelSamples::extend(std::uint32_t count) {
  assert(std::has_single_bit(count) && count >= room_);
  for (; room_ < count; room_ *= 2) quarters_ = {quarters_[0] + quarters_[1], quarters_[2] + quarters_[3], 0, 0};
}

void PixelSamples::add(double luminance) {
  assert(count_ < room_);
  quarters_[count_ / (room_ / 4)] += luminance;
  ++count_;
}

double PixelSamples::mean() const {
  return (quarters_[0] + quarters_[1] + quarters_[2] + quarters_[3]) / std::max(1U, count_);
}

double PixelSamples::variance() const {
  assert(count_ == room_);
  const double size = room_ / 4.0;
  double sum = 0;
  for (const double quarter : quarters_) sum += std::pow(quarter / size - mean(), 2);
  // The variance of the mean of a quarter is sum / 3; that of the mean of all is a fourth of it.
  return sum / 12 * count_;
}

Eigen::VectorXd pooled_variances(const std::vector<PixelSamples>& pixels, int width) {
  const Eigen::VectorXd references = reference_luminances(pixels);
  Eigen::VectorXd own = Eigen::VectorXd::Zero(references.size());
  for (Eigen::Index k = 0; k < own.size(); ++k) {
    if (references[k] > 0) own[k] = pixels[static_cast<std::size_t>(k)].variance() / (references[k] * references[k]);
  }
  Eigen::VectorXd pooled = box_means(own, width, 1);
  for (Eigen::Index k = 0; k < own.size(); ++k)
    pooled[k] = pooled[k] * references[k] * references[k] / pixels[static_cast<std::size_t>(k)].count();
  return pooled;
}

double mean_relative_error(const std::vector<PixelSamples>& pixels, const Eigen::VectorXd& errors) {
  const Eigen::VectorXd references = reference_luminances(pixels);
  if (!(references.array() > 0).all()) return 0;
  return std::sqrt((errors.array() / references.array()).square().mean());
}

std::vector<std::uint32_t> wanted_samples(const std::vector<PixelSamples>& pixels, int width, double error,
                                          std::uint32_t most) {
  const Eigen::VectorXd variances = pooled_variances(pixels, width);
  const Eigen::VectorXd references = reference_luminances(pixels);
  std::vector<std::uint32_t> wanted;
  for (std::size_t k = 0; k < pixels.size(); ++k) {
    const double allowed = error * references[static_cast<Eigen::Index>(k)];
    const double variance = variances[static_cast<Eigen::Index>(k)];
    const std::uint32_t count = pixels[k].count();
    const double times = variance > 0 ? variance / (allowed * allowed) : 0;
    // In inverse proportion to their number
    wanted.push_back(!(times > 1) || count >= most
                         ? count
                         : std::bit_ceil(static_cast<std::uint32_t>(std::min<double>(most, std::ceil(times * count)))));
  }
  return wanted;
}

GatheredImage final_gather(const SolvedLight& solved, const SmoothField& radiance, const Lens& lens,
                           const FinalGatherOptions& options, const Observer& observer) {
  FinalGather gather(solved, radiance, lens, options);
  // 1. Records of the light from other patches
  gather.place_records(part_of_stage(observer, 0, 0.4));
  // 2. Some samples of all pixels
  const std::vector<std::uint32_t> first(
      static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height), 4);
  gather.take_samples(first, part_of_stage(observer, 0.4, 0.6));
  gather.see_layers();
  // 3. More samples where they differ, in two steps, as few samples give a poor estimate of the number needed
  bool unfinished = false;
  try {
    gather.take_samples(gather.wanted(16), part_of_stage(observer, 0.6, 0.75));
    gather.take_samples(gather.wanted(static_cast<std::uint32_t>(options.most_samples)),
                        part_of_stage(observer, 0.75, 1));
  } catch (const Canceled&) {
    unfinished = true;
  }
  Image image = gather.image();
  const double error = gather.error_of(image);
  return {std::move(image), unfinished, error};
}

}  // namespace patchlight
