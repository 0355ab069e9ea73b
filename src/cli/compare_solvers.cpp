#include "patchlight/views/picture.h"

#include "archive/scene_hash.h"
#include "base/parallel.h"
#include "base/rounded.h"
#include "cli/commands.h"
#include "cli/distinct_files.h"
#include "cli/interrupt.h"
#include "cli/progress.h"
#include "cli/summary.h"
#include "cli/text_table.h"
#include "output/file/whole_file.h"
#include "output/report/write_study.h"
#include "page/write_page.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <sstream>

namespace patchlight::cli {
namespace {

std::string table(const Comparison& comparison) {
  const PatchIndex patches = comparison.simulation.mesh.size();
  std::vector<TextRow> rows{
      {"solver", "true error", "bound", "iterations", "applications", "seconds", "with assembly", "rate"}};
  for (const SolverRun& run : comparison.runs) {
    const Iteration& last = run.solution.history.back();
    rows.push_back({name_of(run.contestant) + (run.solution.converged ? "" : " (not reached)"),
                    rounded(last.true_error, 2), rounded(last.error_bound, 2),
                    rounded(iterations_of(run, last, patches)), rounded(last.work), rounded(run.seconds),
                    rounded(run.seconds + run.assembly_seconds), rounded(run.rate)});
  }
  return text_table(rows);
}

// Those of the spectral radius, at most six.
int known_digits(const Comparison& comparison) {
  const double share = comparison.spectral_radius_error / comparison.spectral_radius;
  return share > 1e-6 ? std::max(1, static_cast<int>(-std::log10(share))) : 6;
}

std::string facts(const Scene& scene, const Comparison& comparison) {
  std::ostringstream text;
  text << shown_name(scene.file) << ": " << comparison.simulation.mesh.size()
       << " patches; closure: " << comparison.simulation.transport.closure << "; spectral radius of K "
       << rounded(comparison.spectral_radius, known_digits(comparison));
  for (const SolverRun& run : comparison.runs) {
    if (run.contestant.solver != Solver::jacobi || !std::isfinite(run.rate)) continue;
    text << ", which is Jacobi's rate; observed " << rounded(run.rate, 6);
  }
  text << "\niterations of what shoots: shots / patches; applications of the matrix, or as many rows; rate: of the "
          "error "
          "per iteration\n";
  return text.str();
}

// The solvers that have given up. Rows on demand are not closed: that they do not come as near is no failure.
std::string not_reached(const Comparison& comparison) {
  std::string names;
  for (const SolverRun& run : comparison.runs) {
    if (run.solution.converged || !keeps_entries(run.contestant.storage)) continue;
    names += (names.empty() ? "" : ", ") + name_of(run.contestant);
  }
  return names;
}

void write_page_of_comparison(const ComparisonArguments& arguments, const Scene& scene, const Comparison& comparison,
                              const Provenance& provenance, const Observer& observer) {
  const Simulation& simulation = comparison.simulation;
  const SolvedSurface surface = surface_of(simulation);
  const Report report = report_of(scene, arguments.request, simulation);
  const Picture picture = take_picture(simulation, {}, observer);
  write_page(arguments.page, {.scene = scene,
                              .provenance = provenance,
                              .surface = &surface,
                              .report = &report,
                              .pictures = {&picture},
                              .comparison = &comparison});
}

}  // namespace

ExitCode compare_solvers(const ComparisonArguments& arguments) {
  check_comparison_writable(arguments.output);
  if (!arguments.page.empty()) check_writable(arguments.page);
  const ThreadLimit limit(arguments.request.resources.threads);
  ProgressLine line(progress_shown(arguments.quiet));
  const Observer observer = observer_on(line);

  // 1. Read the model, run the solvers
  const Scene scene = read_models(arguments.models, arguments.read, observer);
  require_not_read_from({"-o", arguments.output}, scene.inputs);
  require_not_read({{"--html", arguments.page}}, scene.inputs);
  const Comparison comparison = patchlight::compare(scene, arguments.request, arguments.options, observer);
  const Simulation& simulation = comparison.simulation;
  line.hide();
  if (!simulation.solution.trapped.empty()) {
    print_message("warning", "not solved, nothing written: " + simulation.solution.trapped);
    return not_converged;
  }

  // 2. Write tables, plots and series
  const WritingGuard guard;
  const Provenance provenance{arguments.command_line, exposure_of(simulation), scene_hash(scene)};
  write_comparison(arguments.output, scene, comparison, provenance, observer);
  if (!arguments.page.empty()) write_page_of_comparison(arguments, scene, comparison, provenance, observer);
  line.hide();
  print_notes(notes(scene, simulation), arguments.quiet);
  if (!arguments.quiet) {
    std::cout << table(comparison) << facts(scene, comparison) << files_line({arguments.output, arguments.page})
              << std::flush;
  }
  const std::string missed = not_reached(comparison);
  if (!missed.empty()) {
    print_message("warning",
                  "the tolerance was not reached by " + missed + "; a larger --max-iterations lets them go on");
  }
  if (simulation.solution.converged) return missed.empty() ? good : not_converged;
  print_message("warning", "the reference itself has not converged: relative residual " +
                               rounded(comparison.reference_residual) + "; the errors above are relative to it");
  return not_converged;
}

}  // namespace patchlight::cli
