#include "cli/summary.h"

#include "base/words.h"
#include "cli/messages.h"
#include "cli/option_names.h"
#include "light/photometry.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace patchlight::cli {
namespace {

// The parts of the error in percent; the solver's part is unknown without a bound.
std::string parts(const AccuracyStep& step) {
  return "mesh " + percent(step.mesh, 2) + ", form factors " + percent(step.form_factor, 2) + ", solver " +
         (std::isfinite(step.solver) ? percent(step.solver, 1) : "unknown");
}

// Values per band, for three bands as R, G, B.
std::string bands(const Eigen::ArrayXd& values) {
  return listed_as(values, [](double value) { return rounded(value); });
}

std::string convergence(const Report& report) {
  const SolutionFacts& solution = report.solution;
  const Solver solver = report.plan.solver.solver;
  const Iteration& last = solution.history.back();
  std::ostringstream text;
  text << name_of(solver) << ": " << (solution.converged ? "converged" : "NOT converged") << " after " << last.number
       << (is_shooting(solver) ? " shot" : " iteration") << (last.number == 1 ? "" : "s") << " (" << rounded(last.work)
       << " operator applications)";
  if (std::isfinite(last.error_bound)) {
    text << ", solver error at most " << rounded(last.error_bound, 2) << " as a whole";
    if (std::isfinite(solution.patch_bound)) text << ", " << rounded(solution.patch_bound, 2) << " patch by patch";
  } else {
    text << ", relative residual " << rounded(last.relative_residual, 2) << " (no bound on the error is known)";
  }
  return text.str();
}

// The errors of patch means, and the variation within patches.
std::string errors(const Report& report) {
  std::string on;
  for (const std::string& name : report.plan.accuracy.interest) on += (on.empty() ? " on " : ", ") + name;
  const AccuracyStep& step = report.accuracy.back();
  if (step.inside) on = " (indoors)";
  std::string text = "estimated error" + on + ": " + errors_in_words(step);
  for (const auto& [space, part] : report.spaces) {
    if (step.inside && space == "inside") continue;
    const bool is_dark = part.mesh == 0 && part.form_factor == 0 && part.solver == 0 && part.display == 0;
    text += "\n  " + space + ", " + std::to_string(part.patches) + " patches, " +
            (is_dark ? "which reflect no light" : "relative to the light reflected there: " + errors_in_words(part));
  }
  return text;
}

// The remedy for an error above 5 %, unless an accuracy was requested.
std::string advice_on_errors(const Report& report) {
  const AccuracyStep& step = report.accuracy.back();
  if (refines(report.plan.accuracy) || !(known_error(step) > 0.05)) return {};
  const bool by_rays = report.plan.assembly.storage == Storage::rays;
  return std::string("hint: ") +
         (step.mesh >= step.form_factor ? "more --patches, or --accuracy, reduce this error"
          : by_rays                     ? "more --rays reduce this error"
                    : "more --samples reduce this error, and more --patches the part from luminaires, sun and sky") +
         '\n';
}

// The sequence of meshes in adaptive refinement.
std::string steps_table(const std::vector<AccuracyStep>& steps) {
  std::vector<TextRow> rows{
      {"patches", "of these new", "samples", "mesh %", "form factors %", "solver %", "total %", "s", "CPU s"}};
  for (const AccuracyStep& step : steps) {
    rows.push_back({std::to_string(step.patches), std::to_string(step.new_patches), std::to_string(step.samples),
                    percent(step.mesh, 2), percent(step.form_factor, 2), percent(step.solver, 2),
                    percent(step.total, 2), rounded(step.seconds), rounded(step.cpu_seconds)});
  }
  return text_table(rows);
}

// Rows of the ray method have random errors: 1 / sqrt(R) for R rays with equal flux, and up to ten times as much if a
// few rays carry most of the flux.
std::string why_imbalanced(const Report& report) {
  if (report.plan.assembly.storage != Storage::rays) return {};
  const double usual =
      1 / std::sqrt(static_cast<double>(report.plan.assembly.rays) * static_cast<double>(report.patches));
  if (report.balance.imbalance < usual / 10) return {};
  const bool is_noise = report.balance.imbalance <= 10 * usual;
  return std::string(is_noise ? ", due to the noise of the rays" : ", more than the noise of the rays explains") +
         ": up to a few times " + rounded(usual, 1) + " is usual, one over the root of their number";
}

std::string energy(const Report& report) {
  const EnergyBalance& balance = report.balance;
  const bool row_sums_known = report.form_factors.row_sum.has_value();
  const bool is_spectral = are_of_wavelengths(report.scene.bands);
  // Spectral bands are summed.
  const auto in_words = [is_spectral](const Eigen::ArrayXd& values) {
    return is_spectral ? rounded(values.sum()) : bands(values);
  };
  std::ostringstream text;
  text << (is_spectral ? "flux in W, all bands: emitted " : "flux in W per band: emitted ") << in_words(balance.emitted)
       << ((balance.arriving > 0).any() ? "; arriving from luminaires, sun and sky " + in_words(balance.arriving) : "")
       << "; absorbed " << in_words(balance.absorbed) << "; escaped " << in_words(balance.escaped)
       << "; lost at sides without patches " << in_words(balance.lost_at_backs)
       << (row_sums_known ? "; lost by form factors " + in_words(balance.defect) + "; imbalance "
                          : "; imbalance, with the loss by form factors, ")
       << rounded(balance.imbalance, 2) << " of the flux" << why_imbalanced(report);
  return text.str();
}

std::string seconds(const std::vector<StageCost>& costs) {
  std::ostringstream text;
  double total = 0;
  text << std::fixed << std::setprecision(2);
  for (const StageCost& cost : costs) total += cost.seconds;
  text << total << " s";
  const char* separator = ": ";
  for (const StageCost& cost : costs) {
    text << separator << name_of(cost.stage) << ' ' << cost.seconds;
    separator = ", ";
  }
  return text.str();
}

std::string worst_patches(const std::vector<WorstPatch>& worst) {
  std::ostringstream text;
  text << "patches whose row sums were farthest off before closure, by area:\n";
  for (const WorstPatch& patch : worst) {
    text << "  " << patch.place << ", face " << patch.face << " of " << patch.group << ", material "
         << shown_name(patch.material) << ", at " << bands(patch.centre.array()) << " m: " << rounded(patch.row_sum, 6)
         << ", expected " << rounded(patch.expected, 6) << '\n';
  }
  return text.str();
}

// Counts over the whole matrix.
std::string assembly(const FormFactorFacts& facts) {
  std::ostringstream text;
  const AssemblyCounts& counts = *facts.counts;
  text << "pairs of patches: " << counts.facing_pairs << " facing, of these " << counts.near_pairs << " near, "
       << counts.partial_pairs << " partly and " << counts.blocked_pairs << " fully occluded\n";
  text << "shadow rays: " << counts.shadow_rays;
  if (facts.rays_per_second) {
    const double rate = *facts.rays_per_second;
    text << ", " << rounded(1e-6 * rate) << " million per second";
    const double bare = facts.bare_rays_per_second;
    if (bare > 0) text << ", " << rounded(100 * rate / bare, 2) << " % of the rate of Embree alone";
  }
  text << "\nrow sums before closure: " << rounded(facts.raw_row_sum->min, 6) << " to "
       << rounded(facts.raw_row_sum->max, 6) << "; closure: " << facts.closure << '\n'
       << worst_patches(facts.worst);
  return text.str();
}

std::string details(const Report& report) {
  std::string text;
  for (const Decision& decision : report.plan.decisions) text += with_option_names(sentence(decision)) + '\n';
  text += std::string("estimator of form factors: ") + name_of(report.plan.assembly.estimator) + '\n';
  if (report.form_factors.counts) return text + assembly(report.form_factors);
  if (report.plan.assembly.storage != Storage::rays)
    return text + "rows of form factors: computed on demand; pairs, rays and row sums are not known\n";
  const int rays = report.accuracy.empty() ? report.plan.assembly.rays : report.accuracy.back().samples;
  return text + "form factors: sparse rows of " + std::to_string(rays) + " rays per patch on average\n";
}

std::string error_text(double error) { return std::isnan(error) ? "not known" : rounded(error, 2); }

// A line for each group of sensors, with the mean and its standard error first.
std::string sensor_lines(const Report& report, const std::string& how_to_know_errors) {
  const SensorFacts& sensors = report.sensors;
  if (sensors.groups.empty()) return {};
  const std::string in_unit = ", " + sensors.unit;
  const bool some_inside_walls = std::any_of(sensors.groups.begin(), sensors.groups.end(),
                                             [](const GroupReadings& group) { return group.inside_walls > 0; });
  std::vector<TextRow> rows = {{"sensors", "number", "mean" + in_unit, "±" + in_unit, "min" + in_unit, "max" + in_unit,
                                "U0", "largest ±" + in_unit}};
  if (sensors.daylight) rows[0].emplace_back("daylight factor, %");
  if (some_inside_walls) rows[0].emplace_back("inside walls");
  for (const GroupReadings& group : sensors.groups) {
    rows.push_back({group.name, std::to_string(group.sensors)});
    if (group.inside_walls < group.sensors)
      rows.back().insert(rows.back().end(),
                         {rounded(group.mean), error_text(group.standard_error_of_mean), rounded(group.min),
                          rounded(group.max), rounded(group.uniformity), error_text(group.largest_standard_error)});
    rows.back().resize(8);
    if (sensors.daylight) rows.back().push_back(group.mean_daylight_factor ? rounded(*group.mean_daylight_factor) : "");
    if (some_inside_walls) rows.back().push_back(std::to_string(group.inside_walls));
  }
  if (!report.accuracy.empty()) return text_table(rows);
  return text_table(rows) +
         "the mesh part of the sensors' standard errors is only an estimate; behind slits and louvers it can be ten "
         "times too small" +
         how_to_know_errors + '\n';
}

// "effects: occlusion, closure; left out: color, sun; by option: closure"
std::string effects_line(const std::vector<Decision>& decisions) {
  std::string on, off, forced;
  for (const Decision& decision : decisions) {
    std::string& list = decision.simulate ? on : off;
    list += (list.empty() ? "" : ", ") + std::string(name_of(decision.effect));
    if (decision.forced) forced += (forced.empty() ? "" : ", ") + std::string(name_of(decision.effect));
  }
  return "effects: " + (on.empty() ? "none" : on) + (off.empty() ? "" : "; left out: " + off) +
         (forced.empty() ? "" : "; by option: " + forced) + '\n';
}

}  // namespace

