#pragma once

#include "patchlight/output/provenance.h"
#include "patchlight/simulate.h"

#include <filesystem>

namespace patchlight {

/// Writes a JSON report: request and plan, facts and notes of the scene, per material its area, emitted and absorbed
/// flux and irradiance, raw row sums, energy balance, convergence history, seconds and memory. docs/formats.md lists
/// the keys. \throws OutputError.
void write_report(const std::filesystem::path& file, const Scene& scene, const Request& request,
                  const Simulation& simulation, const Provenance& provenance);

}  // namespace patchlight
