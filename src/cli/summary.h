#pragma once

#include "patchlight/report/report.h"
#include "patchlight/simulate.h"

#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace patchlight::cli {

/// Remarks on the run, the scene and its sides, without the warnings of print_scene_warnings(). Those that say most
/// about the results stand first.
Diagnostics notes(const Scene& scene, const Simulation& simulation);

/// Prints at the beginning of a run which accuracy is asked for, if one is.
void print_note_on_accuracy(const Request& request, bool quiet);

/// Prints the first `most` notes and the number of the others, unless the run is quiet.
void print_notes(const Diagnostics& notes, bool quiet, std::size_t most = std::numeric_limits<std::size_t>::max());

/// The results that the user asked for: a line for each group of sensors and the estimated errors. Where errors are not
/// known, `how_to_know_errors` names the way to compute them. The long form adds the meshes on the way to an accuracy.
std::string summary_of_results(const Report& report, bool long_form, const std::string& how_to_know_errors);

/// The facts of the run: model and patches, effects, convergence, flux and seconds. The long form adds decisions,
/// counts and the speed of rays.
std::string summary_of_run(const Report& report, bool long_form);

/// "wrote a, b, c" as one line; without those that are empty.
std::string files_line(const std::vector<std::filesystem::path>& files);

/// Why a run was left unfinished, and the content of the files.
std::string explain_unfinished(const Report& report);

/// The probable reason why a solution has not converged, and a remedy.
std::string explain_not_converged(const Report& report);

/// The accuracy that was reached, its main limit, and a remedy.
std::string explain_not_accurate(const Report& report);

/// The error of a mesh as a share: of all parts that are known.
double known_error(const AccuracyStep& step);

/// "4.2 % (mesh 3.1, ...); variation within patches: 12 %".
std::string errors_in_words(const AccuracyStep& step);

/// The line that is printed as soon as a mesh is solved: "12345 patches, 4.2 % (mesh 3.1, form factors 2.8, solver
/// 0.01), 23 s", the seconds since the first one was begun.
std::string step_in_words(const AccuracyStep& step);

}  // namespace patchlight::cli
