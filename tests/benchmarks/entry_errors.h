#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/transport/exchange_areas.h"

namespace patchlight::benchmarks {

/// How far form factors are from a reference, and what this does to the irradiance of a smooth field.
struct EntryDeviations {
  double l1 = 0;      ///< sum |S - S_ref| / sum S_ref
  double p999 = 0;    ///< 99.9 % of |F_ij - F_ref,ij| stay below, of the ordered pairs whose reference is positive
  double mean_F = 0;  ///< of the same pairs
  double matvec = 0;  ///< ||F x - F_ref x||_A / ||F_ref x||_A for the smooth field x
};
EntryDeviations entry_errors(const PatchMesh& mesh, const ExchangeAreas& S, const ExchangeAreas& reference);

}  // namespace patchlight::benchmarks
