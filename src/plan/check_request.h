#pragma once

#include "patchlight/plan/plan.h"

#include <cstddef>
#include <optional>
#include <string>

namespace patchlight {

/// Checks the parts of a request against each other, without a scene. Messages name fields as in
/// "accuracy.relative_error", with the value where it matters: "effects.skip=sun". \throws InputError when two parts
/// contradict each other.
void check(const Request& request, const Given& given = {});

/// The same, and checks the request against the scene. \throws InputError also when nothing in the scene has a name in
/// AccuracyOptions::interest.
void check(const Request& request, const Scene& scene, const Given& given = {});

/// The part of a request that requires the pair method, as messages name it; nothing if rays will do. Such parts are
/// given matrices, meshes and solvers, other estimators, numbers of samples, and solvers that need columns or symmetry.
std::optional<std::string> part_that_takes_pairs(const Request& request, const Given& given = {});

/// Form factors of pairs are one number for all bands. `chosen` is the request `asked` with its storage decided.
/// `coloured` counts the materials whose transmittance or specular reflectance differs between bands. \throws
/// InputError when there are such materials and the storage is not rows of rays.
void require_rays_for_colours(std::size_t coloured, const Request& chosen, const Request& asked,
                              const Given& given = {});

/// The part of a request that rules out error bars, as messages name it; nothing if none does.
std::optional<std::string> part_without_error_bars(const Request& request, const Given& given = {});

}  // namespace patchlight
