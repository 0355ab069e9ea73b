#include "output/mesh/write_glb.h"

#include "output/mesh/append_bytes.h"
#include "output/mesh/glb_file.h"
#include "output/report/json_array.h"
#include "render/tone_map.h"

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace patchlight {
namespace {

using Json = nlohmann::ordered_json;
using namespace gltf;

// The binary chunk and where its parts are.
struct Buffer {
  std::string bytes;
  std::size_t positions = 0, colours = 0, indices = 0;     // bytes each
  std::size_t vertices = 0, corners = 0;                   // numbers of entries
  Eigen::Array3f lowest = Eigen::Array3f::Constant(0.0F);  // of the positions
  Eigen::Array3f highest = Eigen::Array3f::Constant(0.0F);
};

// IEC 61966-2-1:1999, section 5.2: linear value of an 8-bit sRGB channel, as a share of 65535.
std::uint16_t linear(std::uint8_t channel) {
  const double encoded = channel / 255.0;
  const double value = encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
  return static_cast<std::uint16_t>(std::lround(65535 * value));
}

void append_triangle(std::string& bytes, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  for (const std::uint32_t corner : {a, b, c}) append_bytes(bytes, corner);
}

Buffer buffer_of(const SolvedSurface& surface, const Point& centre, double exposure) {
  const PatchMesh& mesh = surface.simulation.mesh;
  Buffer buffer;
  buffer.vertices = mesh.vertices.size();
  for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
    const Eigen::Array3f position = y_up(mesh.vertices[k] - centre, surface.scene).cast<float>().array();
    for (const float coordinate : position) append_bytes(buffer.bytes, coordinate);
    buffer.lowest = k == 0 ? position : buffer.lowest.min(position);
    buffer.highest = k == 0 ? position : buffer.highest.max(position);
  }
  buffer.positions = buffer.bytes.size();
  // Vertex colours are linear in glTF: sixteen bits keep all eight of sRGB. Opaque.
  for (const auto& colour : tone_map(surface.radiance_at_vertices, exposure, bands_of(surface.scene))) {
    for (const std::uint8_t channel : colour) append_bytes(buffer.bytes, linear(channel));
    append_bytes(buffer.bytes, std::numeric_limits<std::uint16_t>::max());
  }
  buffer.colours = buffer.bytes.size() - buffer.positions;
  for (const auto& [a, b, c, d] : mesh.corners) {
    append_triangle(buffer.bytes, a, b, c);
    if (c != d) append_triangle(buffer.bytes, a, c, d);
  }
  buffer.indices = buffer.bytes.size() - buffer.positions - buffer.colours;
  buffer.corners = buffer.indices / sizeof(std::uint32_t);
  return buffer;
}

Json description(const Buffer& buffer, const Vector& translation, const Provenance& provenance) {
  const auto view = [](std::size_t offset, std::size_t length, int target) -> Json {
    return {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", length}, {"target", target}};
  };
  Json json;
  json["asset"] = {{"version", "2.0"},
                   {"generator", std::string("patchlight ") + version()},
                   {"extras", {{"exposure", provenance.exposure}, {"command_line", provenance.command_line}}}};
  json["extensionsUsed"] = Json::array({"KHR_materials_unlit"});
  json["scene"] = 0;
  json["scenes"] = Json::array({{{"nodes", Json::array({0})}}});
  json["nodes"] =
      Json::array({{{"mesh", 0}, {"translation", Json::array({translation.x(), translation.y(), translation.z()})}}});
  const Json primitive = {
      {"attributes", {{"POSITION", 0}, {"COLOR_0", 1}}}, {"indices", 2}, {"material", 0}, {"mode", 4}};
  json["meshes"] = Json::array({{{"primitives", Json::array({primitive})}}});
  json["materials"] = Json::array({{{"name", "light"},
                                    {"doubleSided", false},
                                    {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}},
                                    {"extensions", {{"KHR_materials_unlit", Json::object()}}}}});
  json["accessors"] = Json::array(
      {{{"bufferView", 0},
        {"componentType", type_float},
        {"count", buffer.vertices},
        {"type", "VEC3"},
        {"min", json_array(buffer.lowest)},
        {"max", json_array(buffer.highest)}},
       {{"bufferView", 1},
        {"componentType", type_unsigned_short},
        {"normalized", true},
        {"count", buffer.vertices},
        {"type", "VEC4"}},
       {{"bufferView", 2}, {"componentType", type_unsigned_int}, {"count", buffer.corners}, {"type", "SCALAR"}}});
  json["bufferViews"] =
      Json::array({view(0, buffer.positions, target_vertices), view(buffer.positions, buffer.colours, target_vertices),
                   view(buffer.positions + buffer.colours, buffer.indices, target_indices)});
  json["buffers"] = Json::array({{{"byteLength", buffer.bytes.size()}}});
  return json;
}

}  // namespace

void write_glb(const std::filesystem::path& file, const SolvedSurface& surface, const Provenance& provenance) {
  const Point centre = bounds(surface.scene).center();
  const Buffer buffer = buffer_of(surface, centre, provenance.exposure);
  write_glb_file(file, description(buffer, y_up(centre, surface.scene), provenance), buffer.bytes);
}

}  // namespace patchlight
