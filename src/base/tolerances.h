#pragma once

/// The lengths and shares at which two things count as one. Code that needs another length gives the reason.
namespace patchlight {

/// Numbers that are equal but for the rounding of a few operations in double precision, relative to their size.
inline constexpr double tolerance_of_arithmetic = 1e-12;

/// Lengths and coordinates that are equal but for the rounding of a whole computation, relative to the shape at hand.
inline constexpr double tolerance_of_shapes = 1e-9;

/// Coordinates that files write with six digits or rays have in single precision, relative to the scene's extent.
inline constexpr double tolerance_of_coordinates = 1e-6;

/// Lengths of one scene, meters.
struct Tolerances {
  /// `extent`: the diagonal of the scene's bounding box, meters.
  explicit Tolerances(double extent)
      : in_plane(tolerance_of_shapes * extent), weld(tolerance_of_coordinates * extent) {}

  double in_plane;  ///< a point nearer to a plane lies in it, for coordinates in double precision
  double weld;      ///< vertices nearer than this are one; rays start this far off their surface
};

}  // namespace patchlight
