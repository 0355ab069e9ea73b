// The commands that write a folder: form-factors, compare-solvers and convergence.
#include "patchlight/views/picture.h"

#include "archive/ray_row_files.h"
#include "archive/scene_hash.h"
#include "base/parallel.h"
#include "base/words.h"
#include "cli/commands.h"
#include "cli/distinct_files.h"
#include "cli/messages.h"
#include "cli/option_names.h"
#include "cli/progress.h"
#include "cli/summary.h"
#include "output/file/whole_file.h"
#include "output/report/write_study.h"
#include "page/write_page.h"
#include "study/study.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <sstream>

namespace patchlight::cli {
namespace {

bool is_one_file(const FormFactorArguments& arguments) {
  return arguments.output.extension() == ".npy" || arguments.output.extension() == ".mtx";
}

// Prints only as many groups as fit on a line; the CSV has all.
std::string table(const GroupFactors& groups) {
  if (groups.names.size() > 12) {
    return std::to_string(groups.names.size()) + " " + name_of(groups.by) + "s: too many to print\n";
  }
  std::size_t width = 0;
  for (const std::string& name : groups.names) width = std::max(width, shown_name(name).size());
  std::ostringstream text;
  text << "form factors from each " << name_of(groups.by) << " to the others, in their order, and their sum:\n"
       << std::fixed << std::setprecision(5);
  for (std::size_t from = 0; from < groups.names.size(); ++from) {
    const auto row = groups.form_factor.row(static_cast<Eigen::Index>(from));
    text << "  " << std::left << std::setw(static_cast<int>(width)) << shown_name(groups.names[from]) << std::right;
    for (const double form_factor : row) text << "  " << form_factor;
    text << "  = " << row.sum() << '\n';
  }
  return text.str();
}

// A note on the definition of the group factors for faces with two simulated sides.
Diagnostics note_on_groups(const KeptSides& sides) {
  std::size_t both = 0;
  for (std::size_t p = 0; p < sides.front.size(); ++p) both += sides.front[p] != 0 && sides.back[p] != 0 ? 1 : 0;
  if (both == 0) return {};
  return {{DiagnosticCode::both_sides,
           "both sides of " + std::to_string(both) +
               " faces are simulated: the form factor from a group is a fraction of the light from all of its sides, "
               "half of that from the fronts if the backs see nothing\nhint: --sides front leaves the backs out",
           both}};
}

std::string summary(const Scene& scene, const FormFactors& form_factors) {
  const Exchange& exchange = form_factors.exchange;
  const Eigen::ArrayXd sums = row_sums(exchange.exchange_areas).cwiseQuotient(exchange.area).array();
  std::ostringstream text;
  text << shown_name(scene.file) << ": " << form_factors.mesh.size() << " patches with edges up to "
       << std::setprecision(3) << form_factors.plan.max_edge << " m; estimator "
       << name_of(form_factors.plan.assembly.estimator) << "; row sums " << std::setprecision(6) << sums.minCoeff()
       << " to " << sums.maxCoeff() << ", before closure " << exchange.raw_row_sum.minCoeff() << " to "
       << exchange.raw_row_sum.maxCoeff()
       << "; closure: " << (exchange.closure.empty() ? "not asked for" : exchange.closure) << '\n';
  return text.str();
}

// Facts about written form factors.
struct Written {
  Diagnostics notes;
  std::string summary;
};

// Writes form factors of either method.
template <class Found>
Diagnostics notes_on(const FormFactorArguments& arguments, const Scene& scene, const Found& found) {
  Diagnostics all = merged({remarks_of(scene), found.plan.sides.notes, found.plan.notes, found.notes});
  if (found.request.mesh.sides != arguments.request.mesh.sides)
    all.push_back({DiagnosticCode::unlit_sides, "no light source, so --sides auto uses the front sides"});
  return all;
}

Written write_pairs(const FormFactorArguments& arguments, const Scene& scene, const Observer& observer) {
  const FormFactors found = find_form_factors(scene, arguments.request, observer);
  std::vector<GroupFactors> groups;
  if (arguments.by) groups.push_back(group_factors(scene, found, *arguments.by));
  const WritingGuard guard;
  if (is_one_file(arguments)) {
    write_matrix(arguments.output, found.exchange, arguments.format, observer);
  } else {
    write_form_factors(arguments.output, {scene, found, groups, arguments.command_line, arguments.format}, observer);
  }
  Written written{notes_on(arguments, scene, found), summary(scene, found)};
  if (!groups.empty()) written.notes = merged({std::move(written.notes), note_on_groups(found.plan.sides)});
  for (const GroupFactors& table_of : groups) written.summary += table(table_of);
  return written;
}

Written write_rays(const FormFactorArguments& arguments, const Scene& scene, const Observer& observer) {
  const RayFormFactors found = find_ray_form_factors(scene, arguments.request, observer);
  const WritingGuard guard;
  write_ray_rows(arguments.output, scene, found, arguments.command_line, observer);
  std::ostringstream text;
  text << shown_name(scene.file) << ": " << found.mesh.size() << " patches with edges up to " << std::setprecision(3)
       << found.plan.max_edge << " m; " << found.exchange.rows.rays << " rays over hemispheres, "
       << found.exchange.rows.shadow_rays << " towards bright patches, " << found.exchange.emitters.size()
       << (found.exchange.emitters.size() == 1 ? " lamp" : " lamps") << " apart\n";
  return {notes_on(arguments, scene, found), text.str()};
}

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

// Known digits of the spectral radius, at most six.
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
  text << "\niterations of shooting solvers: shots / patches; applications: of the matrix, or as many rows; rate: of "
          "the "
          "error per iteration\n";
  return text.str();
}

// Solvers that did not converge. Rows on demand have no closure, so that a larger deviation is no failure.
std::string not_reached(const Comparison& comparison) {
  std::vector<std::string> names;
  for (const SolverRun& run : comparison.runs) {
    if (!run.solution.converged && keeps_entries(run.contestant.storage)) names.push_back(name_of(run.contestant));
  }
  return listed(names);
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

// True if the error is within the error of the reference.
bool is_doubtful(double error, const Study& study) { return error > 0 && error <= study.reference.bar; }

std::string judged(double error, const Study& study) { return percent(error) + (is_doubtful(error, study) ? "?" : ""); }

bool has_doubtful_errors(const Study& study) {
  return std::ranges::any_of(study.sweeps, [&](const StudySweep& sweep) {
    return std::ranges::any_of(sweep.settings, [&](const StudySetting& setting) {
      return is_doubtful(setting.error, study) || is_doubtful(setting.display_error, study);
    });
  });
}

std::string table(const Study& study) {
  std::vector<TextRow> rows{{"sweep", "patches", "samples", "tolerance", "seconds", "CPU", "MB", "error %", "display %",
                             "own %", "order", "front"}};
  for (const StudySweep& sweep : study.sweeps) {
    for (const StudySetting& setting : sweep.settings) {
      rows.push_back({sweep.name, std::to_string(setting.patches), std::to_string(setting.samples),
                      rounded(setting.tolerance, 1), rounded(seconds_of(setting)), rounded(cpu_seconds_of(setting)),
                      rounded(setting.matrix_bytes / 1e6, 2), judged(setting.error, study),
                      judged(setting.display_error, study), percent(setting.own_error), rounded(setting.order, 2),
                      setting.on_time_front ? "*" : ""});
    }
  }
  return text_table(rows);
}

std::string facts(const Scene& scene, const Study& study) {
  std::ostringstream text;
  const StudyReference& reference = study.reference;
  text << scene.file << ": errors of the reflected light against ";
  if (reference.closed_form) {
    text << "the closed form: a closed room with E = 1 - rho";
  } else {
    text << "a solution with " << reference.patches << " patches and " << reference.samples << " samples ("
         << rounded(reference.cpu_seconds) << " processor seconds) with an error of " << percent(reference.bar) << " %";
  }
  text << "\nerror: of the patch means; display: of the field, constant on each patch; own: due to the swept quantity "
          "alone; *: on the Pareto front of error and processor seconds\n"
       << (has_doubtful_errors(study) ? "?: not significant, since the reference has a similar error\n" : "")
       << "at the finest setting: mesh " << percent(study.parts.mesh) << " %, form factors "
       << percent(study.parts.form_factors) << " %, solver " << percent(study.parts.solver) << " %\n";
  return text.str();
}

// Reads the models of a command that writes a folder, and a page if one is asked for.
Scene read_beside_results(const auto& arguments, const Observer& observer) {
  Scene scene = read_models(arguments.models, arguments.read, observer);
  require_not_read_from({"-o", arguments.output}, scene.inputs);
  require_not_read({{"--html", arguments.page}}, scene.inputs);
  return scene;
}

}  // namespace

ExitCode run(const FormFactorArguments& arguments) {
  if (is_one_file(arguments)) {
    check_writable(arguments.output);
  } else {
    check_form_factors_writable(arguments.output);
  }
  const ThreadLimit limit(arguments.request.resources.threads);
  ProgressLine line(progress_shown(arguments.quiet));
  const Observer observer = observer_on(line);

  // 1. Read the model
  const Scene scene = read_models(arguments.models, arguments.read, observer);
  if (is_one_file(arguments)) {
    require_not_read({{"-o", arguments.output}}, scene.inputs);
  } else {
    require_not_read_from({"-o", arguments.output}, scene.inputs);
  }

  // 2. Find the form factors and write them
  line.expect({Stage::read, Stage::plan, Stage::mesh, Stage::form_factors, Stage::closure, Stage::write});
  const Written written = arguments.request.assembly.storage == Storage::rays ? write_rays(arguments, scene, observer)
                                                                              : write_pairs(arguments, scene, observer);
  line.hide();
  print_notes(written.notes, arguments.quiet);
  if (arguments.quiet) return good;
  std::cout << written.summary << "wrote " << shown_name(arguments.output.string()) << std::endl;
  return good;
}

ExitCode run(const ComparisonArguments& arguments) {
  check_comparison_writable(arguments.output);
  if (!arguments.page.empty()) check_writable(arguments.page);
  const ThreadLimit limit(arguments.request.resources.threads);
  ProgressLine line(progress_shown(arguments.quiet));
  const Observer observer = observer_on(line);

  // 1. Read the model, run the solvers
  const Scene scene = read_beside_results(arguments, observer);
  Comparison comparison = patchlight::compare(scene, arguments.request, arguments.options, observer);
  comparison.simulation = with_option_names(std::move(comparison.simulation));
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

ExitCode run(const ConvergenceArguments& arguments) {
  check_study_writable(arguments.output);
  if (!arguments.page.empty()) check_writable(arguments.page);
  const ThreadLimit limit(arguments.request.resources.threads);
  ProgressLine line(progress_shown(arguments.quiet));
  const Observer observer = observer_on(line);

  // 1. Read the model, solve it in many ways
  const Scene scene = read_beside_results(arguments, observer);
  const Study study = patchlight::study(scene, arguments.request, arguments.options, observer);
  line.hide();
  if (!study.trapped.empty()) {
    print_message("warning", "not solved, nothing written: " + study.trapped);
    return not_converged;
  }

  // 2. Write tables and plots
  const WritingGuard guard;
  const Provenance provenance{.command_line = arguments.command_line, .scene_hash = scene_hash(scene)};
  write_study(arguments.output, scene, study, provenance);
  if (!arguments.page.empty()) write_page(arguments.page, {.scene = scene, .provenance = provenance, .study = &study});
  print_notes(study.notes, arguments.quiet);
  if (!arguments.quiet) {
    std::cout << table(study) << facts(scene, study) << conclusion(study) << "\n"
              << files_line({arguments.output, arguments.page}) << std::flush;
  }
  if (study.reference.converged) return good;
  print_message("warning", "the reference has not converged: the errors above are relative to it");
  return not_converged;
}

}  // namespace patchlight::cli
