// Iterations, applications and time of every solver in the test room and in two rooms, as tables in Markdown for
// docs/benchmarks/solvers.md.
// usage: benchmark_solvers TWO_ROOMS.obj [small]
#include "patchlight/input/read_scene.h"
#include "patchlight/solve/solve.h"

#include "base/parallel.h"
#include "solve/bounds.h"
#include "solve/iterations.h"
#include "support/assembled.h"
#include "support/test_room.h"

#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

using namespace test;

// The effort of a solver to reach an error.
struct Effort {
  bool converged = false;
  double iterations = 0;
  double applications = 0;
  double cpu_seconds = 0;
};

Effort effort(const Assembled& room, SolverOptions options) {
  // About 1,000 shots per patch take the time of 20,000 applications.
  options.max_iterations = is_shooting(options.solver) ? 1000 : 20000;
  options.largest_row_sum = 1;
  const double start = cpu_seconds();
  const Solution solution = solve(*room.transport, room.problem, options);
  const Iteration& last = solution.history.back();
  // For shooting solvers, one iteration is as many shots as there are patches.
  const double unit = is_shooting(options.solver) ? room.mesh.size() : 1;
  return {solution.converged, last.number / unit, last.work, cpu_seconds() - start};
}

// "5 / 8": iterations / applications; a dash if the error was not reached.
std::string cell(const Effort& effort) {
  if (!effort.converged) return "-";
  char text[64];
  const bool whole = effort.iterations == std::floor(effort.iterations);
  std::snprintf(text, sizeof text, whole ? "%.0f / %.0f" : "%.1f / %.1f", effort.iterations, effort.applications);
  return text;
}

std::string number(double applications) {
  char text[32];
  std::snprintf(text, sizeof text, applications == std::floor(applications) ? "%.0f" : "%.1f", applications);
  return text;
}

// "7 / 11 / 11 (0.004)": applications to reach each of the three errors, and the CPU seconds of the last.
std::string in_short(const Effort& rough, const Effort& fine, const Effort& certified) {
  char seconds[32];
  std::snprintf(seconds, sizeof seconds, "%.3f", certified.cpu_seconds);
  return number(rough.applications) + " / " + number(fine.applications) + " / " + number(certified.applications) +
         " (" + seconds + ")";
}

// Prints one room's table; returns one short cell for each solver.
std::vector<std::string> print_table(const Assembled& room) {
  const Field exact = solve(*room.transport, room.problem, {.relative_error = 1e-11, .largest_row_sum = 1}).radiosity;
  const double radius = spectral_radius(*room.transport, room.problem, 50).maxCoeff();
  std::printf("%u patches, %d band(s), spectral radius %.4f. Iterations / applications:\n\n", room.mesh.size(),
              static_cast<int>(exact.cols()), radius);
  std::printf("| solver | true error 1e-3 | true error 1e-6 | certified 1e-6 | CPU seconds, certified |\n");
  std::printf("|---|---|---|---|---|\n");
  std::vector<std::string> cells;
  for (const Solver solver : all_solvers()) {
    const Effort rough = effort(room, {.solver = solver, .relative_error = 1e-3, .reference = exact});
    if (!rough.converged) {
      std::printf("| %s | - | - | - | - |\n", name_of(solver));
      cells.emplace_back("-");
      continue;
    }
    const Effort fine = effort(room, {.solver = solver, .relative_error = 1e-6, .reference = exact});
    const Effort certified = effort(room, {.solver = solver, .relative_error = 1e-6});
    std::printf("| %s | %s | %s | %s | %.3f |\n", name_of(solver), cell(rough).c_str(), cell(fine).c_str(),
                cell(certified).c_str(), certified.cpu_seconds);
    std::fflush(stdout);
    cells.push_back(in_short(rough, fine, certified));
  }
  std::printf("\n");
  return cells;
}