Diagnostics notes(const Scene& scene, const Simulation& simulation) {
  return merged({simulation.notes, remarks_of(scene), simulation.plan.sides.notes});
}

void print_note_on_accuracy(const Request& request, bool quiet) {
  if (quiet || !request.accuracy.relative_error) return;
  print_message("note", "refining until the estimated error of mesh, form factors and solver is below " +
                            percent(*request.accuracy.relative_error, 4) + " %");
}

void print_notes(const Diagnostics& notes, bool quiet, std::size_t most) {
  for (const Diagnostic& warning : chosen(notes, makes_results_wrong)) print_diagnostic("warning", warning);
  if (quiet) return;
  const Diagnostics others = chosen(notes, [](DiagnosticCode code) { return !makes_results_wrong(code); });
  const std::size_t shown = std::min(most, others.size());
  for (std::size_t k = 0; k < shown; ++k) print_diagnostic("note", others[k]);
  if (shown < others.size())
    print_message("note", std::to_string(others.size() - shown) +
                              " more notes\nhint: --verbose prints them, --json FILE has them");
}

// A guessed vertical axis: the floors of the model may be walls.
std::string upright(const SceneFacts& scene) {
  if (scene.up_stated) return "";
  return std::string(scene.up.y() > scene.up.z() ? "y" : "z") + " is the vertical axis (guessed), ";
}

