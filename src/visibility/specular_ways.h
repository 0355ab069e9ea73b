#pragma once

#include "visibility/occluder.h"

#include <boost/container/small_vector.hpp>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// What a ray does where it has met a polygon.
enum class Onward : std::uint8_t { through, mirrored, ends };

/// Where a ray has met a polygon.
struct WayStop {
  Hit hit;
  Onward onward = Onward::ends;
};

/// All polygons that a ray meets, each specular but for the last one; empty where it meets nothing. A ray that does not
/// end at its last stop has left the scene from there. Most have one stop, for which no memory is asked for.
using Way = boost::container::small_vector<WayStop, 1>;

/// Ways by geometry alone: from clear polygons and mirrors every ray goes on, whatever their colours, at a clear one
/// with SpecularFace::mirrored_rays() as from a mirror, else straight, drawn by `seed` as
/// Occluder::first_held_hits() draws; after 64 it ends on the next one.
std::vector<Way> specular_ways(const Occluder& occluder, std::span<const Ray> rays, std::uint64_t seed,
                               std::span<const std::size_t> keys = {});

}  // namespace patchlight
