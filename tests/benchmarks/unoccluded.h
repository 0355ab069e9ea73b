#pragma once

#include "patchlight/transport/exchange_areas.h"

#include "benchmarks/room.h"

#include <array>

namespace patchlight::benchmarks {

/// The exchange areas of a room's patches as the assembly finds them when nothing stands in the way.
ExchangeAreas without_occluders(const Room& room);

/// How far unoccluded entries of one zone of distance are from the contour integral over quarters of their patches.
struct ZoneErrors {
  double pairs = 0;
  double median = 0;              ///< relative error
  double p999 = 0;                ///< 99.9 % stay below
  double largest = 0;             ///< relative
  double largest_F = 0;           ///< of |F_ij - exact|
  double within_millionth = 0;    ///< share with a relative error below 1e-6
  double within_millionth_F = 0;  ///< share with |F_ij - exact| below 1e-6
};

/// Near, middle and far: closer than two and four diameters of the larger patch, and beyond. At most 20,000 pairs of a
/// zone are drawn.
std::array<ZoneErrors, 3> zone_errors(const PatchMesh& mesh, const ExchangeAreas& unoccluded);

/// Of how many pairs the entry is above the unoccluded one by more than 1e-6 of it.
double entries_above(const ExchangeAreas& S, const ExchangeAreas& unoccluded);

/// |F - exact| of two unit squares that share an edge at this angle in degrees.
double edge_sharing_error(double angle);

}  // namespace patchlight::benchmarks