std::string summary_of_results(const Report& report, bool long_form, const std::string& how_to_know_errors) {
  std::string text = sensor_lines(report, how_to_know_errors);
  if (!report.accuracy.empty() && report.solution.converged) text += errors(report) + '\n' + advice_on_errors(report);
  if (report.accuracy.empty() && report.form_factors.ray_error)
    text += "error of the rays: " + percent(*report.form_factors.ray_error, 2) +
            " % of the reflected light; the error of the mesh is not known" + how_to_know_errors + '\n';
  else if (report.accuracy.empty())
    text += "errors of mesh and form factors: not known" + how_to_know_errors + '\n';
  if (long_form && report.accuracy.size() > 1) text += steps_table(report.accuracy);
  return text;
}

std::string summary_of_run(const Report& report, bool long_form) {
  std::ostringstream text;
  const Vector& size = report.scene.size;
  text << shown_name(report.scene.file) << ": " << rounded(size.x()) << " x " << rounded(size.y()) << " x "
       << rounded(size.z()) << " m, " << upright(report.scene) << report.scene.polygons << " polygons, "
       << report.patches << " patches with edges up to " << rounded(report.plan.max_edge) << " m\n";
  text << effects_line(report.plan.decisions);
  if (long_form) text << details(report);
  text << convergence(report) << '\n' << energy(report) << '\n' << seconds(report.costs) << '\n';
  return text.str();
}

