#include "cli/accuracy_options.h"

#include "cli/add_option.h"
#include "cli/parse_value.h"
#include "cli/text_table.h"

#include <string>
#include <vector>

namespace patchlight::cli {

void add_refinement_options(CLI::App& command, Request& request) {
  add(command, "--accuracy", "ERROR",
      "relative error of the patches' mean radiosities, e.g. 1% or 0.01:\npatches and shadow rays are refined where it "
      "pays until the error\nbars are below; begins with --patches, here " +
          std::to_string(first_patches) + " unless given, and\n--samples; default: one mesh",
      [&request](const std::string& text) { request.accuracy = relative_error("--accuracy", text); });
  add(command, "--time", "TIME",
      "refines for about so long, e.g. 30s or 2min, or less when\n--accuracy is reached; default: no limit",
      [&request](const std::string& text) { request.seconds = seconds("--time", text); });
  command
      .add_option(
          "--interest", request.interest,
          "material, object or group, or a side of one, e.g. room.inside:\nthe error is that of its patches, and "
          "refinement serves them; may be\nrepeated; default: all")
      ->allow_extra_args(false)
      ->option_text("NAME");
}

void add_accuracy_options(CLI::App& command, Request& request) {
  add_refinement_options(command, request);
  command.add_flag_callback(
      "--error-bars", [&request] { request.error_bars = true; },
      "error bars on every patch: from mesh, form factors and solver; as\nlong again as the solution; default: only "
      "with --accuracy or --time");
}

std::optional<std::string> note_on_accuracy(const Request& request) {
  if (!request.accuracy) return std::nullopt;
  return "refining to " + percent(*request.accuracy, 4) +
         " %: until the errors of mesh, form factors and solver are together about that share of the reflected light";
}

std::optional<std::string> option_without_error_bars(const Request& request, const std::string& form_factors) {
  if (!keeps_entries(request.storage)) return "--on-demand";
  if (!form_factors.empty()) return "--form-factors";
  if (!request.close) return "--no-closure";
  if (contains(request.skip, Effect::closure)) return "--skip closure";
  if (contains(request.skip, Effect::interreflection)) return "--skip interreflection";
  if (request.estimator != Estimator::automatic) return "--estimator";
  if (request.max_rows) return "--max-rows";
  return std::nullopt;
}

void require_error_bars_possible(const Request& request, const std::string& form_factors) {
  const char* const option = request.accuracy     ? "--accuracy"
                             : request.seconds    ? "--time"
                             : request.error_bars ? "--error-bars"
                                                  : nullptr;
  if (option == nullptr) {
    if (request.interest.empty()) return;
    throw UsageError("--interest needs --accuracy, --time or --error-bars");
  }
  const std::optional<std::string> other = option_without_error_bars(request, form_factors);
  if (!other) return;
  throw UsageError(*other + " and " + option + " exclude each other; give one of them");
}

}  // namespace patchlight::cli
