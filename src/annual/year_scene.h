#pragma once

#include "patchlight/annual/annual.h"

#include "lighting/sky_divisions.h"

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace patchlight {

/// The illuminance of the open horizontal under the sky of the reference scene, lx.
inline constexpr double reference_illuminance = 10'000;

/// A scene under a CIE overcast sky of reference_illuminance, without other light. Bands in which no material differs
/// are one. Band::luminous_weight is the share of a band in the illuminance by the sky of the year, and
/// `sun_weights` that by its sun; both sum up to 1: what light of 1 lx gives, band by band, adds up to lux.
struct YearScene {
  Scene scene;
  std::vector<double> sun_weights;
};

/// \throws InputError when the year has no light, or suns or skies of several colors.
YearScene scene_of_year(const Scene& scene, const Year& year);

/// The suns of a year above the horizon.
struct SunsOfYear {
  std::vector<std::size_t> hours;
  std::vector<Vector> directions;
  Eigen::VectorXf illuminance;  ///< normal, lx
};

SunsOfYear suns_of(const Year& year, const Scene& scene);

/// The mean luminances of the divisions (rows) in the hours with a sky (columns), cd/m^2. The sky is such that the
/// integral over all divisions gives its horizontal illuminance.
struct SkiesOfYear {
  std::vector<std::size_t> hours;
  Eigen::MatrixXf luminance;
};

SkiesOfYear skies_of(const Year& year, const Scene& scene, const SkyDivisions& divisions, const Observer& observer);

/// The luminances of a sky, like a column of these; `horizontal` and `ground` in lx and cd/m^2.
Eigen::VectorXf luminances_of(const Sky& sky, double horizontal, double ground, const SkyDivisions& divisions,
                              const Vector& up);

}  // namespace patchlight
