#include "base/parallel.h"
#include "base/words.h"
#include "cli/commands.h"
#include "cli/distinct_files.h"
#include "cli/messages.h"
#include "cli/option_names.h"
#include "cli/progress.h"
#include "cli/summary.h"
#include "output/file/whole_file.h"
#include "output/report/write_checks.h"
#include "pipeline/world.h"
#include "plan/notes.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

namespace patchlight::cli {
namespace {

std::string position(const Point& point) {
  return listed_as(point, [](double coordinate) { return rounded(coordinate, 4); });
}

// A checked patch in the band with the largest difference.
struct Difference {
  Eigen::Index row = 0;
  Eigen::Index band = 0;
  double size = 0;
};

std::vector<Difference> worst_first(const SolvedAndTraced& compared) {
  const Field sizes = deviations(compared).abs();
  std::vector<Difference> differences;
  for (Eigen::Index i = 0; i < sizes.rows(); ++i) {
    Difference difference{i};
    difference.size = sizes.row(i).maxCoeff(&difference.band);
    differences.push_back(difference);
  }
  const auto worse = [](const Difference& a, const Difference& b) { return a.size > b.size; };
  std::stable_sort(differences.begin(), differences.end(), worse);
  return differences;
}

// Larger numbers than 100 standard errors have no further meaning.
std::string standard_errors(double z, int places) {
  if (std::abs(z) > 100) return z > 0 ? "> 100" : "< -100";
  return rounded(z, places);
}

std::string table(const Scene& scene, const PatchMesh& mesh, const Verification& verification) {
  const Bands bands = bands_of(scene);
  std::vector<TextRow> rows{{"place", "object", "material", "side", "position, m", "band", "ours", "bar", "path",
                             "standard error", "z", "z with bar"}};
  const Field z = deviations_by_noise(verification);
  const Field with_bar = deviations(verification);
  for (const auto& [i, band, size] : worst_first(verification)) {
    if (rows.size() > 10) break;
    const PatchIndex patch = verification.patches[static_cast<std::size_t>(i)];
    const Polygon& polygon = scene.polygons[mesh.polygon[patch]];
    rows.push_back(
        {place_of(scene, polygon), group_name(scene, polygon.group), scene.materials[mesh.material[patch]].name,
         name_of(mesh.side[patch]), position(mesh.centroid[patch]), bands[static_cast<std::size_t>(band)].name,
         rounded(verification.irradiance(i, band), 5), rounded(verification.bar(i, band), 2),
         rounded(verification.paths.irradiance(i, band), 5), rounded(verification.paths.standard_error(i, band), 2),
         standard_errors(z(i, band), 2), standard_errors(with_bar(i, band), 2)});
  }
  return text_table(rows);
}

// Root mean square over the finite values.
double root_mean_square(const Field& values) {
  const Field squares = values.isFinite().select(values.square(), 0);
  return std::sqrt(squares.sum() / static_cast<double>(std::max<Eigen::Index>(1, values.isFinite().count())));
}

// The error bars, without the solver's part if it has no bound: an infinite bar would allow any result.
Field known_bars(const ErrorBars& bars) {
  if (bars.solver.allFinite()) return bars.total();
  return (bars.mesh.square() + bars.form_factor.square()).sqrt();
}

// Describes the allowed error of the irradiances.
std::string bars(const std::optional<double>& bar, const Simulation& simulation) {
  if (bar) return "a bar of " + percent(*bar) + " % of the irradiance, or of its mean where that is larger";
  const AccuracyStep& errors = simulation.accuracy.back();
  const bool solver_known = std::isfinite(errors.solver);
  return "the error bars of the patches, " + percent(known_error(errors), 2) + " % as a whole (mesh " +
         percent(errors.mesh, 2) + ", form factors " + percent(errors.form_factor, 2) + ", solver " +
         (solver_known ? percent(errors.solver, 1) : "unknown and not included") + ")";
}

// The typical error of a patch in the band where it is largest. Empty if the paths found almost no light.
std::string typical_error(const VerifiedPart& part) {
  Eigen::Index band = 0;
  const double error = part.error.maxCoeff(&band);
  const double noise = part.noise[band];
  if (!std::isfinite(error) || !std::isfinite(noise)) return {};
  // twice the random error of the square
  const double told = 2 * noise * noise * std::sqrt(2 / static_cast<double>(part.rows.size()));
  const bool is_hidden = error * error < told;
  return "typical error of a patch " +
         (is_hidden ? "is below the noise of the paths, " + percent(noise, 2) + " % (more --paths reduce it)"
                    : percent(error, 2) + " %, without the noise of the paths, " + percent(noise, 2) + " %");
}

// A line with a figure, followed by its meaning if requested.
std::string figure(const std::string& what, const char* tells, bool explained) {
  return what.empty() ? "" : "  " + what + (explained ? std::string(": ") + tells : "") + '\n';
}

// The differences of a part: first the bars, then the deviations.
std::string figures_of(const VerifiedPart& part, bool explained) {
  Eigen::Index band = 0;
  part.offset.abs().maxCoeff(&band);
  const double dark = part.dark.minCoeff();
  std::ostringstream mean, squares;
  mean << std::setprecision(3) << "mean difference " << percent(part.mean_difference[band], 3) << " %, "
       << part.offset[band] << " of its standard errors";
  squares << std::setprecision(3) << "chi-square " << part.chi_square.maxCoeff() << " of "
          << static_cast<double>(part.rows.size()) - dark << " patches in the worst band"
          << (dark > 0 ? ", and " + std::to_string(std::lround(dark)) + " that are dark in both" : std::string());
  return (part.name == "all" ? "" : part.name + ", " + std::to_string(part.rows.size()) + " patches\n") +
         figure("bars " + percent(part.width, 2) + " % of the light", "stated error of the irradiance of these patches",
                explained) +
         figure(typical_error(part), "error of each patch, about the bars or less if the solution is correct",
                explained) +
         figure(mean.str(), "error of the sum, smaller if too bright and too dark patches cancel", explained) +
         figure(
             squares.str(),
             "sum of squared differences over bars and noise, about one per patch or less if the solution is correct",
             explained);
}

// One line for rooms or sensors, with the largest difference.
std::string figures_of(const VerifiedFamily& family) {
  const VerifiedPart& part = family.part;
  const SolvedAndTraced& compared = family.compared;
  const Difference worst = worst_first(compared).front();
  const Eigen::Index i = worst.row;
  Eigen::Index band = 0;
  part.offset.abs().maxCoeff(&band);
  std::ostringstream text;
  text << std::setprecision(3) << part.name << ", " << part.rows.size() << ": mean difference "
       << percent(part.mean_difference[band], 3) << " %, " << part.offset[band]
       << " of its standard errors, chi-square " << part.chi_square.maxCoeff() << "; largest at "
       << shown_name(family.names[static_cast<std::size_t>(i)]) << ": "
       << rounded(compared.irradiance(i, worst.band), 5) << " +- " << rounded(compared.bar(i, worst.band), 2)
       << " W/m^2, by paths " << rounded(compared.paths.irradiance(i, worst.band), 5) << " +- "
       << rounded(compared.paths.standard_error(i, worst.band), 2) << '\n';
  return text.str();
}

std::string figures(const Verification& verification) {
  std::string text;
  for (const VerifiedPart& part : verification.parts) text += figures_of(part, text.empty());
  for (const VerifiedFamily& family : verification.families) text += figures_of(family);
  return text + "z by the noise of the paths alone: root mean square " +
         standard_errors(root_mean_square(deviations_by_noise(verification)), 3) +
         " (1 is noise; larger values are errors, which the bars must cover)\n";
}

std::string sides_left_out(const Scene& scene, const Verification& verification) {
  const auto& sides = verification.left_out;
  if (sides.empty()) return {};
  std::ostringstream text;
  const auto lit = std::count_if(sides.begin(), sides.end(), [](const LeftOutSide& side) { return side.is_lit; });
  text << "sides that --sides auto leaves out: " << sides.size() << " looked at, "
       << (lit == 0 ? "none" : std::to_string(lit)) << " with light\n";
  for (const LeftOutSide& side : sides) {
    if (!side.is_lit) continue;
    const Polygon& polygon = scene.polygons[side.polygon];
    Eigen::Index band = 0;
    side.irradiance.maxCoeff(&band);
    text << "  light on the " << name_of(side.side) << " of " << shown_name(place_of(scene, polygon)) << ", "
         << shown_name(group_name(scene, polygon.group)) << ": " << rounded(side.irradiance[band], 4) << " +- "
         << rounded(side.standard_error[band], 2) << " W/m^2; --sides both takes it in\n";
  }
  return text.str();
}

// Lamps close to large patches spread light too far; the checked patches may not show it.
std::string close_lamps(const Scene& scene, const Simulation& simulation, Verdict verdict) {
  if (notes_on_close_lamps(scene, simulation.world->between_patches(), simulation.plan.max_edge).empty()) return {};
  const std::string note = "see the note close_lamp";
  return verdict == Verdict::agrees ? ", on the patches that were checked: " + note : "; a possible cause: " + note;
}

std::string verdict(const Verification& verification, const std::string& granted, const std::string& doubt) {
  std::ostringstream text;
  const bool differs = verification.verdict == Verdict::disagrees;
  const char* const words[] = {"agrees", "DISAGREES", "INCONCLUSIVE"};
  text << std::setprecision(3) << words[static_cast<std::size_t>(verification.verdict)] << ": with " << granted
       << ", p = " << verification.probability << (verification.probability < least_probability ? " < " : " >= ")
       << least_probability;
  if (differs && verification.probability >= least_probability) text << ", but a side that was left out is lit";
  if (verification.verdict == Verdict::inconclusive) {
    text << ", since error bars above " << percent(widest_bar, 2) << " % prove little";
  }
  text << doubt;
  if (verification.verdict == Verdict::inconclusive)
    text << "\nhint: more --patches, or more --paths if their noise is the larger part";
  return text.str();
}

// The complete report: verdict, extent of the check, figures, and the patches with the largest differences.
std::string answer(const Scene& scene, const Simulation& simulation, const Verification& verification,
                   const std::string& verdict, double seconds) {
  std::ostringstream text;
  text << verdict << '\n'
       << "p is the probability of differences this large where bars and paths are right; below "
       << rounded(least_probability, 3) << " they disagree\n"
       << shown_name(scene.file) << ": " << verification.patches.size() << " of " << simulation.mesh.size()
       << " patches, " << verification.paths.paths << " paths each, "
       << rounded(static_cast<double>(verification.paths.rays), 3) << " rays in " << rounded(seconds, 3) << " s\n"
       << (verification.first_paths == 0 ? ""
                                         : "with " + std::to_string(verification.first_paths) +
                                               " paths each they disagreed, mostly by the noise of these: traced again "
                                               "with more\n")
       << figures(verification) << sides_left_out(scene, verification)
       << "those that differ most, each in its worst band, irradiance in W/m^2:\n"
       << table(scene, simulation.mesh, verification);
  return text.str();
}

// Prints the report; with --quiet only a verdict that is not good.
void tell(const CrosscheckArguments& arguments, const Scene& scene, const Simulation& simulation,
          const Verification& verification, double seconds) {
  const std::string said =
      verdict(verification, bars(arguments.bar, simulation), close_lamps(scene, simulation, verification.verdict));
  print_notes(notes(scene, simulation), arguments.quiet);
  if (!arguments.quiet) {
    std::cout << answer(scene, simulation, verification, said, seconds) << std::flush;
  } else if (verification.verdict != Verdict::agrees) {
    print_message("warning", said);
  }
}

}  // namespace

ExitCode run(const CrosscheckArguments& arguments) {
  if (!arguments.json.empty()) check_writable(arguments.json);
  const ThreadLimit limit(arguments.request.resources.threads);
  print_note_on_accuracy(arguments.request, arguments.quiet);
  ProgressLine line(progress_shown(arguments.quiet));
  const Observer observer = observer_on(line);

  // 1. Solve
  const Scene scene = read_models(arguments.models, arguments.read, observer);
  require_not_read({{"--json", arguments.json}}, scene.inputs);
  line.expect({Stage::read, Stage::plan, Stage::mesh, Stage::form_factors, Stage::closure, Stage::direct_light,
               Stage::solve, Stage::error_bars, Stage::trace_paths},
              refines(arguments.request.accuracy) ? 0.2 : 1, arguments.request.accuracy.seconds);
  Steps with;
  with.look = [&line](const Simulation& solved) {
    line.next_mesh(solved.accuracy.back().total, solved.plan.accuracy.relative_error);
  };
  const Simulation simulation = with_option_names(simulate(scene, arguments.request, observer, with));
  const Report report = report_of(scene, arguments.request, simulation);
  if (!simulation.solution.converged) {
    line.hide();
    print_message("warning", "not verified: " + explain_not_converged(report));
    return not_converged;
  }

  // 2. Trace paths, and compare
  const double begin = wall_seconds();
  const Field bar = arguments.bar ? irradiance_bar(simulation, *arguments.bar) : known_bars(*simulation.error_bars);
  const Verification verification = patchlight::verify(scene, simulation, bar, arguments.options, observer);
  const double seconds = wall_seconds() - begin;
  line.hide();
  const WritingGuard guard;
  if (!arguments.json.empty()) {
    write_verification(arguments.json, scene, simulation, verification, {.command_line = arguments.command_line});
  }
  tell(arguments, scene, simulation, verification, seconds);
  if (verification.verdict != Verdict::agrees) return validation_failed;
  if (is_accurate(report)) return good;
  print_message("warning", explain_not_accurate(report));
  return not_converged;
}

}  // namespace patchlight::cli
