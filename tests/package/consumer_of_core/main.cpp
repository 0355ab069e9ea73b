#include <patchlight/simulate.h>

// Two squares of 1 m that face each other at a distance of 1 m; the upper one is the lamp.
int main() {
  using namespace patchlight;
  Scene scene;
  scene.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  scene.materials = {{"floor", rgb(0.5, 0.5, 0.5), rgb(0, 0, 0)}, {"lamp", rgb(0, 0, 0), rgb(1, 1, 1)}};
  scene.polygons = {{{0, 1, 2, 3}, 0}, {{7, 6, 5, 4}, 1}};
  scene.groups = {""};
  return simulate(scene).solution.converged ? 0 : 1;
}
