#include "output/mesh/write_mesh.h"

#include "patchlight/base/error.h"

#include "output/file/whole_file.h"
#include "output/mesh/glb_file.h"
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

// IEC 61966-2-1:1999, section 5.2: linear value of an 8-bit sRGB channel, as a share of 65535.
std::uint16_t linear(std::uint8_t channel) {
  const double encoded = channel / 255.0;
  const double value = encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
  return static_cast<std::uint16_t>(std::lround(65535 * value));
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

void write_glb(const std::filesystem::path& file, const SolvedSurface& surface, const Provenance& provenance) {
  const PatchMesh& mesh = surface.simulation.mesh;
  const Point centre = bounds(surface.scene).center();
  std::vector<float> positions;
  for (const Point& vertex : mesh.vertices) {
    for (const double coordinate : y_up(vertex - centre, surface.scene))
      positions.push_back(static_cast<float>(coordinate));
  }
  // Vertex colors are linear in glTF: sixteen bits keep all eight of sRGB. Opaque.
  std::vector<std::uint16_t> colours;
  for (const auto& colour : tone_map(surface.radiance_at_vertices, provenance.exposure, bands_of(surface.scene))) {
    for (const std::uint8_t channel : colour) colours.push_back(linear(channel));
    colours.push_back(std::numeric_limits<std::uint16_t>::max());
  }
  std::vector<std::uint32_t> triangles;
  for (const auto& corners : mesh.corners) append_patch(triangles, corners);

  GlbFile glb(provenance, y_up(centre, surface.scene));
  glb.add_attribute("POSITION", positions, 3);
  glb.add_attribute("COLOR_0", colours, 4);
  glb.add_primitive(triangles, {{"name", "light"},
                                {"doubleSided", false},
                                {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}},
                                {"extensions", unlit()}});
  glb.write(file);
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
