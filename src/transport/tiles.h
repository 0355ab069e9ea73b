#pragma once

#include "patchlight/transport/exchange_areas.h"

#include <span>

namespace patchlight {

/// Rows and columns of a tile.
inline constexpr PatchIndex tile_edge = 64;

/// How ExchangeAreas are stored: square tiles of tile_edge x tile_edge entries for block rows I <= J, row by row; a
/// diagonal tile holds both of its halves, and rows and columns beyond size() are zero. For what multiplies with tiles;
/// everything else goes through transport/entries.h.
struct Tiles {
  /// Number of block rows.
  static PatchIndex blocks(const ExchangeAreas& S);
  /// The entries of the tile in block row I and block column J >= I.
  static std::span<float> of(ExchangeAreas& S, PatchIndex I, PatchIndex J);
  static std::span<const float> of(const ExchangeAreas& S, PatchIndex I, PatchIndex J);
};

}  // namespace patchlight
