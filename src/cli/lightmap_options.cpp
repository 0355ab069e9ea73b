#include "cli/lightmap_options.h"

#include "base/rounded.h"
#include "cli/add_option.h"
#include "cli/parse_value.h"
#include "output/image/write_lightmap.h"

#include <system_error>

namespace patchlight::cli {

void add_lightmap_options(CLI::App& command, LightmapGiven& given) {
  add(command, "--lightmap", "FOLDER",
      "light gathered at texels, for engines that show the model in real\ntime: irradiance as .exr and .png, the model "
      "with its place in\nthem, and with the light as its colors (.glb); default: none",
      [&given](const std::string& text) {
        if (text.empty()) throw refusal("--lightmap", text, "the name of a folder");
        given.folder = text;
      });
  add(command, "--texel", "LENGTH",
      "edge of the texels of a lightmap, as in 5cm; default: the smallest\nfor a map of 256 x 256 texels, or more "
      "where "
      "there are many faces",
      [&given](const std::string& text) { given.texel = length("--texel", text); });
}

LightmapSettings lightmap_settings(const LightmapGiven& given) {
  if (given.texel && given.folder.empty()) throw UsageError("--texel needs --lightmap FOLDER");
  return {given.folder, {given.texel}};
}

void require_outside_lightmap(const LightmapSettings& settings, const std::vector<OutputFile>& outputs) {
  if (settings.folder.empty()) return;
  std::error_code error;
  const auto folder = weakly_canonical(absolute(settings.folder) / ".", error);
  for (const auto& [option, file] : outputs) {
    if (error || file.empty() || weakly_canonical(absolute(file), error).parent_path() / "." != folder / ".") continue;
    throw UsageError(option + ": '" + file.string() + "' lies in the folder of --lightmap; expected a file elsewhere");
  }
}

std::string lightmap_line(const Lightmap& map, const LightmapSettings& settings) {
  const bool is_coarser = settings.options.texel && map.texel > *settings.options.texel;
  return "lightmap: " + std::to_string(map.width) + " x " + std::to_string(map.height) + " texels of " +
         rounded(100 * map.texel) + " cm, " + (is_coarser ? "smaller ones do not fit into the largest map, " : "") +
         std::to_string(map.charts.size()) + (map.charts.size() == 1 ? " chart, " : " charts, ") +
         rounded(static_cast<double>(bytes_of(map)) / 1e6) + " MB of memory\n";
}

}  // namespace patchlight::cli
