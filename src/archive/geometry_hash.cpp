#include "archive/geometry_hash.h"

#include "files/sha256.h"

#include <array>
#include <bit>

namespace patchlight {
namespace {

void append(std::string& bytes, const Vector& vector) {
  for (const double coordinate : vector) {
    const auto raw = std::bit_cast<std::array<char, sizeof(double)>>(coordinate + 0.0);  // -0 counts as 0
    bytes.append(raw.data(), raw.size());
  }
}

}  // namespace

std::string geometry_hash(const PatchMesh& mesh) {
  std::vector<std::string> patches(mesh.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const PatchCorners corners = mesh.corner_points(i);
    patches[i] += static_cast<char>(corners.count);
    for (const Point& corner : std::span<const Point>(corners)) append(patches[i], corner);
    append(patches[i], mesh.normal[i]);
  }
  return sha256(patches);
}

}  // namespace patchlight
