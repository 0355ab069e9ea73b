#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/render/image.h"

#include "render/gathered_light.h"
#include "render/lens.h"
#include "render/smooth.h"

#include <cstdint>
#include <functional>
#include <optional>

namespace patchlight {

/// Size and accuracy of a picture.
struct FinalGatherOptions {
  int width = 800;
  int height = 800;
  double error = 0.01;    ///< wanted standard error of a pixel's luminance, PictureOptions::error
  int most_samples = 64;  ///< of a pixel, a power of two and at least 4
  HemisphereOptions hemisphere = {};
  std::uint32_t seed = 1;
  std::function<Spectrum(const Vector&)> surroundings = {};  ///< radiance where nothing is met; none: black
};

/// What was gathered by the time that the observer stopped.
struct GatheredImage {
  Image image;
  bool unfinished = false;
  std::optional<double> error = {};  ///< mean_relative_error() of a finished or unfinished gather; a draft has none
};

/// A picture of the light that points get, by two passes (Wallace, Cohen and Greenberg 1987): each point that the eye
/// meets, straight, in mirrors and through clear faces, takes light of lamps, luminaires, sun and sky by shadow rays,
/// and all other light from the solution, gathered at records between which it is interpolated (IrradianceCache). What
/// mirrors and clear faces scatter themselves is `radiance`, that of the smoothed solution.
///
/// Pixels take stratified samples under a tent filter: first 4 each, then as many as the wanted error asks for. Sets
/// Image::error from how far pairs of samples differ, in a pixel and those around, and from what records differ. Same
/// bits for any number of threads. \throws Cancelled as long as there is no picture.
GatheredImage final_gather(const SolvedLight& solved, const SmoothField& radiance, const Lens& lens,
                           const FinalGatherOptions& options = {}, const Observer& observer = {});

}  // namespace patchlight
