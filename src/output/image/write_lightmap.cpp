#include "patchlight/base/error.h"
#include "patchlight/light/spectrum.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/output/write_result.h"
#include "patchlight/render/image.h"
#include "patchlight/scene/scene.h"
#include "patchlight/simulate.h"

#include "output/file/whole_file.h"
#include "output/image/write_image.h"
#include "output/mesh/glb_file.h"
#include "output/mesh/write_mesh.h"
#include "output/report/report_json.h"
#include "render/lightmap.h"
#include "render/tone_map.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// A radiance of a lightmap as colors for a display, W/(m^2 sr) times the exposure, row by row: no field in double
// precision of the whole map is made.
DisplayImage picture_of_map(const Lightmap& map, const TexelField& radiance, double exposure, const Bands& bands) {
  DisplayImage image{map.width, map.height, {}};
  image.pixels.reserve(static_cast<std::size_t>(radiance.rows()));
  for (Eigen::Index row = 0; row < radiance.rows(); row += map.width) {
    const Field here = radiance.middleRows(row, map.width).cast<double>();
    const auto colours = tone_map(here, exposure, bands);
    image.pixels.insert(image.pixels.end(), colours.begin(), colours.end());
  }
  return image;
}

using GltfJson = nlohmann::ordered_json;

// A corner of patches of one chart or, without a place in the map, of one clear patch.
struct ChartVertex {
  Point position;
  Vector normal;
  Eigen::Vector2d in_picture;
  Eigen::Vector2d in_map;
};

// All patches as triangles, by material.
struct ChartTriangles {
  std::vector<ChartVertex> vertices;
  std::vector<std::vector<std::uint32_t>> of_material;  // three vertices each
};

Eigen::Vector2d place_in_picture(const Scene& scene, const PatchMesh& mesh, PatchIndex patch, const Point& point,
                                 const Eigen::Vector2d& in_metres) {
  const TextureMap* map = texture_map_on(scene, scene.polygons[mesh.polygon[patch]], mesh.side[patch]);
  return map ? Eigen::Vector2d(map->linear * point + map->offset) : in_metres;
}

// Vertices are shared within a chart; of a picture's places the first polygon's counts, which those beside it go on.
ChartTriangles chart_triangles(const Scene& scene, const PatchMesh& mesh, const Lightmap& map) {
  ChartTriangles all;
  all.of_material.resize(scene.materials.size());
  std::vector<std::uint8_t> in_chart(mesh.size());
  for (const LightmapChart& chart : map.charts) {
    std::unordered_map<std::uint64_t, std::uint32_t> known;  // by vertex of the mesh and map of the picture
    for (const PatchIndex patch : chart.patches) {
      in_chart[patch] = 1;
      const Polygon& polygon = scene.polygons[mesh.polygon[patch]];
      const std::uint32_t picture =
          mesh.side[patch] == Side::back && polygon.back_material ? polygon.back_texture_map : polygon.texture_map;
      std::array<std::uint32_t, 4> corners{};
      for (std::size_t k = 0; k < 4; ++k) {
        const std::uint32_t vertex = mesh.corners[patch][k];
        const auto [place, is_new] =
            known.try_emplace(std::uint64_t{picture} << 32U | vertex, static_cast<std::uint32_t>(all.vertices.size()));
        corners[k] = place->second;
        if (!is_new) continue;
        const Point& point = mesh.vertices[vertex];
        const Vector from = point - chart.corner;
        const Eigen::Vector2d in_metres(chart.right.dot(from), chart.down.dot(from));
        const Eigen::Vector2d texels =
            Eigen::Vector2d(chart.left + in_metres.x() / chart.texel[0], chart.top + in_metres.y() / chart.texel[1]);
        all.vertices.push_back({point,
                                mesh.normal[patch],
                                place_in_picture(scene, mesh, patch, point, in_metres),
                                {texels.x() / map.width, texels.y() / map.height}});
      }
      append_patch(all.of_material[mesh.material[patch]], corners);
    }
  }
  for (PatchIndex patch = 0; patch < mesh.size(); ++patch) {
    if (in_chart[patch]) continue;
    std::array<std::uint32_t, 4> corners{};
    for (std::size_t k = 0; k < 4; ++k) {
      corners[k] = static_cast<std::uint32_t>(all.vertices.size());
      if (k == 3 && mesh.corners[patch][3] == mesh.corners[patch][2])
        corners[k] = corners[2];
      else
        all.vertices.push_back({mesh.vertices[mesh.corners[patch][k]], mesh.normal[patch], {0, 0}, {0, 0}});
    }
    append_patch(all.of_material[mesh.material[patch]], corners);
  }
  return all;
}

