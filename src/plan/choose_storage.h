#pragma once

#include "patchlight/plan/plan.h"

#include <cstddef>
#include <string>

namespace patchlight {

/// Pairs are kept for so many patches at most where it is left to the plan: more take tens of seconds, and rows of rays
/// one or two, docs/theory.md section 12.
inline constexpr std::size_t most_patches_in_pairs = 10000;

/// A request with its storage decided.
struct ChosenStorage {
  Request request;
  std::string note;  ///< why, where it is rows of rays; else empty
};

/// What there is to be stored.
struct StoredLight {
  std::size_t patches = 0;
  bool is_reflected = true;  ///< between them, more than once
};

/// Storage::automatic becomes rows of rays for more than most_patches_in_pairs, and where all pairs do not fit into the
/// memory, unless something that is asked for takes all pairs or no light is reflected; Solver::cg, which takes a
/// symmetric matrix, becomes gmres with it. Another storage stays.
ChosenStorage choose_storage(const Request& request, const Given& given, const StoredLight& light);

}  // namespace patchlight
