#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/output/write_result.h"

#include "study/compare.h"
#include "study/study.h"

#include <filesystem>
#include <nlohmann/json.hpp>

namespace patchlight {

/// The content of compare.json. Names from a model may hold bytes that are not UTF-8.
nlohmann::ordered_json comparison_json(const Scene& scene, const Comparison& comparison, const Provenance& provenance);

/// Writes a folder, whole or not at all, with:
/// - the table (compare.csv) and every iteration of every solver (history.csv);
/// - both with the facts of the run (compare.json),
/// - plots (.svg and .png) of the true error by iteration, by operator application and by second;
/// - a ParaView series per solver (SOLVER.pvd), if frames were kept.
/// docs/reference/outputs/studies.md describes them. \throws OutputError, Canceled.
void write_comparison(const std::filesystem::path& folder, const Scene& scene, const Comparison& comparison,
                      const Provenance& provenance, const Observer& observer = {});

/// Fails early: \throws OutputError when write_comparison could not write here.
void check_comparison_writable(const std::filesystem::path& folder);

/// An iteration as it is compared: for a solver that shoots, one is as many shots as there are patches.
double iterations_of(const SolverRun& run, const Iteration& iteration, PatchIndex patches);

/// Wall time until an iteration ended. It includes rows on demand and the time before them, but not the assembly of a
/// stored matrix.
double seconds_of(const SolverRun& run, const Iteration& iteration);

/// The content of study.json. Names from a model may hold bytes that are not UTF-8.
nlohmann::ordered_json study_json(const Scene& scene, const Study& study, const Provenance& provenance);

/// Writes a folder, whole or not at all, with:
/// - a row per setting (study.csv);
/// - the same with the reference, the prices and the conclusion (study.json),
/// - plots (.svg and .png) of the error against CPU time and against the memory of the form factors, with the Pareto
///   front;
/// - plots of the errors by estimators of form factors alone.
/// docs/reference/outputs/studies.md describes them. \throws OutputError.
void write_study(const std::filesystem::path& folder, const Scene& scene, const Study& study,
                 const Provenance& provenance);

/// Fails early: \throws OutputError when write_study could not write here.
void check_study_writable(const std::filesystem::path& folder);

}  // namespace patchlight