void add_vertices(GlbFile& glb, const ChartTriangles& all, const Scene& scene, bool is_lit) {
  const Point centre = bounds(scene).center();
  std::vector<float> positions, normals, first, second;
  const auto append = [](std::vector<float>& to, const auto& vector) {
    for (const double value : vector) to.push_back(static_cast<float>(value));
  };
  for (const ChartVertex& vertex : all.vertices) {
    append(positions, y_up(vertex.position - centre, scene));
    append(normals, y_up(vertex.normal, scene));
    append(first, is_lit ? vertex.in_picture : vertex.in_map);
    append(second, vertex.in_map);
  }
  glb.add_attribute("POSITION", positions, 3);
  if (is_lit) glb.add_attribute("NORMAL", normals, 3);
  const std::size_t places = glb.add_attribute("TEXCOORD_0", first, 2);
  if (is_lit)
    glb.add_attribute("TEXCOORD_1", second, 2);
  else
    glb.share_attribute("TEXCOORD_1", places);
}

GltfJson matt_material(const Material& material, const Bands& bands, double opacity) {
  const std::array<double, 3> colour = linear_rgb(material.reflectance, bands);
  GltfJson factor = GltfJson::array();
  for (const double channel : colour) factor.push_back(std::clamp(channel, 0.0, 1.0));
  factor.push_back(opacity);
  GltfJson json = {
      {"name", material.name},
      {"pbrMetallicRoughness", {{"baseColorFactor", factor}, {"metallicFactor", 0}, {"roughnessFactor", 1}}}};
  if (opacity < 1) json["alphaMode"] = "BLEND";
  return json;
}

// Glass is drawn so thick that it is seen to be there.
GltfJson glass(const Material& material, const Bands& bands) {
  GltfJson json = matt_material(material, bands, std::clamp(1 - material.transmittance.mean(), 0.1, 0.9));
  for (std::size_t channel = 0; channel < 3; ++channel) json["pbrMetallicRoughness"]["baseColorFactor"][channel] = 0.8;
  return json;
}

bool is_clear(const Material& material) {
  return material.transmittance.size() > 0 && (material.transmittance > 0).any();
}

// Writes the patches as binary glTF 2.0 for engines that light them by a lightmap: the materials' reflectances as base
// colors, normals, TEXCOORD_1 the place in the lightmap and TEXCOORD_0 that in the material's picture, or meters
// along the face where it has none. One-sided triangles, y up, positions as write_glb() has them. Throws OutputError.
void write_lightmap_glb(const std::filesystem::path& file, const Scene& scene, const Simulation& simulation,
                        const Lightmap& map, const Provenance& provenance) {
  const ChartTriangles all = chart_triangles(scene, simulation.mesh, map);
  GlbFile glb(provenance, y_up(bounds(scene).center(), scene));
  add_vertices(glb, all, scene, true);
  for (std::size_t m = 0; m < all.of_material.size(); ++m) {
    if (all.of_material[m].empty()) continue;
    const Material& material = scene.materials[m];
    glb.add_primitive(all.of_material[m], is_clear(material) ? glass(material, bands_of(scene))
                                                             : matt_material(material, bands_of(scene), 1));
  }
  glb.add_extra("lightmap", {{"texCoord", 1}, {"file", "irradiance.exr"}, {"unit", "W/m^2"}});
  glb.write(file);
}

// The same with the light itself as colors for viewers: unlit (KHR_materials_unlit), the map's radiance exposed and
// embedded as PNG, its places in TEXCOORD_0 and in TEXCOORD_1. Clear faces are drawn as thin glass. \throws
// OutputError.
void write_baked_glb(const std::filesystem::path& file, const Scene& scene, const Simulation& simulation,
                     const Lightmap& map, const Provenance& provenance) {
  const ChartTriangles all = chart_triangles(scene, simulation.mesh, map);
  std::vector<std::uint32_t> light;
  GlbFile glb(provenance, y_up(bounds(scene).center(), scene));
  add_vertices(glb, all, scene, false);
  const std::string png = png_bytes(picture_of_map(map, map.radiance, provenance.exposure, bands_of(scene)));
  if (png.empty()) throw OutputError(file.string(), "the light cannot be encoded as PNG");
  glb.add_picture(png);  // without smaller versions of it, in which charts would mix
  for (std::size_t m = 0; m < all.of_material.size(); ++m) {
    const Material& material = scene.materials[m];
    if (all.of_material[m].empty()) continue;
    if (!is_clear(material)) {
      light.insert(light.end(), all.of_material[m].begin(), all.of_material[m].end());
      continue;
    }
    GltfJson pane = glass(material, bands_of(scene));
    pane["extensions"] = unlit();
    glb.add_primitive(all.of_material[m], std::move(pane));
  }
  if (!light.empty())
    glb.add_primitive(light, {{"name", "light"},
                              {"pbrMetallicRoughness",
                               {{"baseColorTexture", {{"index", 0}}}, {"metallicFactor", 0}, {"roughnessFactor", 1}}},
                              {"extensions", unlit()}});
  glb.write(file);
}

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

// The light of texels on surfaces.
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
    write_bytes(in / lightmap_facts_file, json_text(facts_of(map, scene, baked, exposure * std::numbers::pi)));
  });
}

void check_lightmap_writable(const fs::path& folder) { check_folder_writable(folder, is_earlier_lightmap); }

}  // namespace patchlight
