#pragma once

#include "patchlight/plan/plan.h"

#include <cstddef>

namespace patchlight {

/// The same by rows of rays; Solver::cg, which takes a symmetric matrix, becomes gmres.
Request by_rays(Request request);

/// A plan that keeps all pairs made one that keeps rows of rays.
Plan by_rays(Plan plan);

/// A request with its storage decided.
struct ChosenStorage {
  Request request;
  Diagnostics notes;  ///< why, where it is rows of rays
};

/// What there is to be stored.
struct StoredLight {
  std::size_t patches = 0;
  std::size_t sides = 0;     ///< kept sides of polygons, which have the patches
  bool is_reflected = true;  ///< between them, more than once
  bool is_mirrored = false;  ///< also without being scattered, which is to be followed
  bool has_goal = false;     ///< patches and rays follow importance to a Goal
  bool has_sensors = false;  ///< whose standard errors follow from those of patches
};

/// Storage::automatic becomes rows of rays where light is mirrored, where there is a goal, where patches are more than
/// 10,000 or few on each side, and where pairs do not fit into the memory. It becomes tiles where there is a
/// part_that_takes_pairs(), or no light is reflected in either way. Another storage stays, except for rays where
/// error bars are requested of light that is not reflected: these become tiles. Rows of rays have error bars where
/// light is reflected, and with these nested meshes. Small meshes that have rays because of mirrors or of few patches a
/// side get more of them. Pairs have error bars where AccuracyOptions::cheap_error_bars allows them.
ChosenStorage choose_storage(const Request& request, const Given& given, const StoredLight& light);

}  // namespace patchlight
