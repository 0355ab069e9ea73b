#include "archive/geometry_hash.h"

#include "base/parallel.h"
#include "files/sha256.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <string>
#include <vector>

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
  // Some patches together: a string of its own for each takes longer than the hash.
  constexpr PatchIndex together = 4096;
  std::vector<std::string> parts((mesh.size() + together - 1) / together);
  parallel_for(parts.size(), [&](std::size_t part) {
    const auto first = static_cast<PatchIndex>(part * together);
    std::string& bytes = parts[part];
    constexpr std::size_t most_numbers = 15;  // of four corners and the normal
    bytes.reserve(together * (1 + most_numbers * sizeof(double)));
    for (PatchIndex i = first; i < std::min(mesh.size(), first + together); ++i) {
      const PatchCorners corners = mesh.corner_points(i);
      bytes += static_cast<char>(corners.count);
      for (const Point& corner : std::span<const Point>(corners)) append(bytes, corner);
      append(bytes, mesh.normal[i]);
    }
  });
  return sha256(parts);
}

}  // namespace patchlight
