#pragma once

#include "patchlight/scene/scene.h"

#include "visibility/occluder.h"

#include <cstdint>
#include <vector>

namespace patchlight {

// Which polygons take part in tracing; marks are 1 per polygon that does not.

/// Whether clear polygons let light through.
bool lets_through(Occluder::Blockers which);

/// The polygons that cannot stand in the way of a segment.
std::vector<std::uint8_t> left_out_by(Occluder::Blockers which, const Scene& scene);

/// Those left out, and besides all clear polygons, or all others.
std::vector<std::uint8_t> without_kind(std::vector<std::uint8_t> left_out, const Scene& scene, bool clear);

/// The polygons that rays do not meet: those of the other kind, where only one kind is asked for.
std::vector<std::uint8_t> never_met(Occluder::Blockers which, const Scene& scene);

}  // namespace patchlight
