#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/output/provenance.h"

#include "study/compare.h"

#include <filesystem>
#include <nlohmann/json.hpp>

namespace patchlight {

/// The content of compare.json. Names from a model may hold bytes that are not UTF-8.
nlohmann::ordered_json comparison_json(const Scene& scene, const Comparison& comparison, const Provenance& provenance);

/// Writes a folder, whole or not at all: the table (compare.csv), every iteration of every solver (history.csv), both
/// with the facts of the run (compare.json), the true error by iteration, by operator application and by second as
/// plots
/// (.svg and .png), and a series for ParaView per solver (SOLVER.pvd) where frames were kept.
/// docs/reference/outputs/studies.md describes them. \throws OutputError, Cancelled.
void write_comparison(const std::filesystem::path& folder, const Scene& scene, const Comparison& comparison,
                      const Provenance& provenance, const Observer& observer = {});

/// Fails early: \throws OutputError when write_comparison could not write here.
void check_comparison_writable(const std::filesystem::path& folder);

/// An iteration as it is compared: for a solver that shoots, one is as many shots as there are patches.
double iterations_of(const SolverRun& run, const Iteration& iteration, PatchIndex patches);

/// Wall time until an iteration ended. On demand rows are part of it, and what came before is added; on a stored matrix
/// its assembly is not.
double seconds_of(const SolverRun& run, const Iteration& iteration);

}  // namespace patchlight
