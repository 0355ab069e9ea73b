#include "transport/entries.h"

#include "base/parallel.h"
#include "transport/narrow.h"

namespace patchlight {

PatchIndex entry_parts(const ExchangeAreas& S) { return Tiles::blocks(S); }

ExchangeAreas changed(ExchangeAreas S, const Change& value) {
  const PatchIndex blocks = Tiles::blocks(S);
  parallel_for(blocks, [&](std::size_t row) {
    const auto I = static_cast<PatchIndex>(row);
    for (PatchIndex J = I; J < blocks; ++J) {
      const std::span<float> tile = Tiles::of(S, I, J);
      for (PatchIndex k = 0; k < tile_edge * tile_edge; ++k) {
        if (tile[k] == 0) continue;
        tile[k] = narrow_toward_zero(
            value(I * tile_edge + k / tile_edge, J * tile_edge + k % tile_edge, static_cast<double>(tile[k])));
      }
    }
  });
  return S;
}

}  // namespace patchlight