std::string files_line(const std::vector<std::filesystem::path>& files) {
  std::string line;
  for (const std::filesystem::path& file : files) {
    if (!file.empty()) line += (line.empty() ? "wrote " : ", ") + shown_name(file.string());
  }
  return line + '\n';
}

std::string explain_not_accurate(const Report& report) {
  const AccuracyStep& step = report.accuracy.back();
  const bool by_mesh = step.mesh >= step.form_factor;
  const bool by_solver = step.solver > std::max(step.mesh, step.form_factor);
  if (!std::isfinite(step.solver)) {
    return "accuracy of " + percent(*report.plan.accuracy.relative_error, 3) +
           " % NOT known to be reached: the solver has no error bound, since almost nothing is absorbed\n"
           "hint: lower the largest reflectance, " +
           rounded(report.solution.highest_reflectance, 6);
  }
  std::string text = "accuracy of " + percent(*report.plan.accuracy.relative_error, 3) +
                     " % NOT reached: the error is about " + percent(step.total, 2) + " % after " +
                     rounded(step.seconds) + " s, mainly from the " +
                     (by_solver ? "solver"
                      : by_mesh ? "size of the patches"
                                : "sampling of form factors") +
                     "\nhint: ";
  if (by_solver) return text + "leave --tolerance out, or give a smaller one";
  if (report.plan.accuracy.seconds) return text + "a longer --time-limit, or more --memory if the run ended earlier";
  return text + (by_mesh ? "start with more --patches"
                 : report.plan.assembly.storage == Storage::rays
                     ? "start with more --rays; a lamp close to a surface needs very many"
                     : "start with more --samples");
}

std::string explain_unfinished(const Report& report) {
  const bool wants_errors = has_error_bars(report.plan.accuracy);
  std::string what = "the last mesh that was solved, with an error of about ";
  if (!report.solution.converged) {
    what = "the last iterate of the solver, which has not converged";
  } else if (!report.accuracy.empty()) {
    what += percent(known_error(report.accuracy.back()), 2) + " %";
  } else {
    what = wants_errors ? "the solution of the first mesh, whose errors are not known yet" : "the solution";
  }
  return "UNFINISHED, since the run was stopped: the files have " + what + ", without unfinished sensors and images";
}

std::string explain_not_converged(const Report& report) {
  const Plan& plan = report.plan;
  const SolutionFacts& solution = report.solution;
  if (!solution.trapped.empty()) return "not solved: " + solution.trapped;
  if (solution.stopped_by_rows) {
    return convergence(report) + ": stopped after " + percent(*plan.solver.max_rows, 3) +
           " % of the rows of form factors, as requested. Images include an estimate of the remaining light, other "
           "results do not";
  }
  const std::string asked = "NOT converged to " + rounded(tolerance_of(plan.solver), 2) + ". ";
  const Iteration& last = solution.history.back();
  if (last.relative_residual < 1e-13) {  // rounding
    return asked + "The residual is at rounding level\nhint: a larger --tolerance";
  }
  std::string advice = std::to_string(plan.solver.max_iterations) +
                       " iterations are too few for this solver\nhint: a larger --max-iterations or --tolerance";
  if (solution.highest_reflectance > 0.99) {
    advice += "\nhint: or lower the largest reflectance, " + rounded(solution.highest_reflectance, 6) + ", with --set";
  }
  return asked + advice;
}

double known_error(const AccuracyStep& step) {
  return std::isfinite(step.solver) ? step.total : std::hypot(step.mesh, step.form_factor);
}

std::string errors_in_words(const AccuracyStep& step) {
  return percent(known_error(step), 2) + " % (" + parts(step) + ")" +
         "; variation within patches: " + percent(step.display, 2) + " %";
}

std::string step_in_words(const AccuracyStep& step) {
  return std::to_string(step.patches) + " patches, " + percent(known_error(step), 2) + " % (" + parts(step) + "), " +
         rounded(step.seconds) + " s";
}

}  // namespace patchlight::cli
