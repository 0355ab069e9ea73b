#include "cli/sensors.h"

#include "patchlight/base/error.h"

#include "input/tables/read_points.h"
#include "input/text.h"

namespace patchlight::cli {

Scene with_points(Scene scene, const SolveArguments& arguments) {
  if (arguments.points.empty()) return scene;
  require_within(arguments.read.confine, arguments.points, "--points");
  scene.sensors.push_back(read_points(arguments.points, scene.metres_per_unit));
  return scene;
}

std::vector<std::filesystem::path> points_outputs(const SolveArguments& arguments, const Scene& scene) {
  if (!scene.sensors.empty()) {
    if (!arguments.points_outputs.empty()) return arguments.points_outputs;
    return {arguments.default_points_output};
  }
  if (arguments.points_outputs.empty()) return {};
  throw InputError("--points-output", "the scene file has no sensors; give it a table [[sensors]], or --points FILE");
}

}  // namespace patchlight::cli
