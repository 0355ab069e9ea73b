#include "output/mesh/write_ply.h"

#include "output/file/write_bytes.h"
#include "output/mesh/append_bytes.h"
#include "render/tone_map.h"

#include <sstream>

namespace patchlight {
namespace {

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
       << "comment patchlight " << version() << "; metres; colours are sRGB at exposure " << provenance.exposure << '\n'
       << "comment " << one_line(provenance.command_line) << '\n'
       << "element vertex " << mesh.vertices.size() << '\n'
       << "property double x\nproperty double y\nproperty double z\n"
       << "property uchar red\nproperty uchar green\nproperty uchar blue\n"
       << "element face " << mesh.size() << '\n'
       << "property list uchar int vertex_indices\nend_header\n";
  return text.str();
}

}  // namespace

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

}  // namespace patchlight
