#include "base/parallel.h"
#include "base/rounded.h"
#include "cli/commands.h"
#include "cli/distinct_files.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/option_names.h"
#include "cli/summary.h"
#include "mesh/nested_mesh.h"
#include "output/file/whole_file.h"
#include "output/report/write_checks.h"
#include "pipeline/expected_cost.h"
#include "pipeline/first_mesh.h"
#include "pipeline/local_cuts.h"
#include "plan/check_request.h"
#include "plan/memory.h"
#include "scene/model_face.h"

#include <iomanip>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

namespace patchlight::cli {
namespace {

const char* word_for(const Decision& decision) {
  if (decision.forced) return decision.simulate ? "on, by force" : "off, by force";
  return decision.simulate ? "on" : "off";
}

// Those that say which surfaces take part, and no property of light.
bool is_of_surfaces(Effect effect) { return effect == Effect::reach || effect == Effect::backs; }

// Two lines for each: the fact that decides, and what that costs or saves.
std::string lines_of(const std::vector<Decision>& decisions, bool of_surfaces) {
  constexpr int width = 17;
  std::ostringstream text;
  for (const Decision& decision : decisions) {
    if (is_of_surfaces(decision.effect) != of_surfaces) continue;
    text << std::left << std::setw(width) << name_of(decision.effect) << word_for(decision) << ": "
         << with_option_names(decision.reason) << '\n'
         << std::setw(width) << "" << (decision.simulate ? "takes: " : "saves: ") << decision.saving << '\n';
  }
  return text.str();
}

std::string cost_lines(const ExpectedCost& cost) {
  const std::string first = cost.of_first_mesh ? "patches and shadow rays are chosen while solving; the first mesh "
                                                 "alone is expected to take "
                                               : "expected: ";
  return first + std::to_string(cost.patches) + " patches, " + rounded(cost.bytes / 1e9, 2) + " GB, about " +
         rounded(cost.seconds(), 2) + " s on " + std::to_string(cost.threads) +
         (cost.threads == 1 ? " thread" : " threads") + " (an estimate, right to a factor of two or so)\n" +
         "processor seconds: form factors " + rounded(cost.form_factor_seconds, 2) + ", direct light " +
         rounded(cost.direct_light_seconds, 2) + ", closure and solution " + rounded(cost.solve_seconds, 2) + '\n';
}

// What the estimate does not hold.
std::string further_costs(const Plan& plan, const ExpectedCost& cost) {
  const auto patches = static_cast<PatchIndex>(cost.patches);
  const bool has_second_mesh = makes_second_mesh(plan, patches) && fits_as_next_mesh(patches, 1, plan);
  const std::string sensors = cost.sensors == 0
                                  ? ""
                                  : counted(cost.sensors, "sensor") + " of about " + rounded(cost.sensor_seconds, 2) +
                                        (cost.of_first_mesh ? " processor seconds or more, " : " processor seconds, ");
  return std::string("in addition: ") + (has_error_bars(plan.accuracy) ? "error bars, " : "") +
         (has_second_mesh ? "a second mesh where the first errs by more than 2 %, " : "") + sensors +
         "requested images and pages" +
         (plan.accuracy.seconds ? "; --time-limit does not include sensors and images" : "") + "\n";
}

}  // namespace

ExitCode plan(const PlanArguments& arguments) {
  if (!arguments.json.empty()) check_writable(arguments.json);
  const ThreadLimit limit(arguments.request.resources.threads);
  const Scene scene = read_scene(arguments.models, arguments.read);
  print_scene_warnings(scene);
  require_not_read({{"--json", arguments.json}}, scene.inputs);
  check(arguments.request, scene);
  const Plan planned = make_plan(scene, arguments.request);
  require_memory(scene, arguments.request, planned);
  const NestedMesh mesh = first_mesh(scene, planned);
  require_memory(mesh.patches.size(), arguments.request, planned);
  const Plan plan = with_note_on_second_mesh(planned, mesh.patches.size());
  const ExpectedCost cost = expected_cost(scene, plan, mesh.patches);

  const WritingGuard guard;
  if (!arguments.json.empty()) write_plan(arguments.json, scene, plan, cost);
  print_notes(merged({remarks_of(scene), plan.sides.notes, plan.notes}), false);
  std::cout << shown_name(scene.file) << ": " << scene.polygons.size() << " polygons\n"
            << "effects of light\n"
            << lines_of(plan.decisions, false) << "sides of surfaces that no light reaches: on, they take part\n"
            << lines_of(plan.decisions, true) << cost_lines(cost) << further_costs(plan, cost) << std::flush;
  return good;
}

}  // namespace patchlight::cli
