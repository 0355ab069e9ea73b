#pragma once

#include "patchlight/plan/plan.h"

#include <cstddef>
#include <optional>
#include <string>

namespace patchlight {

/// Checks the parts of a request against each other, whatever the scene is like. Messages name fields as in
/// "accuracy.relative_error", with the value where it counts: "effects.skip=sun".
/// \throws InputError when parts of the request cannot be together.
void check(const Request& request, const Given& given = {});

/// The same, and what the scene does not have. \throws InputError as well when nothing in it has a name of
/// AccuracyOptions::interest.
void check(const Request& request, const Scene& scene, const Given& given = {});

/// The part of a request that needs pairs, as messages name it; nothing if rays will do. Such parts are given matrices,
/// meshes and solvers, other estimators and numbers of samples, and solvers that take columns or symmetry.
std::optional<std::string> part_that_takes_pairs(const Request& request, const Given& given = {});

/// Form factors of pairs are one number for all bands. `chosen` is the request `asked` with its storage decided, and
/// `coloured` counts materials whose transmittance or specular reflectance differs between bands.
/// \throws InputError when there are such materials and no rows of rays.
void require_rays_for_colours(std::size_t coloured, const Request& chosen, const Request& asked,
                              const Given& given = {});

/// The part of a request that rules out error bars, as messages name it; nothing if none does.
std::optional<std::string> part_without_error_bars(const Request& request, const Given& given = {});

}  // namespace patchlight
