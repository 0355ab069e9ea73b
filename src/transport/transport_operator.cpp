#include "patchlight/transport/transport_operator.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace patchlight {

// Gathers for one block after the other.
Sweep RowTransport::sweep(Sweep from, const Relax& there, const Relax& back) const {
  constexpr PatchIndex block = 64;
  std::vector<PatchRange> ranges;
  for (PatchIndex begin = 0; begin < size(); begin += block) ranges.push_back({begin, std::min(size(), begin + block)});

  Field& B = from.radiosity;
  const auto relax_with = [&](const Relax& relax, PatchRange range) {
    const Eigen::Index rows = range.end - range.begin;
    B.middleRows(range.begin, rows) =
        relax({range, B.middleRows(range.begin, rows), gather(range, B), form_factors(range, range)});
  };
  for (const PatchRange range : ranges) relax_with(there, range);
  if (back) {
    for (auto range = ranges.rbegin(); range != ranges.rend(); ++range) relax_with(back, *range);
  }
  return {std::move(B), {}, {}};
}

}  // namespace patchlight
