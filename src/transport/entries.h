#pragma once

#include "patchlight/transport/exchange_areas.h"

#include "transport/tiles.h"

#include <functional>

namespace patchlight {

// What closure, the merging of parents, the draws of errors and the writers ask of a storage of exchange areas:
// ExchangeAreas::at() and set(), multiply() and row_sums() of exchange_areas.h, and entry_parts(), for_entries() and
// changed() of this file. Another storage has functions of these names, too.

/// In how many parts for_entries() goes through the entries: every pair of patches is in one of them.
PatchIndex entry_parts(const ExchangeAreas& S);

/// Calls use(i, j, S_ij) for the entries i < j of a part that are not 0, always in the same order.
template <typename Use>
void for_entries(const ExchangeAreas& S, PatchIndex part, Use use);

/// Every entry S_ij that is not 0 replaced by value(i, j, S_ij) = value(j, i, S_ij), narrowed toward zero. `value` is
/// called by several threads at once.
using Change = std::function<double(PatchIndex i, PatchIndex j, double entry)>;
ExchangeAreas changed(ExchangeAreas S, const Change& value);

template <typename Use>
void for_entries(const ExchangeAreas& S, PatchIndex part, Use use) {
  const PatchIndex I = part;
  for (PatchIndex J = I; J < Tiles::blocks(S); ++J) {
    const std::span<const float> tile = Tiles::of(S, I, J);
    for (PatchIndex k = 0; k < tile_edge * tile_edge; ++k) {
      const PatchIndex i = I * tile_edge + k / tile_edge;
      const PatchIndex j = J * tile_edge + k % tile_edge;
      if (i < j && tile[k] != 0) use(i, j, static_cast<double>(tile[k]));
    }
  }
}

}  // namespace patchlight
