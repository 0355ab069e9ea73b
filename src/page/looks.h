#pragma once

#include "patchlight/views/views.h"

#include <cstddef>
#include <nlohmann/json.hpp>
#include <vector>

namespace patchlight {

/// A way to draw a model as it looks.
struct Look {
  const char* name;
  double exposure = 1;  ///< see Picture::exposure
};

/// How the model of a page is exposed: as `exposure` says. By day, where enclosed patches and others are both lit, also
/// for those of the two that it is not made for. The first is that of `exposure`.
std::vector<Look> looks_of(const SolvedSurface& surface, double exposure);

/// Per look its name, exposure and colours per vertex of at most `most_faces` faces (drawn_faces()), and where there is
/// a sky the colours of sky and ground in the directions of sky_directions().
nlohmann::ordered_json looks_part(const SolvedSurface& surface, double exposure, std::size_t most_faces);

/// Unit directions from the nadir to the zenith, ring by ring, with the number of directions in a ring; null without a
/// sky.
nlohmann::ordered_json sky_directions(const SolvedSurface& surface);

}  // namespace patchlight
