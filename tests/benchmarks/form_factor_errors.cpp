// What form factors are worth: entries, solutions and stated errors against a reference with many more samples, and
// unoccluded entries against closed forms.
// usage: benchmark_form_factor_errors ROOM.obj PATCHES REFERENCE SAMPLES [--benchmark_...]
// with 0 PATCHES every polygon is one patch; the reference is read from the file REFERENCE, or made with so many
// SAMPLES per pair and written there
#include "patchlight/transport/assemble.h"

#include "base/parallel.h"
#include "benchmarks/calibration.h"
#include "benchmarks/entry_errors.h"
#include "benchmarks/reference.h"
#include "benchmarks/room.h"
#include "benchmarks/sampled_entries.h"
#include "benchmarks/solution_error.h"
#include "benchmarks/unoccluded.h"
#include "visibility/occluder.h"

#include <benchmark/benchmark.h>
#include <cstdio>
#include <memory>
#include <string>

namespace {

using namespace patchlight;
using namespace patchlight::benchmarks;

struct Work {
  Room room;
  ExchangeAreas reference;
};

Assembly assembled(const Work& work, const AssemblyOptions& options) {
  return assemble_exchange_areas(work.room.mesh, Occluder(work.room.scene), options);
}

Assembly assembled_by_default(const Work& work) {
  AssemblyOptions options;
  options.keep_errors = true;
  return assembled(work, options);
}

void entries(benchmark::State& state, const Work& work) {
  for (auto _ : state) {
    const ThreadLimit one(1);
    const double start = cpu_seconds();
    const Assembly assembly = assembled(work, {static_cast<int>(state.range(0)), 1});
    state.counters["cpu_s"] = cpu_seconds() - start;
    const auto errors = entry_errors(work.room.mesh, assembly.exchange_areas, work.reference);
    state.counters["patches"] = work.room.mesh.size();
    state.counters["row_sum_rms"] = row_sum_error(work.room, assembly.exchange_areas).rms;
    state.counters["l1"] = errors.l1;
    state.counters["p999"] = errors.p999;
    state.counters["mean_F"] = errors.mean_F;
    state.counters["matvec"] = errors.matvec;
  }
}

void solutions(benchmark::State& state, const Work& work) {
  for (auto _ : state) {
    const Assembly assembly = assembled(work, {static_cast<int>(state.range(0)), 1});
    const SolutionErrors errors = solution_errors(work.room, assembly.exchange_areas, work.reference);
    state.counters["patches"] = work.room.mesh.size();
    state.counters["mixed"] = errors.mixed;
    state.counters["bright"] = errors.bright;
  }
}

void add(benchmark::State& state, const std::string& prefix, const Spread& spread) {
  state.counters[prefix + "_pairs"] = spread.pairs;
  state.counters[prefix + "_within"] = spread.within;
  state.counters[prefix + "_rms_z"] = spread.rms_z;
  state.counters[prefix + "_mean_z"] = spread.mean_z;
}

void calibration(benchmark::State& state, const Work& work) {
  for (auto _ : state) {
    const Assembly assembly = assembled_by_default(work);
    const std::vector<SampledEntry> sampled = sampled_entries(work.room, assembly);
    const PartialPairs partial = partial_pairs(sampled, assembly, work.reference);
    state.counters["patches"] = work.room.mesh.size();
    add(state, "partial", partial.all);
    for (std::size_t bin = 0; bin < partial.bins.size(); ++bin) {
      add(state, "bin" + std::to_string(bin), partial.bins[bin]);
    }
    for (const bool visible : {true, false}) {
      const UnanimousPairs pairs = unanimous_pairs(sampled, assembly, work.reference, visible);
      const std::string prefix = visible ? "visible" : "occluded";
      state.counters[prefix + "_pairs"] = pairs.pairs;
      state.counters[prefix + "_within"] = pairs.within;
      state.counters[prefix + "_bound"] = pairs.bound;
      state.counters[prefix + "_audited_rate"] = pairs.audited_rate;
      state.counters[prefix + "_rate"] = pairs.rate;
    }
    const DecidedPairs decided = decided_pairs(work.room, assembly);
    state.counters["free_pairs"] = decided.free;
    state.counters["free_wrong"] = decided.free_wrong;
    state.counters["free_error"] = decided.free_error;
    state.counters["hidden_pairs"] = decided.hidden;
    state.counters["hidden_wrong"] = decided.hidden_wrong;
  }
}

void unoccluded(benchmark::State& state, const Work& work) {
  for (auto _ : state) {
    const ExchangeAreas exact = without_occluders(work.room);
    const auto zones = zone_errors(work.room.mesh, exact);
    state.counters["patches"] = work.room.mesh.size();
    for (std::size_t zone = 0; zone < zones.size(); ++zone) {
      const std::string prefix = zone == 0 ? "near" : zone == 1 ? "middle" : "far";
      state.counters[prefix + "_pairs"] = zones[zone].pairs;
      state.counters[prefix + "_median"] = zones[zone].median;
      state.counters[prefix + "_p999"] = zones[zone].p999;
      state.counters[prefix + "_max"] = zones[zone].largest;
      state.counters[prefix + "_max_F"] = zones[zone].largest_F;
      state.counters[prefix + "_within"] = zones[zone].within_millionth;
      state.counters[prefix + "_within_F"] = zones[zone].within_millionth_F;
    }
    state.counters["entries_above"] = entries_above(assembled_by_default(work).exchange_areas, exact);
    for (const int angle : {90, 20, 1}) {
      state.counters["edge_sharing_" + std::to_string(angle)] = edge_sharing_error(angle);
    }
  }
}

template <typename Function>
benchmark::internal::Benchmark* add(const char* name, Function function, const std::shared_ptr<Work>& work) {
  return benchmark::RegisterBenchmark(name, [=](benchmark::State& state) { function(state, *work); })
      ->Iterations(1)
      ->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int count, char** values) {
  if (count < 5) {
    std::fprintf(stderr, "usage: benchmark_form_factor_errors ROOM.obj PATCHES REFERENCE SAMPLES [--benchmark_...]\n");
    return 1;
  }
  Room room = read_room(values[1], std::stoul(values[2]));
  ExchangeAreas exact = reference(room, std::stoi(values[4]), values[3]);
  const auto work = std::make_shared<Work>(Work{std::move(room), std::move(exact)});
  auto* const curve = add("entries", entries, work)->ArgNames({"samples"});
  for (const int samples : settings()) curve->Args({samples});
  const AssemblyOptions defaults;
  auto* const solved = add("solutions", solutions, work)->ArgNames({"samples"});
  solved->Args({defaults.samples})->Args({48});
  add("calibration", calibration, work);
  add("unoccluded", unoccluded, work);
  return run(count, values, 5);
}
