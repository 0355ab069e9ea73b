// repair() turns any few polygons on a coarse grid into a scene that passes its check and can be meshed. The exchange
// areas are those of a radiosity problem: finite, not negative, symmetric, and at most the smaller patch's area.
#include "patchlight/scene/sides.h"
#include "patchlight/transport/assemble.h"

#include "base/parallel.h"
#include "mesh/mesher.h"
#include "scene/repair.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>

using namespace patchlight;

namespace {

constexpr std::size_t most_polygons = 8;
constexpr std::size_t most_patches = 40;

// Returns one byte after the other, and zeros after the last.
class Bytes {
 public:
  explicit Bytes(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  bool empty() const { return bytes_.empty(); }
  std::uint8_t next() {
    if (bytes_.empty()) return 0;
    const std::uint8_t first = bytes_[0];
    bytes_ = bytes_.subspan(1);
    return first;
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

// Half of the corners lie in one of the planes of the grid, so that planar polygons with many corners are common.
Scene scene_from(Bytes& bytes) {
  Scene scene;
  scene.file = "fuzz";
  scene.groups = {"fuzz"};
  scene.materials = {{"grey", rgb(0.5, 0.5, 0.5), rgb(1, 1, 1)}};
  while (!bytes.empty() && scene.polygons.size() < most_polygons) {
    const std::uint8_t kind = bytes.next();
    const std::uint32_t corners = 3 + kind % 5;
    const int plane = kind / 5 % 6;  // 0 to 2: across that axis; otherwise free
    const std::uint8_t height = bytes.next();
    Polygon polygon;
    for (std::uint32_t k = 0; k < corners; ++k) {
      Point point;
      for (int axis = 0; axis < 3; ++axis) point[axis] = (axis == plane ? height : bytes.next()) / 64.0 - 2;
      polygon.corners.push_back(static_cast<std::uint32_t>(scene.vertices.size()));
      scene.vertices.push_back(point);
    }
    scene.polygons.push_back(polygon);
  }
  return scene;
}

void require(bool condition) {
  if (!condition) std::abort();
}

void require_good(const PatchMesh& mesh, double max_edge) {
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    require(std::isfinite(mesh.area[i]) && mesh.area[i] > 0);
    require(std::abs(mesh.normal[i].norm() - 1) < 1e-9);
    require(mesh.area[i] <= max_edge * max_edge * (1 + 1e-9));
  }
}

void require_good(const ExchangeAreas& S, const PatchMesh& mesh) {
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (PatchIndex j = 0; j < mesh.size(); ++j) {
      const double value = S.at(i, j);
      require(std::isfinite(value) && value >= 0 && S.at(j, i) == S.at(i, j));
      require(value <= std::min(mesh.area[i], mesh.area[j]) * (1 + 1e-5));
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const ThreadLimit one_thread(1);
  Bytes bytes({data, size});
  const double max_edge = 0.25 + bytes.next() / 64.0;
  const auto wanted = static_cast<Sides>(bytes.next() % 3);
  const Scene scene = repair(scene_from(bytes));
  if (scene.polygons.empty()) return 0;
  check(scene);
  const KeptSides sides = kept_sides(scene, wanted);
  const PatchMesh mesh = tessellate(scene, sides, max_edge, find_contact_lines(scene, sides));
  require_good(mesh, max_edge);
  if (mesh.size() > most_patches) return 0;
  require_good(assemble_exchange_areas(mesh, Occluder(scene), {.samples = 8, .seed = 1}).exchange_areas, mesh);
  return 0;
}
