#pragma once

#include "patchlight/plan/plan.h"

#include <cstddef>
#include <optional>
#include <string>

namespace patchlight {

/// What one part of a request says against another, whatever the scene is like. Messages name fields as
/// "accuracy.relative_error", with the value where that is what counts: "effects.skip=sun".
/// \throws InputError when parts of the request cannot be together.
void check(const Request& request, const Given& given = {});

/// The same, and what the scene does not have. \throws InputError as well when nothing in it has a name of
/// AccuracyOptions::interest.
void check(const Request& request, const Scene& scene, const Given& given = {});

/// The part of a request that rows of rays do not provide, as messages name it: pairs, a given matrix, mesh or solver,
/// rows that are not closed, another estimator or number of its samples, other short cuts, light as if nothing stood in
/// the way, or a solver that takes columns or symmetry. Nothing where rays may be taken.
std::optional<std::string> part_that_takes_pairs(const Request& request, const Given& given = {});

/// Form factors of pairs are one number for all bands. `chosen` is the request `asked` with its storage decided, and
/// `coloured` counts materials whose transmittance or specular reflectance differs between bands.
/// \throws InputError when there are such materials and no rows of rays.
void require_rays_for_colours(std::size_t coloured, const Request& chosen, const Request& asked,
                              const Given& given = {});

/// What of a request leaves no error bars, as messages name it; nothing where there may be some.
std::optional<std::string> part_without_error_bars(const Request& request, const Given& given = {});

}  // namespace patchlight
