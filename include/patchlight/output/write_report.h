#pragma once

#include "patchlight/output/provenance.h"
#include "patchlight/report/report.h"

#include <filesystem>

namespace patchlight {

/// Writes a report as JSON: request and plan, facts and notes of the scene, per material its area, emitted and absorbed
/// flux and irradiance, what sensors read, raw row sums, energy balance, convergence history, seconds, and the memory
/// that the process has taken so far. docs/output.md lists the keys. \throws OutputError.
void write_report(const std::filesystem::path& file, const Report& report, const Provenance& provenance);

}  // namespace patchlight
