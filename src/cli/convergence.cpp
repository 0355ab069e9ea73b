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
#include "study/study.h"

#include <iostream>
#include <sstream>

namespace patchlight::cli {
namespace {

// An error that is not above what the reference is good to is told with a question mark.
std::string judged(double error, const Study& study) {
  return percent(error) + (error > 0 && error <= study.reference.bar ? "?" : "");
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
         << rounded(reference.cpu_seconds) << " CPU seconds), itself good to " << percent(reference.bar) << " %";
  }
  text << "\nerror: of the patch means; display: of the field, constant on each patch; own: due to the swept quantity "
          "alone; *: on the Pareto front of error and CPU seconds\n"
       << (reference.bar > 0 ? "?: not known, as the reference is no better than that\n" : "")
       << "at the finest setting: mesh " << percent(study.parts.mesh) << " %, form factors "
       << percent(study.parts.form_factors) << " %, solver " << percent(study.parts.solver) << " %\n";
  return text.str();
}

}  // namespace

ExitCode convergence(const ConvergenceArguments& arguments) {
  check_study_writable(arguments.output);
  if (!arguments.page.empty()) check_writable(arguments.page);
  const ThreadLimit limit(arguments.request.resources.threads);
  ProgressLine line(progress_shown(arguments.quiet));
  const Observer observer = observer_on(line);

  // 1. Read the model, solve it in many ways
  const Scene scene = read_models(arguments.models, arguments.read, observer);
  require_not_read_from({"-o", arguments.output}, scene.inputs);
  require_not_read({{"--html", arguments.page}}, scene.inputs);
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
