#pragma once

#include "patchlight/report/report.h"
#include "patchlight/simulate.h"

#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace patchlight::cli {

/// Notes on the run, the scene and its sides, without the warnings of print_scene_warnings(), most important first.
Diagnostics notes(const Scene& scene, const Simulation& simulation);

/// Prints the requested accuracy, if any, at the start of a run.
void print_note_on_accuracy(const Request& request, bool quiet);

/// Prints the warnings among the notes, see makes_results_wrong(). Unless the run is quiet, also prints the first
/// `most` of the others, and the number of the rest.
void print_notes(const Diagnostics& notes, bool quiet, std::size_t most = std::numeric_limits<std::size_t>::max());

/// The requested results: a line for each group of sensors, and the estimated errors. `how_to_know_errors` explains how
/// to compute unknown errors. The long form adds the sequence of meshes.
std::string summary_of_results(const Report& report, bool long_form, const std::string& how_to_know_errors);

/// The facts of the run: model and patches, effects, convergence, flux and seconds. The long form adds decisions,
/// counts and ray speed.
std::string summary_of_run(const Report& report, bool long_form);

/// "wrote a, b, c" as one line, without empty names.
std::string files_line(const std::vector<std::filesystem::path>& files);

/// The reason for an unfinished run, and the content of its files.
std::string explain_unfinished(const Report& report);

/// The probable reason for missing convergence, and a remedy.
std::string explain_not_converged(const Report& report);

/// The accuracy reached, its main limit, and a remedy.
std::string explain_not_accurate(const Report& report);

/// The relative error of a mesh from all known parts.
double known_error(const AccuracyStep& step);

/// "4.2 % (mesh 3.1, ...); variation within patches: 12 %".
std::string errors_in_words(const AccuracyStep& step);

/// The line after each solved mesh: "12345 patches, 4.2 % (mesh 3.1, form factors 2.8, solver 0.01), 23 s". The seconds
/// count from the start of the first mesh.
std::string step_in_words(const AccuracyStep& step);

}  // namespace patchlight::cli
