#include "cli/summary.h"

#include "cli/messages.h"
#include "cli/text_table.h"
#include "transport/worst_rows.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace patchlight::cli {
namespace {

// Values per band, for three bands as R, G, B.
std::string bands(const Eigen::ArrayXd& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + rounded(value);
  return text;
}

std::string convergence(const Plan& plan, const Solution& solution) {
  const Iteration& last = solution.history.back();
  std::ostringstream text;
  text << name_of(plan.solver.solver) << ": " << (solution.converged ? "converged" : "NOT converged") << " after "
       << last.number << (is_shooting(plan.solver.solver) ? " shot" : " iteration") << (last.number == 1 ? "" : "s")
       << " (" << rounded(last.work) << " operator applications)";
  if (std::isfinite(last.error_bound)) {
    text << ", solver error at most " << rounded(last.error_bound, 2) << " as a whole";
    if (std::isfinite(solution.patch_bound)) text << ", " << rounded(solution.patch_bound, 2) << " patch by patch";
  } else {
    text << ", relative residual " << rounded(last.relative_residual, 2) << " (no bound on the error is known)";
  }
  return text.str();
}

std::string percent(double share, int digits = 2) { return rounded(100 * share, digits); }

std::string parts(const AccuracyStep& step) {
  return percent(step.total) + " %: mesh " + percent(step.mesh) + ", form factors " + percent(step.form_factor) +
         ", solver " + percent(step.solver, 1) + "; drawn with one value a patch " + percent(step.display) + " %";
}

// How far off the patches' means may be, and what is drawn with them.
std::string errors(const Simulation& simulation) {
  const AccuracyStep& step = simulation.accuracy.back();
  std::string on;
  for (const std::string& name : simulation.plan.interest) on += (on.empty() ? " on " : ", ") + name;
  std::string text = "error of the patches' means" + on + " about " + parts(step);
  for (const auto& [space, part] : simulation.spaces) {
    text += "\n  " + space + ", " + std::to_string(part.patches) +
            " patches, of the light that is reflected there: " + parts(part);
  }
  return text;
}

// The meshes on the way to an accuracy.
std::string steps_table(const std::vector<AccuracyStep>& steps) {
  std::vector<TextRow> rows{
      {"patches", "of these new", "samples", "mesh %", "form factors %", "solver %", "total %", "s", "CPU s"}};
  for (const AccuracyStep& step : steps) {
    rows.push_back({std::to_string(step.patches), std::to_string(step.new_patches), std::to_string(step.samples),
                    percent(step.mesh), percent(step.form_factor), percent(step.solver), percent(step.total),
                    rounded(step.seconds), rounded(step.cpu_seconds)});
  }
  return text_table(rows);
}

std::string energy(const Simulation& simulation) {
  const EnergyBalance& balance = simulation.balance;
  const bool row_sums_known = simulation.transport.row_sum.size() > 0;
  std::ostringstream text;
  text << "flux in W per band: emitted " << bands(balance.emitted)
       << ((balance.arriving > 0).any() ? "; arriving from luminaires, sun and sky " + bands(balance.arriving) : "")
       << "; absorbed " << bands(balance.absorbed) << "; escaped " << bands(balance.escaped) << "; lost at backs "
       << bands(balance.lost_at_backs)
       << (row_sums_known ? "; form factor defect " + bands(balance.defect) + "; imbalance "
                          : "; imbalance with the form factor defect ")
       << rounded(balance.imbalance, 2);
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

std::string worst_patches(const Scene& scene, const Simulation& simulation) {
  constexpr std::size_t count = 5;
  const PatchMesh& mesh = simulation.mesh;
  std::ostringstream text;
  text << "patches whose row sums were farthest off before closure, by area:\n";
  for (const RowDefect& row :
       worst_rows(simulation.transport.raw_row_sum, simulation.transport.lost, simulation.problem.area, count)) {
    const Polygon& polygon = scene.polygons[mesh.polygon[row.patch]];
    const Point& centre = mesh.centroid[row.patch];
    text << "  " << place_of(scene, polygon) << ", face " << polygon.face << " of " << group_name(scene, polygon.group)
         << ", material " << shown_name(scene.materials[mesh.material[row.patch]].name) << ", at "
         << bands(centre.array()) << " m: " << rounded(row.row_sum, 6) << ", expected " << rounded(row.expected, 6)
         << '\n';
  }
  return text.str();
}

// What the whole matrix has shown.
std::string assembly(const Scene& scene, const Simulation& simulation) {
  std::ostringstream text;
  const AssemblyCounts& counts = simulation.transport.counts;
  text << "pairs of patches: " << counts.facing_pairs << " facing, of these " << counts.near_pairs << " near, "
       << counts.partial_pairs << " partly and " << counts.blocked_pairs << " fully occluded\n";
  text << "shadow rays: " << counts.shadow_rays;
  for (const StageCost& cost : simulation.costs) {
    if (cost.stage == Stage::form_factors && cost.seconds > 0) {
      const double rate = static_cast<double>(counts.shadow_rays) / cost.seconds;
      text << ", " << rounded(1e-6 * rate) << " million per second";
      const double bare = simulation.transport.bare_rays_per_second;
      if (bare > 0) text << ", " << rounded(100 * rate / bare, 2) << " % of what Embree alone does";
    }
  }
  const SamplingError& error = simulation.transport.error;
  if (was_audited(error)) {
    text << "\nsampled form factors: standard error " << rounded(100 * standard_error(error, 0.5), 2)
         << " % of the unoccluded value for half hidden pairs with a form factor below 1/256; where rays agreed, 95 % "
            "are within "
         << rounded(100 * bound_on_miss(error.visible), 2) << " % (seen) and "
         << rounded(100 * bound_on_miss(error.occluded), 2) << " % (hidden)";
  }
  text << "\nrow sums before closure: " << rounded(simulation.transport.raw_row_sum.minCoeff(), 6) << " to "
       << rounded(simulation.transport.raw_row_sum.maxCoeff(), 6) << "; closure: " << simulation.transport.closure
       << '\n'
       << worst_patches(scene, simulation);
  return text.str();
}

std::string details(const Scene& scene, const Simulation& simulation) {
  std::ostringstream text;
  for (const Decision& decision : simulation.plan.decisions) {
    text << sentence(decision) << '\n';
  }
  text << "estimator of form factors: " << name_of(simulation.plan.estimator) << '\n';
  if (keeps_entries(simulation.plan.storage)) return text.str() + assembly(scene, simulation);
  return text.str() + "rows of form factors: computed on demand; pairs, rays and row sums are not known\n";
}

// "effects: occlusion, closure; left out: colour, sun; by force: closure"
std::string effects_line(const std::vector<Decision>& decisions) {
  std::string on, off, forced;
  for (const Decision& decision : decisions) {
    std::string& list = decision.simulate ? on : off;
    list += (list.empty() ? "" : ", ") + std::string(name_of(decision.effect));
    if (decision.forced) forced += (forced.empty() ? "" : ", ") + std::string(name_of(decision.effect));
  }
  return "effects: " + (on.empty() ? "none" : on) + (off.empty() ? "" : "; left out: " + off) +
         (forced.empty() ? "" : "; by force: " + forced) + '\n';
}

// True when --max-rows ended the solution, not --max-iterations.
bool stopped_by_rows(const Simulation& simulation) {
  const SolverOptions& options = simulation.plan.solver;
  const auto shots = static_cast<double>(simulation.solution.history.back().number);
  return options.max_rows && shots < static_cast<double>(options.max_iterations) * simulation.mesh.size();
}

}  // namespace

std::vector<std::string> notes(const Scene& scene, const Simulation& simulation) {
  std::vector<std::string> all = scene.notes;
  const std::vector<std::string>& of_sides = simulation.plan.sides.notes;
  all.insert(all.end(), of_sides.begin(), of_sides.end());
  all.insert(all.end(), simulation.plan.notes.begin(), simulation.plan.notes.end());
  return all;
}

std::string summary(const Scene& scene, const Simulation& simulation, bool long_form) {
  std::ostringstream text;
  const Vector size = bounds(scene).diagonal();
  text << shown_name(scene.file) << ": " << rounded(size.x()) << " x " << rounded(size.y()) << " x "
       << rounded(size.z()) << " m, " << scene.polygons.size() << " polygons, " << simulation.mesh.size()
       << " patches with edges up to " << rounded(simulation.plan.max_edge) << " m\n";
  text << effects_line(simulation.plan.decisions);
  if (long_form) text << details(scene, simulation);
  text << convergence(simulation.plan, simulation.solution) << '\n';
  if (!simulation.accuracy.empty() && simulation.solution.converged) text << errors(simulation) << '\n';
  if (long_form && simulation.accuracy.size() > 1) text << steps_table(simulation.accuracy);
  text << energy(simulation) << '\n';
  text << seconds(simulation.costs) << '\n';
  return text.str();
}

std::string files_line(const std::vector<std::filesystem::path>& files) {
  std::string line;
  for (const std::filesystem::path& file : files) line += (line.empty() ? "wrote " : ", ") + shown_name(file.string());
  return line + '\n';
}

bool is_accurate(const Simulation& simulation) {
  const std::optional<double>& asked = simulation.plan.accuracy;
  return !asked || (!simulation.accuracy.empty() && simulation.accuracy.back().total <= *asked);
}

std::string explain_not_accurate(const Simulation& simulation) {
  const AccuracyStep& step = simulation.accuracy.back();
  const bool by_mesh = step.mesh >= step.form_factor;
  const bool by_solver = step.solver > std::max(step.mesh, step.form_factor);
  std::string text = "accuracy of " + percent(*simulation.plan.accuracy, 3) + " % NOT reached: the error is about " +
                     percent(step.total) + " % after " + rounded(step.seconds) + " s; most of it is from the " +
                     (by_solver ? "solver"
                      : by_mesh ? "size of the patches"
                                : "sampling of form factors") +
                     ". ";
  if (by_solver) return text + "Give a smaller --tolerance, or none: then it is what the accuracy takes";
  if (simulation.plan.seconds) return text + "Give a longer --time, or more --memory if it ended before";
  return text + (by_mesh
                     ? "Begin with more --patches"
                     : "Begin with more --samples, unless it is of luminaires, sun or sky (error_direct_irradiance)");
}

std::string explain_not_converged(const Simulation& simulation) {
  const Plan& plan = simulation.plan;
  if (!simulation.solution.trapped.empty()) return "not solved: " + simulation.solution.trapped;
  if (stopped_by_rows(simulation)) {
    return convergence(plan, simulation.solution) + ": stopped after " + rounded(100 * *plan.solver.max_rows) +
           " % of the rows of form factors, as asked for. A picture shows an estimate of the light still under way, "
           "other results what has arrived";
  }
  const std::string asked = "NOT converged to " + rounded(plan.solver.relative_error, 2) + ". ";
  const Iteration& last = simulation.solution.history.back();
  constexpr double rounding = 1e-13;
  if (last.relative_residual < rounding) {
    return asked + "The residual has come down to rounding: no solver gets nearer; give a larger --tolerance";
  }
  std::string advice = std::to_string(plan.solver.max_iterations) +
                       " iterations are too few for this solver: try a larger --max-iterations or --tolerance";
  const double highest = simulation.problem.reflectance.maxCoeff();
  constexpr double nearly_all = 0.99;
  if (highest > nearly_all) {
    advice += "; or lower the largest reflectance, " + rounded(highest, 6) + ", with --set: light hardly gets lost";
  }
  return asked + advice;
}

}  // namespace patchlight::cli
