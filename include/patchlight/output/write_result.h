#pragma once

#include "patchlight/output/provenance.h"
#include "patchlight/report/report.h"
#include "patchlight/views/views.h"

#include <filesystem>
#include <string>
#include <vector>

namespace patchlight {

/// The extensions write_result() knows: ".vtp", ".vtu", ".ply", ".glb".
const std::vector<std::string>& result_extensions();

/// Writes the solved patches in the format that the extension names. \throws OutputError, also for an unknown one.
void write_result(const std::filesystem::path& file, const SolvedSurface& surface, const Provenance& provenance);

/// Writes a report as JSON: request and plan, facts and notes of the scene, per material its area, emitted and absorbed
/// flux and irradiance, what sensors read, raw row sums, energy balance, convergence history, seconds, and the memory
/// that the process has taken so far. docs/reference/outputs/report-json.md lists the keys. \throws OutputError.
void write_report(const std::filesystem::path& file, const Report& report, const Provenance& provenance);

}  // namespace patchlight
