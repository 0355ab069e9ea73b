#pragma once

#include "patchlight/simulate.h"

#include <filesystem>
#include <string>
#include <vector>

namespace patchlight::cli {

/// What the user should know about the scene and the plan.
std::vector<std::string> notes(const Scene& scene, const Simulation& simulation);

/// A few lines: patches, convergence, where the light goes, seconds. The long form adds decisions, counts and speed.
std::string summary(const Scene& scene, const Simulation& simulation, bool long_form);

/// "wrote a, b, c" as one line.
std::string files_line(const std::vector<std::filesystem::path>& files);

/// Why a solution that has not converged probably has not, and what to do.
std::string explain_not_converged(const Simulation& simulation);

}  // namespace patchlight::cli
