#pragma once

#include "patchlight/gather/readings.h"
#include "patchlight/output/provenance.h"
#include "patchlight/simulate.h"

#include <filesystem>
#include <string>
#include <vector>

namespace patchlight {

/// What the sensors read, for the report.
struct SensorReport {
  std::vector<GroupReadings> groups;
  std::string unit;                   ///< of their values
  std::vector<std::string> warnings;  ///< doubtful_sensors()
};

/// A run of the program. It refers to its parts, which must outlive it.
struct Run {
  const Scene& scene;
  const Request& request;
  const Simulation& simulation;
  const Provenance& provenance;
  SensorReport sensors{};
};

/// Writes a JSON report: request and plan, facts and notes of the scene, per material its area, emitted and absorbed
/// flux and irradiance, what sensors read, raw row sums, energy balance, convergence history, seconds and memory.
/// docs/output.md lists the keys. \throws OutputError.
void write_report(const std::filesystem::path& file, const Run& run);

}  // namespace patchlight