// Prints all rooms in one table, a column each.
void print_summary(const std::vector<std::string>& rooms, const std::vector<std::vector<std::string>>& cells) {
  std::printf("### All rooms: applications to 1e-3 / 1e-6 / certified 1e-6 (CPU seconds)\n\n| solver |");
  for (const std::string& room : rooms) std::printf(" %s |", room.c_str());
  std::printf("\n|---|");
  for (std::size_t k = 0; k < rooms.size(); ++k) std::printf("---|");
  const std::vector<Solver> solvers = all_solvers();
  for (std::size_t row = 0; row < solvers.size(); ++row) {
    std::printf("\n| %s |", name_of(solvers[row]));
    for (const std::vector<std::string>& of_room : cells) std::printf(" %s |", of_room[row].c_str());
  }
  std::printf("\n\n");
}

// Iterations of SOR to reach a true error of 1e-6.
double sweeps(const Assembled& room, const Field& exact, std::optional<double> relaxation) {
  return effort(room, {.solver = Solver::sor, .relative_error = 1e-6, .relaxation = relaxation, .reference = exact})
      .iterations;
}

// Prints one row: a factor of 1, the estimated one, and the best of a grid from 1 to 1.9.
void print_factors(const char* name, const std::string& reflectance, const Assembled& room) {
  const Field exact = solve(*room.transport, room.problem, {.relative_error = 1e-11, .largest_row_sum = 1}).radiosity;
  const double estimate = relaxation_for(spectral_radius(*room.transport, room.problem, 5).maxCoeff());
  const double usual = sweeps(room, exact, 1.0);
  double best = 1;
  double least = usual;
  for (int k = 1; k <= 18; ++k) {
    const double needed = sweeps(room, exact, 1 + 0.05 * k);
    if (needed >= least) continue;
    least = needed;
    best = 1 + 0.05 * k;
  }
  std::printf("| %s | %s | %.0f | %.3f, %.0f | %.2f, %.0f |\n", name, reflectance.c_str(), usual, estimate,
              sweeps(room, exact, {}), best, least);
  std::fflush(stdout);
}

void print_factors(Assembled test_room, Assembled two_rooms) {
  std::printf("### SOR's factor\n\n");
  std::printf("| room | reflectance | omega 1 (Gauss-Seidel) | estimate: omega, iterations | ");
  std::printf("best of the grid: omega, iterations |\n|---|---|---|---|---|\n");
  print_factors("two rooms", "their own", two_rooms);
  for (const char* reflectance : {"0.5", "0.8", "0.95", "0.99"}) {
    test_room.problem.scattering.reflectance.setConstant(std::stod(reflectance));
    two_rooms.problem.scattering.reflectance.setConstant(std::stod(reflectance));
    print_factors("test room", reflectance, test_room);
    print_factors("two rooms", reflectance, two_rooms);
  }
}

void print_tables(const std::string& two_rooms, bool small) {
  Assembled room = assembled(test_room(0.5), small ? 4 * test_room_edge : test_room_edge);
  std::vector<std::string> names;
  std::vector<std::vector<std::string>> cells;
  for (const char* reflectance : {"0.5", "0.8", "0.95", "0.99"}) {
    room.problem.scattering.reflectance.setConstant(std::stod(reflectance));
    std::printf("### Test room, reflectance %s\n\n", reflectance);
    names.push_back(std::string("*rho* ") + reflectance);
    cells.push_back(print_table(room));
    if (small) return;
  }
  const Scene scene = read_scene({two_rooms});
  const double max_edge = max_edge_for(scene, kept_sides(scene, Sides::automatic), 2000);
  std::printf("### Two rooms, with their own reflectances\n\n");
  Assembled rooms = assembled(scene, max_edge);
  names.emplace_back("two rooms");
  cells.push_back(print_table(rooms));
  print_summary(names, cells);
  print_factors(std::move(room), std::move(rooms));
}

}  // namespace
}  // namespace patchlight

int main(int count, char** arguments) {
  if (count != 2 && count != 3) {
    std::fprintf(stderr, "usage: benchmark_solvers TWO_ROOMS.obj [small]\n");
    return 1;
  }
  patchlight::print_tables(arguments[1], count == 3);
  return 0;
}
