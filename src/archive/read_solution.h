#pragma once

#include "patchlight/simulate.h"

#include <filesystem>

namespace patchlight {

/// A solution that `patchlight solve` has written as .vtp, as far as take_picture() needs it, on the scene that it was
/// solved for. Values have single precision. \throws InputError when the file is none, or that of another scene.
Simulation read_solution(const std::filesystem::path& file, std::shared_ptr<const Scene> scene);

}  // namespace patchlight
