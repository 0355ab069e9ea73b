#pragma once

#include "patchlight/report/report.h"
#include "patchlight/simulate.h"

#include <filesystem>
#include <string>
#include <vector>

namespace patchlight::cli {

/// Remarks on the scene, its sides and the run, without the warnings of print_scene_warnings().
std::vector<std::string> notes(const Scene& scene, const Simulation& simulation);

/// Prints the notes unless the run is quiet.
void print_notes(const std::vector<std::string>& notes, bool quiet);

/// A few lines: patches, convergence, errors, or where they are not known `how_to_know_errors`, where the light goes,
/// seconds, and a line for each group of sensors. The long form adds decisions, counts, speed and the meshes on the way
/// to an accuracy.
std::string summary(const Report& report, bool long_form, const std::string& how_to_know_errors);

/// "wrote a, b, c" as one line; without those that are empty.
std::string files_line(const std::vector<std::filesystem::path>& files);

/// Why a run was left unfinished, and what the files hold.
std::string explain_unfinished(const Report& report);

/// Why a solution that has not converged probably has not, and what to do.
std::string explain_not_converged(const Report& report);

/// What has been reached instead of the accuracy that was asked for, what limits it, and what to do.
std::string explain_not_accurate(const Report& report);

/// The error of a mesh as a share: of all parts that are known.
double known_error(const AccuracyStep& step);

/// "4.2 % (mesh 3.1, ...); variation within patches: 12 %".
std::string errors_in_words(const AccuracyStep& step);

/// What a mesh gave, told as soon as it is solved: "12345 patches, 4.2 % (mesh 3.1, form factors 2.8, solver 0.01), 23
/// s", the seconds since the first one was begun.
std::string step_in_words(const AccuracyStep& step);

}  // namespace patchlight::cli
