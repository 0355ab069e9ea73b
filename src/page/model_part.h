#pragma once

#include "patchlight/views/views.h"

#include <cstddef>
#include <nlohmann/json.hpp>

namespace patchlight {

/// A page has so many faces at most; the model of a larger solution is drawn with fewer.
inline constexpr std::size_t most_drawn_faces = 150'000;

/// The solved surface as the page draws it: faces, colours and values, packed, with the names that go with them.
nlohmann::ordered_json model_part(const SolvedSurface& surface, double exposure,
                                  std::size_t most_faces = most_drawn_faces);

}  // namespace patchlight
