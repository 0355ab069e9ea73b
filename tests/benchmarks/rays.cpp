// Rows of rays against path tracing: cost and error of a whole run. docs/benchmarks/speed.md, scripts/large_rooms.py.
//
// usage: benchmark_rays MODEL PATCHES [CHECKED [PATHS [RAYS]]]
#include "patchlight/input/read_scene.h"
#include "patchlight/simulate.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "benchmarks/room.h"
#include "verify/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace patchlight::benchmarks {
namespace {

double reflected_norm(const Simulation& s) {
  return std::sqrt(((s.solution.radiosity - s.problem.exitance).square().colwise() * s.problem.area.array()).sum());
}

// Patches drawn in proportion to A (B + B_rms / 5), by their own share of the sum: bright ones decide the error.
struct Drawn {
  std::vector<PatchIndex> patches;
  std::vector<double> density;  // B + B_rms / 5, W/m^2
};

Drawn drawn(const Simulation& s, std::size_t count) {
  const Field reflected = s.solution.radiosity - s.problem.exitance;
  const double least = 0.2 * reflected_norm(s) / std::sqrt(s.problem.area.sum());
  std::vector<double> upto;
  double sum = 0;
  const auto density = [&](Eigen::Index i) { return reflected.row(i).mean() + least; };
  for (Eigen::Index i = 0; i < reflected.rows(); ++i) upto.push_back(sum += s.problem.area[i] * density(i));
  Drawn chosen;
  for (std::size_t k = 0; k < count; ++k) {
    const double at = (static_cast<double>(k) + hash({17, k}) * 0x1p-32) / static_cast<double>(count) * sum;
    const auto i =
        std::min<std::size_t>(upto.size() - 1, std::upper_bound(upto.begin(), upto.end(), at) - upto.begin());
    chosen.patches.push_back(static_cast<PatchIndex>(i));
    chosen.density.push_back(density(static_cast<Eigen::Index>(i)));
  }
  return chosen;
}

struct Errors {
  double true_error = 0;  // relative to reflected light, root mean square by area, less the noise of the paths
  double noise = 0;       // of the paths
  double stated = 0;      // the bars of the same patches
  double median = 0;      // of |error| / light
  double covered = 0;     // share of the patches within two of their bars and standard errors of the paths
  double mean = 0;        // difference of the sums
};

Errors errors_of(const Scene& scene, const Simulation& s, std::size_t checked, std::uint32_t paths) {
  const Drawn chosen = drawn(s, checked);
  std::vector<PathReceiver> receivers;
  for (const PatchIndex i : chosen.patches)
    receivers.push_back({s.mesh.corner_points(i).points, s.mesh.polygon[i], s.mesh.side[i]});
  const PathEstimate traced = trace_irradiance(scene, s.plan.sides, receivers, {.paths = paths, .seed = 5});
  const Field bar = s.error_bars->total();
  double squares = 0, noise = 0, stated = 0, light = 0, covered = 0, difference = 0, sum = 0;
  std::vector<double> relative;
  for (std::size_t k = 0; k < checked; ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const auto i = static_cast<Eigen::Index>(chosen.patches[k]);
    const auto rho = s.problem.scattering.reflectance.row(i);
    const auto off = s.solution.irradiance.row(i) - traced.irradiance.row(row);
    const double weight = 1 / chosen.density[k];
    squares += weight * (rho * off).square().sum();
    noise += weight * (rho * traced.standard_error.row(row)).square().sum();
    stated += weight * (rho * bar.row(i)).square().sum();
    light += weight * (rho * traced.irradiance.row(row)).square().sum();
    const auto scatter = (bar.row(i).square() + traced.standard_error.row(row).square()).sqrt();
    covered += (off.abs() <= 2 * scatter).all() ? 1 : 0;
    difference += weight * (rho * off).sum();
    sum += weight * (rho * traced.irradiance.row(row)).sum();
    if (traced.irradiance(row, 0) > 0) relative.push_back(std::abs(off(0)) / traced.irradiance(row, 0));
  }
  return {std::sqrt(std::max(0.0, squares - noise) / light),
          std::sqrt(noise / light),
          std::sqrt(stated / light),
          median(relative),
          covered / static_cast<double>(checked),
          difference / sum};
}

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: benchmark_rays MODEL PATCHES [CHECKED [PATHS [RAYS]]]\n");
    return 1;
  }
  const Scene scene = read_scene(argv[1]);
  Request request;
  request.mesh.patches = std::strtoul(argv[2], nullptr, 10);
  request.assembly.storage = Storage::rays;
  request.solver.solver = Solver::gmres;
  if (argc > 5) request.assembly.rays = std::max(16, std::atoi(argv[5]));
  const double begin = cpu_seconds();
  const Simulation s = simulate(scene, request);
  std::printf("%u patches, %.2f CPU s, %.2f GB at the peak;", s.mesh.size(), cpu_seconds() - begin,
              peak_memory() / 1e9);
  for (const StageCost& cost : s.costs) std::printf(" %s %.2f", name_of(cost.stage), cost.cpu_seconds);
  std::printf("; %zu iterations, %g applications; balance off by %.1e\n", s.solution.history.size() - 1,
              s.solution.history.back().work, s.balance.imbalance);
  const Field squares = (s.problem.scattering.reflectance * s.error_bars->total()).square();
  std::printf("bar of all patches %.4f\n",
              std::sqrt((squares.colwise() * s.problem.area.array()).sum()) / reflected_norm(s));
  if (argc < 4) return 0;
  const std::size_t checked = std::strtoul(argv[3], nullptr, 10);
  const auto paths = static_cast<std::uint32_t>(argc > 4 ? std::strtoul(argv[4], nullptr, 10) : 16384);
  const Errors e = errors_of(scene, s, checked, paths);
  std::printf(
      "by %zu patches and %u paths each: error %.4f (noise of paths %.4f), stated %.4f, median %.4f, within two "
      "bars %.3f, mean %+.4f\n",
      checked, paths, e.true_error, e.noise, e.stated, e.median, e.covered, e.mean);
  return 0;
}

}  // namespace
}  // namespace patchlight::benchmarks

int main(int argc, char** argv) { return patchlight::benchmarks::main(argc, argv); }
