#include "output/mesh/write_mesh.h"

#include "patchlight/base/error.h"

#include "output/file/whole_file.h"
#include "output/report/report_json.h"
#include "output/vtk/vtk_polygons.h"
#include "output/vtk/write_vtk.h"
#include "render/tone_map.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <sstream>
#include <vtkCellData.h>
#include <vtkFieldData.h>

namespace patchlight {
namespace {

constexpr std::uint32_t glb_magic = 0x46546C67, glb_chunk_json = 0x4E4F534A, glb_chunk_binary = 0x004E4942;

void append_chunk(std::string& bytes, std::uint32_t type, const std::string& chunk) {
  append_bytes(bytes, static_cast<std::uint32_t>(chunk.size()));
  append_bytes(bytes, type);
  bytes += chunk;
}

// To whole words.
std::string padded(std::string chunk, char with) {
  chunk.resize((chunk.size() + 3) / 4 * 4, with);
  return chunk;
}

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
  // Vertex colors are linear in glTF: sixteen bits keep all eight of sRGB. Opaque.
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
  json["asset"] = gltf_asset(provenance);
  json["extensionsUsed"] = Json::array({"KHR_materials_unlit"});
  json["scene"] = 0;
  json["scenes"] = Json::array({{{"nodes", Json::array({0})}}});
  json["nodes"] = gltf_nodes(translation);
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

// A comment ends with its line.
std::string one_line(std::string text) {
  for (char& letter : text) {
    if (letter == '\n' || letter == '\r') letter = ' ';
  }
  return text;
}

std::string header(const PatchMesh& mesh, const Provenance& provenance) {
  std::ostringstream text;
  text << "ply\nformat binary_little_endian 1.0\n"
       << "comment patchlight " << version() << "; meters; colors are sRGB at exposure " << provenance.exposure << '\n'
       << "comment " << one_line(provenance.command_line) << '\n'
       << "element vertex " << mesh.vertices.size() << '\n'
       << "property double x\nproperty double y\nproperty double z\n"
       << "property uchar red\nproperty uchar green\nproperty uchar blue\n"
       << "element face " << mesh.size() << '\n'
       << "property list uchar int vertex_indices\nend_header\n";
  return text.str();
}

}  // namespace

Vector y_up(const Vector& vector, const Scene& scene) {
  const bool turned = std::abs(scene.up.y()) < std::abs(scene.up.z());
  return turned ? Vector(vector.x(), vector.z(), -vector.y()) : vector;
}

nlohmann::ordered_json gltf_asset(const Provenance& provenance) {
  return {{"version", "2.0"},
          {"generator", std::string("patchlight ") + version()},
          {"extras", {{"exposure", provenance.exposure}, {"command_line", provenance.command_line}}}};
}

nlohmann::ordered_json gltf_nodes(const Vector& translation) {
  return Json::array({{{"mesh", 0}, {"translation", json_array(translation)}}});
}

void write_glb_file(const std::filesystem::path& file, const nlohmann::ordered_json& description,
                    const std::string& buffer) {
  // Bytes that are not UTF-8 are replaced.
  const std::string text =
      padded(description.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace), ' ');
  const std::string binary = padded(buffer, '\0');
  const std::size_t header = 12, chunk_header = 8;
  const std::size_t size = header + chunk_header + text.size() + chunk_header + binary.size();
  if (size > std::numeric_limits<std::uint32_t>::max())
    throw OutputError(file.string(), "needs more than the 4 GiB that a .glb can hold; expected fewer patches or .vtp");
  std::string bytes;
  bytes.reserve(size);
  append_bytes(bytes, glb_magic);
  append_bytes(bytes, std::uint32_t{2});  // version of the container
  append_bytes(bytes, static_cast<std::uint32_t>(size));
  append_chunk(bytes, glb_chunk_json, text);
  append_chunk(bytes, glb_chunk_binary, binary);
  write_bytes(file, bytes);
}

void write_glb(const std::filesystem::path& file, const SolvedSurface& surface, const Provenance& provenance) {
  const Point centre = bounds(surface.scene).center();
  const Buffer buffer = buffer_of(surface, centre, provenance.exposure);
  write_glb_file(file, description(buffer, y_up(centre, surface.scene), provenance), buffer.bytes);
}

void write_ply(const std::filesystem::path& file, const SolvedSurface& surface, const Provenance& provenance) {
  const PatchMesh& mesh = surface.simulation.mesh;
  const auto colours = tone_map(surface.radiance_at_vertices, provenance.exposure, bands_of(surface.scene));
  std::string bytes = header(mesh, provenance);
  for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
    for (const double coordinate : mesh.vertices[k]) append_bytes(bytes, coordinate);
    for (const std::uint8_t channel : colours[k]) append_bytes(bytes, channel);
  }
  for (const auto& corners : mesh.corners) {
    const std::uint8_t count = corners[2] == corners[3] ? 3 : 4;
    append_bytes(bytes, count);
    for (std::size_t k = 0; k < count; ++k) append_bytes(bytes, static_cast<std::int32_t>(corners[k]));
  }
  write_bytes(file, bytes);
}

void write_mesh(const std::filesystem::path& file, const Scene& scene, const MeshOfRows& rows) {
  const PatchMesh& mesh = rows.mesh;
  std::vector<std::uint32_t> objects, faces;
  for (const PolygonIndex polygon : mesh.polygon) {
    objects.push_back(scene.polygons[polygon].group);
    faces.push_back(scene.polygons[polygon].face);
  }
  std::vector<std::string> material_names;
  for (const Material& material : scene.materials) material_names.push_back(material.name);

  const Pointer<vtkPolyData> polygons = polygons_of(mesh);
  vtkCellData& cell_data = *polygons->GetCellData();
  cell_data.AddArray(numbers<vtkDoubleArray>("area", rows.area));
  cell_data.AddArray(numbers<vtkDoubleArray>("row_sum", rows.row_sum));
  if (rows.raw_row_sum.size() > 0) cell_data.AddArray(numbers<vtkDoubleArray>("raw_row_sum", rows.raw_row_sum));
  cell_data.AddArray(numbers<vtkIntArray>("material_id", mesh.material));
  cell_data.AddArray(numbers<vtkIntArray>("object_id", objects));
  cell_data.AddArray(numbers<vtkIntArray>("source_polygon", faces));
  cell_data.SetActiveScalars("row_sum");
  vtkFieldData& facts = *polygons->GetFieldData();
  facts.AddArray(strings("material_names", material_names));
  facts.AddArray(strings("object_names", scene.groups));
  facts.AddArray(strings("unit_area", {"m^2"}));
  write_polygons(file, *polygons);
}

const char* version() { return PATCHLIGHT_VERSION; }

const std::vector<std::string>& result_extensions() {
  static const std::vector<std::string> extensions = {".vtp", ".vtu", ".ply", ".glb"};
  return extensions;
}

void write_result(const std::filesystem::path& file, const SolvedSurface& surface, const Provenance& provenance) {
  const std::string extension = file.extension().string();
  if (extension == ".vtp" || extension == ".vtu") return write_vtk(file, surface, provenance);
  if (extension == ".ply") return write_ply(file, surface, provenance);
  if (extension == ".glb") return write_glb(file, surface, provenance);
  throw OutputError(file.string(), "the extension names no known format; expected .vtp, .vtu, .ply or .glb");
}

}  // namespace patchlight
