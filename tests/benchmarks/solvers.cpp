// What every solver needs in the test room and in two rooms: the tables of docs/solvers.md, in Markdown.
#include "patchlight/base/parallel.h"
#include "patchlight/input/read_scene.h"
#include "patchlight/solve/solve.h"
#include "patchlight/solve/spectral_radius.h"

#include "support/assembled.h"
#include "support/test_room.h"

#include <cmath>
#include <cstdio>
#include <optional>
#include <string>

namespace patchlight {
namespace {

using namespace test;

// What a solver needed to get there.
struct Effort {
  bool converged = false;
  double iterations = 0;
  double applications = 0;
  double cpu_seconds = 0;
};

Effort effort(const Assembled& room, SolverOptions options) {
  // In the time of some 20,000 applications shooting does about 1,000.
  options.max_iterations = is_shooting(options.solver) ? 1000 : 20000;
  options.largest_row_sum = 1;
  const double start = cpu_seconds();
  const Solution solution = solve(*room.transport, room.problem, options);
  const Iteration& last = solution.history.back();
  // For what shoots as many shots as there are patches are one iteration.
  const double unit = is_shooting(options.solver) ? room.mesh.size() : 1;
  return {solution.converged, last.number / unit, last.work, cpu_seconds() - start};
}

// "5 / 8": iterations / applications; a dash where it was not reached.
std::string cell(const Effort& effort) {
  if (!effort.converged) return "-";
  char text[64];
  const bool whole = effort.iterations == std::floor(effort.iterations);
  std::snprintf(text, sizeof text, whole ? "%.0f / %.0f" : "%.1f / %.1f", effort.iterations, effort.applications);
  return text;
}

void print_table(const Assembled& room) {
  const Field exact = solve(*room.transport, room.problem, {.relative_error = 1e-11, .largest_row_sum = 1}).radiosity;
  const double radius = spectral_radius(*room.transport, room.problem, 50).maxCoeff();
  std::printf("%u patches, %d band(s), spectral radius %.4f. Iterations / applications:\n\n", room.mesh.size(),
              static_cast<int>(exact.cols()), radius);
  std::printf("| solver | true error 1e-3 | true error 1e-6 | certified 1e-6 | CPU seconds, certified |\n");
  std::printf("|---|---|---|---|---|\n");
  for (const Solver solver : all_solvers()) {
    const Effort rough = effort(room, {.solver = solver, .relative_error = 1e-3, .reference = exact});
    if (!rough.converged) {
      std::printf("| %s | - | - | - | - |\n", name_of(solver));
      continue;
    }
    const Effort fine = effort(room, {.solver = solver, .relative_error = 1e-6, .reference = exact});
    const Effort certified = effort(room, {.solver = solver, .relative_error = 1e-6});
    std::printf("| %s | %s | %s | %s | %.3f |\n", name_of(solver), cell(rough).c_str(), cell(fine).c_str(),
                cell(certified).c_str(), certified.cpu_seconds);
    std::fflush(stdout);
  }
  std::printf("\n");
}

void print_tables(const std::string& two_rooms) {
  Assembled room = assembled(test_room(0.5), test_room_edge);
  for (const double reflectance : {0.5, 0.8, 0.95, 0.99, 0.999}) {
    room.problem.reflectance.setConstant(reflectance);
    std::printf("### Test room, reflectance %g\n\n", reflectance);
    print_table(room);
  }
  const Scene scene = read_scene({two_rooms});
  const double max_edge = max_edge_for(scene, kept_sides(scene, Sides::automatic), 2000);
  std::printf("### Two rooms, with their own reflectances\n\n");
  print_table(assembled(scene, max_edge));
}

}  // namespace
}  // namespace patchlight

int main(int count, char** arguments) {
  if (count != 2) {
    std::fprintf(stderr, "usage: benchmark_solvers TWO_ROOMS.obj\n");
    return 1;
  }
  patchlight::print_tables(arguments[1]);
  return 0;
}
