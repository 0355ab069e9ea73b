#pragma once

#include "patchlight/base/field.h"
#include "patchlight/light/spectrum.h"
#include "patchlight/render/image.h"

#include <array>
#include <cstdint>
#include <vector>

namespace patchlight {

/// A radiance as linear RGB with Rec. 709 primaries, by the color of each band.
std::array<double, 3> linear_rgb(const Spectrum& radiance, const Bands& bands);

/// Scale that maps radiance in W/(m^2 sr) to display values: the 90th percentile, by weight, of the luminances above 0
/// becomes 0.7 of the display's white. `weight` has one entry per row: the area of a patch, or 1 per pixel. 1 when all
/// is dark.
double exposure_for(const FieldView& radiance, const Eigen::VectorXd& weight, const Bands& bands);

/// Exposes linear radiance, one row each, rolls highlights off above 0.8 of white, and encodes as sRGB. Each band
/// adds its color (Band::rgb).
std::vector<std::array<std::uint8_t, 3>> tone_map(const FieldView& radiance, double exposure, const Bands& bands);

/// The value below which a share of the values lies; there must be some.
double quantile(std::vector<double> values, double share);

/// The mean of the values of each pixel and those around it, up to `reach` pixels in rows and columns of `width`.
Eigen::VectorXd box_means(const Eigen::VectorXd& values, int width, int reach);

/// True where anything of a weight above 0 is lit.
bool is_lit(const FieldView& radiance, const Eigen::VectorXd& weight);

/// The image with black pixels where the values of its pixels, smoothed over 5 by 5, cross one of some levels; not
/// where they jump by more than a third, at edges of things.
DisplayImage with_isolines(DisplayImage image, const Eigen::VectorXd& values, const std::vector<double>& levels);

/// False colors of one value per row, from blue (lower) over green and yellow to red (upper).
std::vector<std::array<std::uint8_t, 3>> false_color(const Eigen::VectorXd& values, double lower, double upper);

}  // namespace patchlight
