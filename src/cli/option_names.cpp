#include "cli/option_names.h"

#include "patchlight/base/error.h"

#include "cli/arguments.h"
#include "plan/check_request.h"

#include <algorithm>
#include <cctype>

namespace patchlight::cli {
namespace {

// Fields with one of their values come before the fields alone.
const std::vector<OptionName>& usual_names() {
  static const std::vector<OptionName> names = {{"read.settings", "--set"},
                                                {"read.up", "--up"},
                                                {"read.daylight.sky", "--sky"},
                                                {"read.daylight.sun", "--sun"},
                                                {"read.daylight.weather", "--weather"},
                                                {"read.daylight.ground", "--ground"},
                                                {"read.only", "--only"},
                                                {"read.leave_out", "--exclude"},
                                                {"read.confine", "--confine"},
                                                {"read.metres_per_unit=0.0254", "--unit in"},
                                                {"read.metres_per_unit=0.3048", "--unit ft"},
                                                {"read.metres_per_unit=0.001", "--unit mm"},
                                                {"read.metres_per_unit=0.01", "--unit cm"},
                                                {"read.metres_per_unit=1", "--unit m"},
                                                {"read.metres_per_unit", "--unit"},
                                                {"mesh.max_edge", "--max-edge"},
                                                {"mesh.patches", "--patches"},
                                                {"mesh.sides", "--sides"},
                                                {"assembly.storage=on_demand", "--method on-demand"},
                                                {"assembly.storage=on-demand", "--method on-demand"},
                                                {"assembly.storage=auto", "--method auto"},
                                                {"assembly.storage=rays", "--method rays"},
                                                {"assembly.storage=tiles", "--method pairs"},
                                                {"assembly.storage", "--method"},
                                                {"assembly.rays", "--rays"},
                                                {"assembly.close=false", "--no-closure"},
                                                {"assembly.estimator", "--estimator"},
                                                {"assembly.samples", "--samples"},
                                                {"assembly.short_cuts", "--without"},
                                                {"effects.force", "--enable"},
                                                {"effects.skip", "--disable"},
                                                {"solver.solver", "--solver"},
                                                {"solver.max_rows", "--max-rows"},
                                                {"solver.relaxation", "--relaxation"},
                                                {"accuracy.relative_error", "--accuracy"},
                                                {"accuracy.seconds", "--time-limit"},
                                                {"accuracy.interest", "--focus"},
                                                {"accuracy.error_bars", "--error-bars"},
                                                {"accuracy.local_cuts=false", "--no-refine"},
                                                {"resources.memory", "--memory"},
                                                {"lightmap.texel", "--texel"},
                                                {"lightmap.folder", "--lightmap"},
                                                {"given.form_factors", "--form-factors"},
                                                {"given.ray_rows", "--form-factors"},
                                                {"compare.relaxation", "--relaxation"},
                                                {"compare.contestants", "--solvers"}};
  return names;
}

bool is_of_word(char letter) { return std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '_'; }

// Names in a model and of files are quoted, or are parts of longer words.
bool begins_a_word(const std::string& text, std::size_t k) {
  return k == 0 || (!is_of_word(text[k - 1]) && std::string("./\\'-").find(text[k - 1]) == std::string::npos);
}

bool ends_a_word(const std::string& text, std::size_t end) {
  const bool goes_on = end + 1 < text.size() && text[end] == '.' && is_of_word(text[end + 1]);
  return end == text.size() || (!is_of_word(text[end]) && !goes_on);
}

// The name of the field at `begin`, if any.
const OptionName* name_at(const std::string& text, std::size_t begin, std::span<const OptionName> names) {
  if (!begins_a_word(text, begin)) return nullptr;
  const auto found = std::find_if(names.begin(), names.end(), [&](const OptionName& name) {
    return text.compare(begin, name.field.size(), name.field) == 0 && ends_a_word(text, begin + name.field.size());
  });
  return found == names.end() ? nullptr : &*found;
}

}  // namespace

std::string with_option_names(const std::string& text, std::span<const OptionName> other) {
  std::string result;
  for (std::size_t k = 0; k < text.size();) {
    const OptionName* name = name_at(text, k, other);
    if (name == nullptr) name = name_at(text, k, usual_names());
    if (name == nullptr) {
      result += text[k++];
      continue;
    }
    result += name->option;
    k += name->field.size();
    // "--sides both" in place of "mesh.sides=both"
    if (k < text.size() && text[k] == '=') {
      result += ' ';
      ++k;
    }
  }
  return result;
}

Diagnostics with_option_names(Diagnostics diagnostics) {
  for (Diagnostic& found : diagnostics) found.text = with_option_names(found.text);
  return diagnostics;
}

Scene with_option_names(Scene scene) {
  scene.diagnostics = with_option_names(std::move(scene.diagnostics));
  return scene;
}

Plan with_option_names(Plan plan) {
  plan.notes = with_option_names(std::move(plan.notes));
  plan.sides.notes = with_option_names(std::move(plan.sides.notes));
  for (Decision& decision : plan.decisions) {
    decision.reason = with_option_names(decision.reason);
    decision.saving = with_option_names(decision.saving);
  }
  return plan;
}

Simulation with_option_names(Simulation simulation) {
  simulation.plan = with_option_names(std::move(simulation.plan));
  simulation.notes = with_option_names(std::move(simulation.notes));
  return simulation;
}

void check_with_names(const Request& request, std::span<const OptionName> other) {
  try {
    check(request);
  } catch (const InputError& error) {
    throw UsageError(with_option_names(error.what(), other));
  }
}

}  // namespace patchlight::cli
