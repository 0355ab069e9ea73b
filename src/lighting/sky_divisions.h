#pragma once

#include "patchlight/base/geometry.h"

#include <array>
#include <cstddef>
#include <vector>

namespace patchlight {

/// The sky cut into divisions that look about alike in size, and the ground below the horizon as one more. Tregenza's
/// 145 (1987): seven rows of 12 degrees with 30, 30, 24, 24, 18, 12 and 6 divisions, and a cap around the zenith.
/// Reinhart (2001) cuts each row and each division `factor` times, so that the cap is the same share of a row: factor^2
/// times 144, and 1. In the order of Radiance: 0 is the ground, 1 stands at the horizon in the north, then row by row
/// clockwise as seen from above, the cap last.
class SkyDivisions {
 public:
  /// `up` and `north` are unit vectors at right angles.
  SkyDivisions(int factor, const Vector& up, const Vector& north);

  int factor() const { return factor_; }

  /// The same sky cut by another factor.
  SkyDivisions cut(int factor) const { return SkyDivisions(factor, up_, north_); }

  /// With the ground.
  std::size_t size() const { return first_of_row_.back() + 1; }
  /// The division of a unit direction.
  std::size_t at(const Vector& direction) const;
  /// sr; 2 pi of the ground. The other ones sum up to 2 pi.
  double solid_angle(std::size_t division) const;
  /// Directions in the middle of `across` x `across` parts of equal solid angle of a division of the sky.
  std::vector<Vector> directions(std::size_t division, int across) const;

 private:
  struct Place {
    std::size_t row = 0;
    std::size_t in_row = 0;
  };
  Place place_of(std::size_t division) const;
  double sine_at_foot(std::size_t row) const;
  std::size_t count_in(std::size_t row) const { return first_of_row_[row + 1] - first_of_row_[row]; }

  int factor_;
  Vector up_, north_, east_;
  std::vector<std::size_t> first_of_row_;  // divisions; one more at the end: that of all, without the cap
};

}  // namespace patchlight
