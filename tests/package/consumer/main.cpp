#include <patchlight/input/read_scene.h>
#include <patchlight/output/write_result.h>
#include <patchlight/simulate.h>
#include <patchlight/views/views.h>

int main(int, char** arguments) {
  const patchlight::Scene scene = patchlight::read_scene(arguments[1]);
  patchlight::Request request;
  request.mesh.patches = 100;
  const patchlight::Simulation simulation = patchlight::simulate(scene, request);
  patchlight::write_result(arguments[2], patchlight::surface_of(simulation), {"consumer", 1.0});
  return simulation.solution.converged ? 0 : 1;
}
