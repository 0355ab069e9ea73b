// One application of the stored matrix, and one sweep over it, against a plain pass over the same bytes.
#include "base/parallel.h"
#include "base/target_clones.h"
#include "transport/closure.h"
#include "transport/dense.h"
#include "transport/tiles.h"

#include <array>
#include <benchmark/benchmark.h>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

namespace patchlight {
namespace {

constexpr PatchIndex size = 20000;
constexpr int bands = 3;

// A closed made-up scene: what is in the entries does not matter for their speed.
ExchangeAreas made_up() {
  ExchangeAreas S(size);
  parallel_for(Tiles::blocks(S), [&](std::size_t row) {
    const auto I = static_cast<PatchIndex>(row);
    for (PatchIndex J = I; J < Tiles::blocks(S); ++J) {
      std::span<float> tile = Tiles::of(S, I, J);
      for (std::size_t k = 0; k < tile.size(); ++k) {
        tile[k] = static_cast<float>(1 + (k * 2654435761U + J) % 1024) / (1024.0F * size);
      }
    }
  });
  return S;
}

PATCHLIGHT_TARGET_CLONES
float sum_of(const float* values, std::size_t count) {
  std::array<float, 128> sums{};
  for (std::size_t k = 0; k + 128 <= count; k += 128) {
    for (std::size_t lane = 0; lane < 128; ++lane) sums[lane] += values[k + lane];
  }
  return std::accumulate(sums.begin(), sums.end(), 0.0F);
}

void stream(benchmark::State& state) {
  const ExchangeAreas S = made_up();
  // The tiles lie one after the other.
  const float* const first = Tiles::of(S, 0, 0).data();
  const std::size_t count = ExchangeAreas::bytes(size) / sizeof(float);
  constexpr std::size_t pieces = 64;
  std::array<float, pieces> sums{};
  for (auto _ : state) {
    parallel_for(pieces, [&](std::size_t n) {
      const std::size_t begin = count * n / pieces;
      sums[n] = sum_of(first + begin, count * (n + 1) / pieces - begin);
    });
    benchmark::DoNotOptimize(sums);
  }
  state.counters["GB_per_s"] =
      benchmark::Counter(4e-9 * static_cast<double>(count), benchmark::Counter::kIsIterationInvariantRate);
}

Field radiosity() {
  Field B(size, bands);
  for (Eigen::Index i = 0; i < size; ++i) B.row(i).setConstant(1 + 0.5 * std::sin(0.001 * static_cast<double>(i)));
  return B;
}

std::unique_ptr<RowTransport> made_up_transport() {
  return dense_transport(keep_exchange_areas(made_up(), "made up"), Eigen::VectorXd::Ones(size));
}

void application(benchmark::State& state) {
  const auto transport = made_up_transport();
  const Field B = radiosity();
  for (auto _ : state) benchmark::DoNotOptimize(transport->apply(B));
}

void sweep(benchmark::State& state) {
  const auto transport = made_up_transport();
  const Field B = radiosity();
  const Relax relax = [](const SweptPatches& patches) -> Field { return 0.5 * patches.irradiance; };
  Sweep last{B, {}, {}};
  for (auto _ : state) last = transport->sweep(std::move(last), relax, {});
}

BENCHMARK(stream)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(application)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(sweep)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

}  // namespace
}  // namespace patchlight

BENCHMARK_MAIN();
