#include "cli/scene_warnings.h"

#include "cli/messages.h"

namespace patchlight::cli {

void print_scene_warnings(const Scene& scene) {
  for (const Problem& problem : scene.problems) {
    if (problem.kind == ProblemKind::guessed_up) print_message("warning", scene.file + ": " + problem.what);
  }
}

}  // namespace patchlight::cli
