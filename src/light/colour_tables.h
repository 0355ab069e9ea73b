#pragma once

#include <array>

namespace patchlight {

/// Values from 380 to 780 nm by 5 nm, and by 10 nm.
using Knots = std::array<double, 81>;
using TenNanometres = std::array<double, 41>;

/// The colour matching functions of the CIE 1931 observer (2 degrees).
extern const Knots observer_x;
extern const Knots observer_y;
extern const Knots observer_z;

/// CIE standard illuminant D65, relative power.
extern const Knots illuminant_d65;

/// The mean of daylight, S_0, and what it varies by, S_1 and S_2: CIE 15:2004, 3.1.
extern const TenNanometres daylight_0;
extern const TenNanometres daylight_1;
extern const TenNanometres daylight_2;

/// Reflectances that sum up to 1 and under D65 have the colours red, green and blue of 1 (Rec. 709).
extern const Knots reflectance_red;
extern const Knots reflectance_green;
extern const Knots reflectance_blue;

}  // namespace patchlight
