#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace patchlight {

/// The luminances of a pixel's samples, in order: sums over four quarters of them, so that the variance tells what the
/// stratification of each quarter gains.
class PixelSamples {
 public:
  /// Makes room for `count` samples in all, a power of two from 4 up, of which those there are the first.
  void extend(std::uint32_t count);
  void add(double luminance);

  std::uint32_t count() const { return count_; }  ///< of those added
  double mean() const;

  /// Of one sample, if there were nothing to gain from several: the variance of the mean times their number. All that
  /// extend() made room for must be there.
  double variance() const;

 private:
  std::uint32_t count_ = 0, room_ = 4;
  std::array<double, 4> quarters_{};
};

/// What the error of each pixel is relative to: its mean, or a twentieth of what nine of ten pixels stay below; 0 where
/// no pixel is lit.
Eigen::VectorXd reference_luminances(const std::vector<PixelSamples>& pixels);

/// The variances of the means of pixels, row by row of `width`: from their own and those around, each relative to its
/// own reference_luminances(), as that of few samples is small by chance. Beside a lamp a dark pixel takes no share of
/// the lamp's variance that its own luminance does not call for.
Eigen::VectorXd pooled_variances(const std::vector<PixelSamples>& pixels, int width);

/// The root mean square over the pixels of their standard errors, each relative to its reference_luminances(); 0 where
/// no pixel is lit.
double mean_relative_error(const std::vector<PixelSamples>& pixels, const Eigen::VectorXd& errors);

/// How many samples each pixel should have, so that its mean has the wanted standard error, relative to its
/// reference_luminances(): powers of two, up to `most`; at least as many as are there.
std::vector<std::uint32_t> wanted_samples(const std::vector<PixelSamples>& pixels, int width, double error,
                                          std::uint32_t most);

}  // namespace patchlight
