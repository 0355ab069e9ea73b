// What the accuracy of form factors costs: raw row sums and, where a reference file is given, the entries of the closed
// room against CPU seconds of the assembly alone.
// usage: benchmark_form_factors ROOM.obj MAX_EDGE [--benchmark_...]    with a MAX_EDGE of 9 every polygon is one patch
#include "patchlight/base/parallel.h"
#include "patchlight/input/read_scene.h"
#include "patchlight/mesh/mesher.h"
#include "patchlight/transport/assemble.h"

#include <benchmark/benchmark.h>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>

namespace {

using namespace patchlight;

struct Room {
  Scene scene;
  PatchMesh mesh;
};

Room read_room(const char* file, double max_edge) {
  Room room{read_scene(file, {}), {}};
  room.mesh = tessellate(room.scene, kept_sides(room.scene, Sides::front), max_edge);
  return room;
}

// Root mean square of the row sums' distance from 1, by patch: the room is closed.
double row_sum_error(const PatchMesh& mesh, const ExchangeAreas& S) {
  const Eigen::VectorXd sums = row_sums(S);
  double square = 0;
  for (PatchIndex i = 0; i < mesh.size(); ++i) square += std::pow(sums[i] / mesh.area[i] - 1, 2);
  return std::sqrt(square / mesh.size());
}

void assemble(benchmark::State& state, const Room& room) {
  const auto probes = static_cast<int>(state.range(0));
  const auto samples = static_cast<int>(state.range(1));
  const ThreadLimit threads(static_cast<int>(state.range(2)));
  for (auto _ : state) {
    const double start = cpu_seconds();
    const Occluder occluder(room.scene);
    const Assembly assembly = assemble_exchange_areas(room.mesh, occluder, {probes, samples, 1});
    state.SetIterationTime(cpu_seconds() - start);
    state.counters["row_sum_rms"] = row_sum_error(room.mesh, assembly.exchange_areas);
    state.counters["rays_M"] = 1e-6 * static_cast<double>(assembly.counts.shadow_rays);
    state.counters["facing_M"] = 1e-6 * static_cast<double>(assembly.counts.facing_pairs);
    state.counters["near_M"] = 1e-6 * static_cast<double>(assembly.counts.near_pairs);
    state.counters["free_M"] = 1e-6 * static_cast<double>(assembly.counts.free_pairs);
    state.counters["partial_M"] = 1e-6 * static_cast<double>(assembly.counts.partial_pairs);
  }
}

}  // namespace

int main(int count, char** values) {
  if (count < 3) {
    std::fprintf(stderr, "usage: benchmark_form_factors ROOM.obj MAX_EDGE [--benchmark_...]\n");
    return 1;
  }
  const auto room = std::make_shared<Room>(read_room(values[1], std::stod(values[2])));
  std::printf("%s: %u patches\n", values[1], room->mesh.size());
  auto* const runs =
      benchmark::RegisterBenchmark("assemble", [room](benchmark::State& state) { assemble(state, *room); });
  runs->ArgNames({"probes", "samples", "threads"})->Iterations(1)->UseManualTime()->Unit(benchmark::kMillisecond);
  for (const auto& [probes, samples] :
       {std::pair{2, 2}, {2, 8}, {4, 4}, {4, 16}, {8, 8}, {8, 16}, {16, 64}, {16, 128}}) {
    runs->Args({probes, samples, 1});
  }
  runs->Args({8, 16, 2});
  values[2] = values[0];
  int left = count - 2;
  benchmark::Initialize(&left, values + 2);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
