#pragma once

#include "patchlight/scene/scene.h"

#include "input/radiance_text.h"

#include <string>
#include <vector>

namespace patchlight {

/// Light from far away, from the disk that Radiance's source subtends on the sphere of directions.
struct FarSource {
  std::string name;
  Vector direction;          ///< unit, towards it
  double degrees = 0;        ///< across the disk
  Spectrum radiance{};       ///< W/(m^2 sr)
  bool has_pattern = false;  ///< the radiance varies over it
};

/// A source primitive, turned by `turn`; its radiance is left open. \throws InputError at `where`: it has no four
/// numbers, no direction or no angle.
FarSource far_source(const RadiancePrimitive& primitive, const Eigen::Matrix3d& turn, const std::string& where);

/// The scene with what can be carried: the first disk up to 5 degrees across is the sun, even half spheres above and
/// below are an even sky and the ground. Notes name the others, and what to do for a sky.
Scene with_far_sources(Scene scene, const std::vector<FarSource>& sources);

}  // namespace patchlight
