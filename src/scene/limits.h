#pragma once

#include "patchlight/scene/scene.h"

#include <string>

namespace patchlight {

/// Rays are traced in single precision in a scene of unit extent: beyond so many extents a ray cannot be told from a
/// parallel one, and beyond 1e18 there is none.
inline constexpr double most_extents = 1e12;

/// How far a position may be from the middle of a scene: most_extents of its main_bounds().
struct Reach {
  Point centre;
  double distance = 0;  ///< m
};

/// How far a scene reaches, which must have faces.
Reach reach_of(const Scene& scene);

/// \throws InputError at `where` when a position in metres is out of reach; the message calls it `what`.
void require_in_reach(const Reach& reach, const Point& position, const std::string& where, const std::string& what);

/// Checks every position and every strength of light of a scene besides its vertices. Light up to 1e25 (W/m^2, W/sr or
/// W) leaves results that single precision can write; the sun's surface has 6e7. The squares of light from 1e-150 on
/// are normal numbers. \throws InputError naming the value that is out of range.
void check_limits(const Scene& scene);

}  // namespace patchlight
