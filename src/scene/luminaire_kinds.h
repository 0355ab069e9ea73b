#pragma once

#include "patchlight/scene/luminaire.h"

#include <array>

namespace patchlight {

/// The kinds of luminaires as scene files name them, in the order of Luminaire::light.
constexpr std::array<const char*, 4> luminaire_kinds = {"point", "spot", "ies", "sphere"};

inline const char* kind_of(const Luminaire& luminaire) { return luminaire_kinds[luminaire.light.index()]; }

}  // namespace patchlight
