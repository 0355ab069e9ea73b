// The error of progressive refinement, with rows of form factors on demand, against the fraction of computed rows.
// usage: benchmark_progressive OUT PATCHES MODEL...
// Prints a table per model; OUT takes progressive.png, and MODEL.csv with all that was measured.
#include "patchlight/input/read_scene.h"
#include "patchlight/plan/plan.h"
#include "patchlight/solve/solve.h"
#include "patchlight/transport/exchange.h"

#include "base/parallel.h"
#include "mesh/mesher.h"
#include "output/plot/write_plot.h"
#include "pipeline/problem_of.h"
#include "transport/closure.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

namespace {

using namespace patchlight;

// A model cut into patches.
struct Room {
  std::string name;
  Scene scene;
  Plan plan;
  PatchMesh mesh;
  Coverings coverings;
};

Room room_of(const std::filesystem::path& file, std::size_t patches) {
  Room room{file.stem().string(), read_scene(file), {}, {}, {}};
  Request request;
  request.mesh.patches = patches;
  room.plan = make_plan(room.scene, request);
  room.mesh = tessellate(room.scene, room.plan.sides, room.plan.max_edge);
  room.coverings = find_coverings(room.scene, room.plan.sides);
  return room;
}

// The converged solution of the stored, closed matrix, with the CPU seconds of its parts.
struct Reference {
  RadiosityProblem problem;
  Field radiosity;
  double assembly = 0;
  double closure = 0;
  double solve = 0;
};

Reference reference_of(const Room& room, const Occluder& occluder) {
  Reference reference;
  double begin = cpu_seconds();
  Exchange exchange = trace_exchange(room.mesh, occluder, room.plan.assembly);
  reference.assembly = cpu_seconds() - begin;
  const Eigen::VectorXd area = exchange.area;
  reference.problem = problem_of(room.scene, room.mesh, area, room.plan.sides.emit_from_back);

  begin = cpu_seconds();
  const auto transport = dense_transport(close_exchange(std::move(exchange)), area);
  reference.closure = cpu_seconds() - begin;

  begin = cpu_seconds();
  reference.radiosity = solve(*transport, reference.problem, {.relative_error = 1e-9}).radiosity;
  reference.solve = cpu_seconds() - begin;
  return reference;
}

// ||B_ref - B||_A / ||B_ref - E||_A, the worst band.
double error_of(const Field& radiosity, const Reference& reference) {
  const Eigen::VectorXd& area = reference.problem.area;
  const Field reflected = reference.radiosity - reference.problem.exitance;
  return (area_norm(reference.radiosity - radiosity, area) / area_norm(reflected, area)).maxCoeff();
}

// The picture after this number of rows.
struct Shown {
  double rows = 0;  // fraction of all rows
  double cpu_seconds = 0;
  double error = 0;
  double error_without_ambient = 0;
};

struct SolverRun {
  Solver solver;
  std::vector<Shown> shown;
};

std::vector<Shown> shown(const Room& room, const Occluder& occluder, Solver solver, const Reference& reference) {
  const RadiosityProblem& problem = reference.problem;
  std::vector<Shown> all;
  double measuring = 0;
  const double begin = cpu_seconds();
  const Exchange exchange = exchange_on_demand(room.mesh, occluder, room.plan.assembly);
  const auto transport = on_demand_transport(room.mesh, occluder, room.plan.assembly, exchange.area);
  SolverOptions options{.solver = solver, .relative_error = 1e-9, .max_iterations = 1};
  options.largest_row_sum = std::numeric_limits<double>::infinity();
  solve(*transport, problem, options, [&](const Progress& progress) {
    // Skips the lamps before their light has arrived.
    if (progress.iteration == nullptr || progress.iteration->number == 0) return true;
    const double now = cpu_seconds();
    const Field shot = progress.irradiance();
    const Field H = shot + *progress.ambient;
    all.push_back({progress.iteration->work, now - begin - measuring,
                   error_of(problem.exitance + problem.scattering.reflectance * H, reference),
                   error_of(problem.exitance + problem.scattering.reflectance * shot, reference)});
    measuring += cpu_seconds() - now;
    return true;
  });
  return all;
}

// The last picture with at most this fraction of the rows.
const Shown& at(const std::vector<Shown>& all, double share) {
  const auto after = std::find_if(all.begin(), all.end(), [share](const Shown& one) { return one.rows > share; });
  return after == all.begin() ? *after : *(after - 1);
}

void print_table(const Room& room, const Reference& reference, const std::vector<SolverRun>& runs) {
  const Eigen::Index lamps = (reference.problem.exitance > 0).rowwise().any().count();
  std::printf("%s: %u patches, %d of them lamps; all form factors %.2f CPU s, closure %.2f, solver %.2f\n\n",
              room.name.c_str(), room.mesh.size(), static_cast<int>(lamps), reference.assembly, reference.closure,
              reference.solve);
  std::printf("| rows |");
  for (const SolverRun& run : runs) std::printf(" %s | without ambient | CPU s |", name_of(run.solver));
  std::printf("\n|---|---|---|---|---|---|---|\n");
  for (const double share : {0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0}) {
    std::printf("| %.0f %% |", 100 * share);
    for (const SolverRun& run : runs) {
      const Shown& one = at(run.shown, share);
      std::printf(" %.1f %% | %.1f %% | %.2f |", 100 * one.error, 100 * one.error_without_ambient, one.cpu_seconds);
    }
    std::printf("\n");
  }
  std::printf("\n");
}

void write_csv(const std::filesystem::path& file, const std::vector<SolverRun>& runs) {
  std::ofstream stream(file);
  stream << "solver,rows,cpu_seconds,error,error_without_ambient\n";
  for (const SolverRun& run : runs) {
    for (const Shown& one : run.shown) {
      stream << name_of(run.solver) << ',' << one.rows << ',' << one.cpu_seconds << ',' << one.error << ','
             << one.error_without_ambient << '\n';
    }
  }
}

Curve curve_of(const std::string& name, const SolverRun& run, double Shown::*error) {
  Curve curve{name, {}};
  for (const Shown& one : run.shown) curve.points.push_back({100 * one.rows, 100 * one.*error});
  return curve;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: benchmark_progressive OUT PATCHES MODEL...\n");
    return 1;
  }
  const std::filesystem::path out = argv[1];
  Plot plot{"What progressive refinement shows, rows on demand",
            {"rows of form factors computed, %", Scale::logarithmic},
            {"error of the reflected light, %", Scale::logarithmic},
            {}};
  for (int k = 3; k < argc; ++k) {
    const Room room = room_of(argv[k], std::strtoul(argv[2], nullptr, 10));
    const Occluder occluder(room.scene, Occluder::Blockers::inside_hull, room.coverings);
    const Reference reference = reference_of(room, occluder);
    std::vector<SolverRun> runs;
    for (const Solver solver : {Solver::progressive, Solver::overshooting}) {
      runs.push_back({solver, shown(room, occluder, solver, reference)});
      const std::string name = room.name + ", " + name_of(solver);
      plot.curves.push_back(curve_of(name, runs.back(), &Shown::error));
      plot.curves.push_back(curve_of(name + ", H alone", runs.back(), &Shown::error_without_ambient));
    }
    print_table(room, reference, runs);
    write_csv(out / (room.name + ".csv"), runs);
  }
  write_plot(out / "progressive.png", plot);
  return 0;
}
