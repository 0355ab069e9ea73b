// What form factors cost: the error of raw row sums against CPU seconds of the assembly alone, what a second thread
// gains, memory, and how much of the time rays take.
// usage: benchmark_form_factors ROOM.obj PATCHES [--benchmark_...]    with 0 PATCHES every polygon is one patch
#include "patchlight/transport/assemble.h"

#include "base/parallel.h"
#include "benchmarks/room.h"
#include "benchmarks/shadow_packets.h"
#include "visibility/occluder.h"

#include <benchmark/benchmark.h>
#include <cstdio>
#include <memory>
#include <string>

namespace {

using namespace patchlight;
using namespace patchlight::benchmarks;

struct Cost {
  Assembly assembly;
  double cpu = 0;
  double wall = 0;
};

// Set-up of the occluder included; seconds.
Cost measured_assembly(const Room& room, const AssemblyOptions& options, int threads) {
  const ThreadLimit limit(threads);
  const double cpu = cpu_seconds();
  const double wall = wall_seconds();
  const Occluder occluder(room.scene);
  Assembly assembly = assemble_exchange_areas(room.mesh, occluder, options);
  return {std::move(assembly), cpu_seconds() - cpu, wall_seconds() - wall};
}

AssemblyOptions options_of(const benchmark::State& state) { return {static_cast<int>(state.range(0)), 1}; }

void assemble(benchmark::State& state, const Room& room) {
  for (auto _ : state) {
    const Cost cost = measured_assembly(room, options_of(state), static_cast<int>(state.range(1)));
    state.SetIterationTime(cost.cpu);
    const RowSumError error = row_sum_error(room, cost.assembly.exchange_areas);
    const AssemblyCounts& counts = cost.assembly.counts;
    state.counters["patches"] = room.mesh.size();
    state.counters["cpu_s"] = cost.cpu;
    state.counters["wall_s"] = cost.wall;
    state.counters["row_sum_rms"] = error.rms;
    state.counters["row_sum_max"] = error.largest;
    state.counters["rays"] = static_cast<double>(counts.shadow_rays);
    state.counters["facing"] = static_cast<double>(counts.facing_pairs);
    state.counters["near"] = static_cast<double>(counts.near_pairs);
    state.counters["free"] = static_cast<double>(counts.free_pairs);
    state.counters["partial"] = static_cast<double>(counts.partial_pairs);
    state.counters["hidden"] = static_cast<double>(counts.hidden_pairs);
    state.counters["peak_bytes"] = peak_memory();
  }
}

// Three pairs of runs, one after the other, so that other work on the machine hits both alike.
void second_thread(benchmark::State& state, const Room& room) {
  for (auto _ : state) {
    std::vector<double> gain;
    std::vector<double> one_wall;
    std::vector<double> two_wall;
    std::vector<double> processors;
    for (int k = 0; k < 3; ++k) {
      const Cost one = measured_assembly(room, options_of(state), 1);
      const Cost two = measured_assembly(room, options_of(state), 2);
      gain.push_back(one.wall / two.wall);
      one_wall.push_back(one.wall);
      two_wall.push_back(two.wall);
      processors.push_back(two.cpu / two.wall);
    }
    state.SetIterationTime(median(two_wall));
    state.counters["patches"] = room.mesh.size();
    state.counters["gain"] = median(gain);
    state.counters["wall_1"] = median(one_wall);
    state.counters["wall_2"] = median(two_wall);
    state.counters["processors_2"] = median(processors);
  }
}

double seconds_to_trace(const Occluder& occluder, const std::vector<ShadowPacket>& packets) {
  const double start = cpu_seconds();
  for (const ShadowPacket& packet : packets) benchmark::DoNotOptimize(occluder.occluded(packet));
  return cpu_seconds() - start;
}

// Rays per second of the whole assembly and of the tracing of the same rays alone, in turn, on one thread.
void shadow_rays(benchmark::State& state, const Room& room) {
  constexpr std::size_t most_packets = 200000;
  AssemblyOptions keeping = options_of(state);
  keeping.keep_errors = true;
  const Occluder occluder(room.scene);
  const auto sampled = sampled_entries(room, measured_assembly(room, keeping, 0).assembly);
  const auto packets = shadow_packets(room, occluder.frame(), keeping, sampled, most_packets);
  const double traced = static_cast<double>(packets.size() * ShadowPacket::size);
  const ThreadLimit one(1);
  for (auto _ : state) {
    std::vector<double> whole;
    std::vector<double> bare;
    std::vector<double> share;
    for (int k = 0; k < 3; ++k) {
      const Cost cost = measured_assembly(room, options_of(state), 1);
      whole.push_back(static_cast<double>(cost.assembly.counts.shadow_rays) / cost.cpu);
      bare.push_back(traced / seconds_to_trace(occluder, packets));
      share.push_back(whole.back() / bare.back());
    }
    state.SetIterationTime(traced / median(bare));
    state.counters["patches"] = room.mesh.size();
    state.counters["rays_per_s"] = median(whole);
    state.counters["bare_rays_per_s"] = median(bare);
    state.counters["share"] = median(share);
  }
}

template <typename Function>
benchmark::internal::Benchmark* add(const char* name, Function function, const std::shared_ptr<Room>& room) {
  return benchmark::RegisterBenchmark(name, [=](benchmark::State& state) { function(state, *room); })
      ->Iterations(1)
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int count, char** values) {
  if (count < 3) {
    std::fprintf(stderr, "usage: benchmark_form_factors ROOM.obj PATCHES [--benchmark_...]\n");
    return 1;
  }
  const auto room = std::make_shared<Room>(read_room(values[1], std::stoul(values[2])));
  auto* const curve = add("assemble", assemble, room)->ArgNames({"samples", "threads"});
  auto* const gain = add("second_thread", second_thread, room)->ArgNames({"samples"});
  auto* const rays = add("shadow_rays", shadow_rays, room)->ArgNames({"samples"});
  for (const int samples : settings()) {
    curve->Args({samples, 1});
    curve->Args({samples, 2});
    gain->Args({samples});
    rays->Args({samples});
  }
  return run(count, values, 3);
}
