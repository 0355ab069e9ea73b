#include "output/write_lightmap.h"

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/output/write_image.h"

#include "output/json_array.h"
#include "output/lightmap_glb.h"
#include "output/lightmap_picture.h"
#include "output/whole_folder.h"
#include "output/write_bytes.h"
#include "output/write_exr.h"
#include "render/lightmap_charts.h"
#include "render/tone_map.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

namespace fs = std::filesystem;

constexpr const char* lightmap_kind = "patchlight lightmap";
constexpr const char* lightmap_facts_file = "lightmap.json";
constexpr const char* lit_file = "lightmap.glb";
constexpr const char* baked_file = "baked.glb";
constexpr std::array<const char*, 3> light_names = {"irradiance", "direct", "indirect"};

bool is_earlier_lightmap(const fs::path& folder) {
  std::vector<std::string> names = {lightmap_facts_file, lit_file, baked_file};
  for (const std::string light : light_names) {
    names.push_back(light + ".exr");
    names.push_back(light + ".png");
  }
  return holds_result(folder, {lightmap_facts_file, lightmap_kind, names});
}

std::vector<ExrChannel> rgb_channels(const TexelField& light, const Bands& bands) {
  const auto count = static_cast<std::size_t>(light.rows());
  std::vector<ExrChannel> channels;
  for (const char* name : {"R", "G", "B"}) channels.push_back({name, std::vector<float>(count)});
  for (std::size_t texel = 0; texel < count; ++texel) {
    const Spectrum here = light.row(static_cast<Eigen::Index>(texel)).cast<double>();
    const std::array<double, 3> rgb = linear_rgb(here, bands);
    for (std::size_t c = 0; c < 3; ++c) channels[c].values[texel] = static_cast<float>(rgb[c]);
  }
  return channels;
}

// What texels on surfaces have.
Field on_surfaces(const Lightmap& map, const TexelField& light) {
  const auto count =
      static_cast<Eigen::Index>(map.patch.size()) - std::count(map.patch.begin(), map.patch.end(), no_patch);
  Field rows(count, light.cols());
  Eigen::Index next = 0;
  for (std::size_t texel = 0; texel < map.patch.size(); ++texel) {
    if (map.patch[texel] != no_patch) rows.row(next++) = light.row(static_cast<Eigen::Index>(texel)).cast<double>();
  }
  return rows;
}

double exposure_of(const Lightmap& map, const TexelField& light, const Bands& bands) {
  const Field rows = on_surfaces(map, light);
  return exposure_for(rows, Eigen::VectorXd::Ones(rows.rows()), bands);
}

nlohmann::ordered_json facts_of(const Lightmap& map, const Scene& scene, const Provenance& provenance,
                                double png_exposure) {
  nlohmann::ordered_json json;
  json["kind"] = lightmap_kind;
  json["version"] = version();
  json["command_line"] = provenance.command_line;
  json["scene"] = scene.file;
  json["scene_hash"] = provenance.scene_hash;
  json["width"] = map.width;
  json["height"] = map.height;
  json["texel_m"] = map.texel;
  json["charts"] = map.charts.size();
  json["padding_texels"] = lightmap_padding;
  json["texels_on_surfaces"] =
      static_cast<std::int64_t>(map.patch.size()) - std::count(map.patch.begin(), map.patch.end(), no_patch);
  json["memory_bytes"] = bytes_of(map);
  json["exr"] = {{"unit", "W/m^2"}, {"channels", json_array(std::array{"R", "G", "B"})}, {"primaries", "Rec. 709"}};
  // Before highlights are rolled off, a PNG shows sRGB of exposure H / pi.
  json["png_exposure_of_white"] = png_exposure;
  json["baked_exposure"] = provenance.exposure;
  json["indirect_error_channel"] = "error.Y of indirect.exr, lx";
  return json;
}

}  // namespace

std::size_t bytes_of(const Lightmap& map) {
  const auto values =
      static_cast<std::size_t>(map.direct.size() + map.indirect.size() + map.radiance.size() + map.error.size());
  return values * sizeof(float) + map.patch.size() * sizeof(PatchIndex);
}

void write_lightmap(const fs::path& folder, const Scene& scene, const Simulation& simulation, const Lightmap& map,
                    const Provenance& provenance) {
  const Bands bands = bands_of(scene);
  Provenance baked = provenance;
  baked.exposure = exposure_of(map, map.radiance, bands);
  const TexelField total = map.direct + map.indirect;
  const double exposure = exposure_of(map, total, bands);  // of irradiance, which is pi times the radiance of white
  write_whole_folder(folder, is_earlier_lightmap, [&](const fs::path& in) {
    const std::array<const TexelField*, 3> lights = {&total, &map.direct, &map.indirect};
    for (std::size_t k = 0; k < lights.size(); ++k) {
      const std::string name = light_names[k];
      std::vector<ExrChannel> channels = rgb_channels(*lights[k], bands);
      if (lights[k] == &map.indirect) channels.push_back({"error.Y", {map.error.begin(), map.error.end()}});
      write_exr(in / (name + ".exr"), map.width, map.height, channels, name + ", W/m^2");
      write_png(in / (name + ".png"), picture_of_map(map, *lights[k], exposure, bands));
    }
    write_lightmap_glb(in / lit_file, scene, simulation, map, baked);
    write_baked_glb(in / baked_file, scene, simulation, map, baked);
    write_bytes(in / lightmap_facts_file,
                facts_of(map, scene, baked, exposure * std::numbers::pi)
                        .dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) +
                    "\n");
  });
}

void check_lightmap_writable(const fs::path& folder) { check_folder_writable(folder, is_earlier_lightmap); }

}  // namespace patchlight
