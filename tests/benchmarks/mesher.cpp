// How long it takes to cut a box into about a million patches: as quadrilaterals, and with its faces halved into
// triangles. usage: benchmark_mesher
#include "mesh/mesher.h"

#include "base/parallel.h"
#include "support/scenes.h"

#include <cstdio>

namespace {

using namespace patchlight;

void measure(const char* name, const Scene& scene, double max_edge) {
  const KeptSides sides = kept_sides(scene, Sides::front);
  const double wall = wall_seconds();
  const double cpu = cpu_seconds();
  const PatchMesh mesh = tessellate(scene, sides, max_edge);
  std::printf("%-10s %8u patches  %.2f s  %.2f CPU s\n", name, mesh.size(), wall_seconds() - wall, cpu_seconds() - cpu);
}

Scene halved(const Scene& scene) {
  Scene triangles = scene;
  triangles.polygons.clear();
  for (const Polygon& polygon : scene.polygons) {
    for (const auto& [a, b, c] : {std::array{0U, 1U, 2U}, std::array{0U, 2U, 3U}}) {
      Polygon half = polygon;
      half.corners = {polygon.corners[a], polygon.corners[b], polygon.corners[c]};
      triangles.polygons.push_back(half);
    }
  }
  return triangles;
}

}  // namespace

int main() {
  const Scene box = test::with_box(test::empty_scene({test::grey(0.5)}), Point(0, 0, 0), Point(4, 3, 2.5), true);
  measure("quads", box, 0.00768);
  measure("triangles", halved(box), 0.0117);
  return 0;
}
