#pragma once

/// The lengths and shares at which two things count as one. Code that needs another length gives the reason.
namespace patchlight {

/// The rounding of a few operations in double precision, relative to the size of the numbers.
inline constexpr double tolerance_of_arithmetic = 1e-12;

/// The rounding of a whole computation in double precision, relative to the size of the shape or number at hand.
inline constexpr double tolerance_of_shapes = 1e-9;

/// The rounding of numbers with six digits, as in files, or in single precision, e.g. of rays: relative to the scene's
/// extent or to the number. Vertices merge within weld_distance(), which may be smaller.
inline constexpr double tolerance_of_coordinates = 1e-6;

}  // namespace patchlight
