#pragma once

#include "patchlight/transport/exchange_areas.h"

namespace patchlight {

/// Rows and columns of a tile of exchange areas.
inline constexpr PatchIndex tile_edge = ExchangeAreas::edge;

}  // namespace patchlight
