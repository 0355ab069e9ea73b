// How far answers scatter from seed to seed, against the errors that are stated: of patches by the sampling of their
// form factors, and of sensors by their own shadow rays. Errors that are right have a ratio of 1. usage:
// benchmark_seeds PATCHES SEEDS MODEL...
#include "patchlight/gather/gather.h"
#include "patchlight/input/read_scene.h"
#include "patchlight/simulate.h"

#include "visibility/occluder.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <vector>

namespace {

using namespace patchlight;

Simulation solved(const Scene& scene, std::size_t patches, std::uint64_t seed) {
  Request request;
  request.mesh.sides = Sides::front;
  request.mesh.patches = patches;
  request.accuracy.error_bars = true;
  request.assembly.seed = seed;
  return simulate(scene, request);
}

// A grid of 6 x 6 sensors that face along the third axis, at a third of the scene's extent there.
std::vector<Sensor> sensors_in(const Scene& scene) {
  const Box box = bounds(scene);
  constexpr int up = 2;
  std::vector<Sensor> sensors;
  for (int k = 0; k < 36; ++k) {
    Vector share = Vector::Constant(1.0 / 3);
    share[(up + 1) % 3] = (k % 6 + 0.5) / 6;
    share[(up + 2) % 3] = (k / 6 + 0.5) / 6;
    sensors.push_back({.point = box.min() + share.cwiseProduct(box.diagonal()), .normal = Vector::Unit(up)});
  }
  return sensors;
}

// What several answers to one question scatter by, and what they say that they do.
struct Scatter {
  Field sum;
  Field squares;
  Field stated;  // summed variances
  int count = 0;

  void add(const Field& values, const Field& errors) {
    if (count++ == 0) sum = squares = stated = Field::Zero(values.rows(), values.cols());
    sum += values;
    squares += values.square();
    stated += errors.square();
  }
  // Summed variances, observed and stated.
  double observed() const { return (squares - sum.square() / count).sum() / (count - 1); }
  double expected() const { return stated.sum() / count; }
};

void print(const char* model, std::size_t patches, int seeds) {
  const Scene scene = read_scene(model);
  const std::vector<Sensor> sensors = sensors_in(scene);
  Scatter of_patches, of_sensors;
  const Simulation first = solved(scene, patches, 1);
  const Occluder occluder(scene, Occluder::Blockers::all, find_coverings(scene, first.plan.sides));
  for (int k = 0; k < seeds; ++k) {
    const auto seed = static_cast<std::uint64_t>(k + 1);
    const Simulation simulation = solved(scene, patches, seed);
    of_patches.add(simulation.solution.irradiance, simulation.error_bars->form_factor);
    const GatheredIrradiance gathered =
        gather_irradiance(first.mesh, first.solution.radiosity, occluder, sensors, {.seed = seed});
    of_sensors.add(gathered.irradiance, gathered.errors.rays);
  }
  std::printf("| %s | %u | %.2f | %.2f |\n", std::filesystem::path(model).stem().c_str(), first.mesh.size(),
              std::sqrt(of_patches.observed() / of_patches.expected()),
              std::sqrt(of_sensors.observed() / of_sensors.expected()));
  std::fflush(stdout);
}

}  // namespace

int main(int count, char** values) {
  if (count < 4) {
    std::fputs("usage: benchmark_seeds PATCHES SEEDS MODEL...\n", stderr);
    return 1;
  }
  std::puts("| scene | patches | scatter / stated, patches | scatter / stated, sensors |\n|---|---|---|---|");
  for (int k = 3; k < count; ++k) print(values[k], std::strtoul(values[1], nullptr, 10), std::atoi(values[2]));
  return 0;
}
