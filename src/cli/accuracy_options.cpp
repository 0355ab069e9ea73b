#include "cli/accuracy_options.h"

#include "base/rounded.h"
#include "cli/add_option.h"
#include "cli/parse_value.h"

#include <string>
#include <vector>

namespace patchlight::cli {

void add_refinement_options(CLI::App& command, Request& request) {
  command.option_defaults()->group("Accuracy");
  add(command, "--accuracy", "ERROR",
      "relative error of the patches' mean radiosities, e.g. 1% or 0.01:\npatches and shadow rays are refined where it "
      "pays until the error\nbars are below; begins with --patches, here " +
          std::to_string(first_patches) + " unless given, and\n--samples; default: one mesh",
      [&request](const std::string& text) { request.accuracy.relative_error = relative_error("--accuracy", text); });
  add(command, "--time-limit", "TIME",
      "refines for about so long, e.g. 30s or 2min, or less when\n--accuracy is reached; sensors and pictures come on "
      "top; default:\nno limit",
      [&request](const std::string& text) { request.accuracy.seconds = seconds("--time-limit", text); });
  command
      .add_option(
          "--focus", request.accuracy.interest,
          "material, object, group or room, or a side of one, e.g. room.inside:\nthe error is that of its patches, and "
          "refinement serves them; may be\nrepeated; default: by daylight .inside, all that is enclosed, else all")
      ->allow_extra_args(false)
      ->option_text("NAME");
  request.accuracy.local_cuts = true;
  command
      .add_flag_callback(
          "--no-refine", [&request] { request.accuracy.local_cuts = false; },
          "stays with the first mesh; default: by rows of rays patches are cut,\nand take more rays, where they err "
          "most, if that takes away a third\nof an error above 2 %")
      ->excludes(command.get_option("--accuracy"))
      ->excludes(command.get_option("--time-limit"))
      ->option_text(" ");
}

void add_accuracy_options(CLI::App& command, Request& request) {
  command.option_defaults()->group("Accuracy");
  add_refinement_options(command, request);
  request.accuracy.cheap_error_bars = true;
  CLI::Option* const bars = command.add_flag_callback(
      "--error-bars", [&request] { request.accuracy.error_bars = true; },
      "error bars on every patch: from mesh, form factors and solver;\ndefault: with rows of rays, and up to 5,000 "
      "patches, where they take\nless than half of the run");
  command
      .add_flag_callback(
          "--no-error-bars", [&request] { request.accuracy.cheap_error_bars = false; },
          "no error bars with pairs; rows of rays always have them; default: cheap\nones")
      ->excludes(bars)
      ->option_text(" ");
}

std::optional<std::string> note_on_accuracy(const Request& request) {
  if (!request.accuracy.relative_error) return std::nullopt;
  return "refining to " + percent(*request.accuracy.relative_error, 4) +
         " %: until the errors of mesh, form factors and solver are together about that share of the reflected light";
}

}  // namespace patchlight::cli
