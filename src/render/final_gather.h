#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/render/image.h"

#include "render/camera.h"
#include "render/gathered_light.h"
#include "render/render.h"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace patchlight {

/// The luminances of a pixel's samples, in order, as sums over their four quarters. So the variance includes the gain
/// from the stratification of each quarter.
class PixelSamples {
 public:
  /// Reserves `count` samples in total, a power of two from 4 up. Existing samples are the first of them.
  void extend(std::uint32_t count);
  void add(double luminance);

  std::uint32_t count() const { return count_; }  ///< of those added
  double mean() const;

  /// The variance of one sample: the variance of the mean times the number of samples, without the gain from
  /// stratification. All samples that extend() reserved must be present.
  double variance() const;

 private:
  std::uint32_t count_ = 0, room_ = 4;
  std::array<double, 4> quarters_{};
};

/// The variances of the means of pixels, row by row of `width`. They pool a pixel with its neighbors, each relative to
/// its own reference_luminances(), as the variance of few samples may be too small by chance. So a dark pixel beside a
/// lamp does not take over the variance of the lamp.
Eigen::VectorXd pooled_variances(const std::vector<PixelSamples>& pixels, int width);

/// The root mean square over the pixels of their standard errors, each relative to its reference_luminances(); 0 where
/// no pixel is lit.
double mean_relative_error(const std::vector<PixelSamples>& pixels, const Eigen::VectorXd& errors);

/// The number of samples of each pixel for which its mean has the requested standard error, relative to its
/// reference_luminances(). Powers of two, up to `most`, not below the present number.
std::vector<std::uint32_t> wanted_samples(const std::vector<PixelSamples>& pixels, int width, double error,
                                          std::uint32_t most);

/// Size and accuracy of a picture.
struct FinalGatherOptions {
  int width = 800;
  int height = 800;
  double error = 0.01;    ///< requested standard error of a pixel's luminance, PictureOptions::error
  int most_samples = 64;  ///< of a pixel, a power of two and at least 4
  HemisphereOptions hemisphere = {};
  std::uint32_t seed = 1;
  std::function<Spectrum(const Vector&)> surroundings = {};  ///< radiance where nothing is met; none: black
};

/// The picture, or as much of it as there was when the observer stopped.
struct GatheredImage {
  Image image;
  bool unfinished = false;
  std::optional<double> error = {};  ///< mean_relative_error() of a finished or unfinished gather; a draft has none
};

/// A picture of the light that points receive, in two passes (Wallace, Cohen and Greenberg 1987). For each visible
/// point, directly, in mirrors and through clear faces, shadow rays compute the light of lamps, luminaires, sun and
/// sky. All other light comes from the solution: it is gathered at records and interpolated between them
/// (IrradianceCache). `radiance`, from the smoothed solution, gives the light that mirrors and clear faces scatter
/// themselves.
///
/// Pixels take stratified samples under a tent filter: first 4 each, then as many as the requested error needs.
/// Image::error comes from the differences between pairs of samples, in a pixel and its neighbors, and between records.
/// The result does not depend on the number of threads. \throws Canceled before there is a picture.
GatheredImage final_gather(const SolvedLight& solved, const SmoothField& radiance, const Lens& lens,
                           const FinalGatherOptions& options = {}, const Observer& observer = {});

}  // namespace patchlight
