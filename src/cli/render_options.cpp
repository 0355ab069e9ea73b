#include "cli/render_options.h"

#include "base/lower_case.h"
#include "base/shell_word.h"
#include "cli/add_option.h"
#include "cli/distinct_files.h"
#include "cli/lightmap_options.h"
#include "cli/model_options.h"
#include "cli/page_option.h"
#include "cli/parse_value.h"
#include "cli/picture_options.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace patchlight::cli {
namespace {

void require_solution(const std::string& option, const std::string& text) {
  if (text.ends_with(".vtu"))
    throw refusal(
        option, text,
        "a name that ends in .vtp: grids (.vtu) have no facts that are texts, which pictures need; patchlight "
        "solve writes both with -o RESULT.vtu -o RESULT.vtp");
  if (!text.ends_with(".vtp")) throw refusal(option, text, "a name that ends in .vtp");
}

}  // namespace

struct RenderOptionsGiven {
  ModelOptions model;
  PictureGiven picture;
  LightmapGiven lightmap;
  std::string solution, observers, difference, page;
  int threads = 0;
  bool quiet = false;
};

std::shared_ptr<RenderOptionsGiven> add_render(CLI::App& tool) {
  auto options = std::make_shared<RenderOptionsGiven>();
  RenderOptionsGiven& to = *options;
  CLI::App& command = *tool.add_subcommand("render", "takes pictures of a solution that is there, without solving");
  add_model_options(command, to.model);
  add(command, "--solution", "FILE", "what patchlight solve has written for this model (.vtp)",
      [&to](const std::string& text) {
        require_solution("--solution", text);
        to.solution = text;
      });
  command.option_defaults()->group("Results and pictures");
  add(command, "-o,--output", "FILE",
      "the picture (.png), or its radiances (.hdr, .exr); of several\nviews each gets its name before the extension",
      [&to](const std::string& text) {
        if (text.empty()) throw refusal("-o", text, "the name of a file");
        to.picture.file = text;
      });
  add_picture_options(command, to.picture, PictureQuality::final);
  add(command, "--difference", "FILE",
      "another solution of this model, as with other patches (.vtp):\nboth beside each other, and by how much their "
      "luminances differ\nin false colors",
      [&to](const std::string& text) {
        require_solution("--difference", text);
        to.difference = text;
      });
  add(command, "--observers", "FILE",
      "vertical and cylindrical illuminance, background luminance and\nUGR at the cameras of the scene file, or at "
      "those of\n--view or --camera (.csv)",
      [&to](const std::string& text) {
        if (!text.ends_with(".csv")) throw refusal("--observers", text, "a name that ends in .csv");
        to.observers = text;
      });
  add_lightmap_options(command, to.lightmap);
  add_page_option(command, to.page);
  command.option_defaults()->group("The run");
  add(command, "--threads", "N", "number of threads; default 0: one per processor",
      [&to](const std::string& text) { to.threads = static_cast<int>(whole_number("--threads", text, 0, 1024)); });
  command.add_flag("-q,--quiet", to.quiet, "prints errors and warnings only; default: progress and the files");
  return options;
}

namespace {

// What to do without a solution; it may stand in the place of the model.
std::string without_solution(const std::vector<std::string>& models) {
  const auto is_result = [](const std::string& file) { return in_lower_case(file).ends_with(".vtp"); };
  const auto result = std::find_if(models.begin(), models.end(), is_result);
  if (result == models.end())
    return "found no solution; expected --solution RESULT.vtp, which patchlight solve has written";
  return "found the solution " + *result +
         " in the place of the model; expected the model that was solved: patchlight render MODEL --solution " +
         shell_word(*result) + " -o VIEW.png";
}

}  // namespace

RenderArguments finish_render(const RenderOptionsGiven& options) {
  if (options.model.models.empty())
    throw UsageError("render: found no model; expected: patchlight render MODEL --solution RESULT.vtp -o VIEW.png");
  if (options.solution.empty()) throw UsageError("render: " + without_solution(options.model.models));
  if (options.picture.file.empty() && options.observers.empty() && options.lightmap.folder.empty())
    throw UsageError("render: nothing would be written; expected -o VIEW.png, --observers or --lightmap");
  if (options.picture.file.empty() && !options.page.empty())
    throw UsageError("--html shows the pictures of patchlight render; expected -o VIEW.png");
  if (!options.difference.empty() && (!options.picture.file.ends_with(".png") || options.picture.colors))
    throw UsageError("--difference is written as a picture in natural colors; expected -o FILE.png");
  RenderArguments arguments;
  arguments.models = model_files(options.model);
  arguments.read = read_options(options.model);
  arguments.solution = options.solution;
  arguments.page = options.page;
  arguments.observers = options.observers;
  arguments.difference = options.difference;
  arguments.lightmap = lightmap_settings(options.lightmap);
  PictureGiven given = options.picture;
  given.for_observers = !options.observers.empty();
  arguments.picture = picture_settings(given, "-o", PictureQuality::final);
  arguments.threads = options.threads;
  arguments.quiet = options.quiet;
  std::vector<std::filesystem::path> read = arguments.models;
  read.push_back(arguments.solution);
  if (!arguments.difference.empty()) read.push_back(arguments.difference);
  std::vector<OutputFile> outputs = picture_files(arguments.picture, "-o");
  outputs.push_back({"--observers", arguments.observers});
  outputs.push_back({"--html", arguments.page});
  require_outside_lightmap(arguments.lightmap, outputs);
  outputs.push_back({"--lightmap", arguments.lightmap.folder});
  require_distinct(outputs);
  require_not_read(outputs, read);
  if (!arguments.lightmap.folder.empty()) require_not_read_from({"--lightmap", arguments.lightmap.folder}, read);
  return arguments;
}

}  // namespace patchlight::cli
