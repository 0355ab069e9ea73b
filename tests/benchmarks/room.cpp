#include "benchmarks/room.h"

#include "patchlight/input/read_scene.h"
#include "patchlight/transport/assemble.h"
#include "patchlight/transport/lost_share.h"

#include "mesh/mesher.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <benchmark/benchmark.h>
#include <cmath>
#include <limits>
#include <sys/resource.h>

namespace patchlight::benchmarks {
namespace {

// Rays per patch that look for what is not whole: a hidden hundredth of a patch escapes them once in 600 times.
constexpr int rays_per_patch = 640;

}  // namespace

Room read_room(const std::string& file, std::size_t patches) {
  Room room{read_scene(file), {}, {}};
  const KeptSides sides = kept_sides(room.scene, Sides::front);
  const double max_edge = patches == 0 ? std::numeric_limits<double>::max() : max_edge_for(room.scene, sides, patches);
  room.mesh = tessellate(room.scene, sides, max_edge);
  const LostShare lost = measure_lost_share(room.mesh, Occluder(room.scene), rays_per_patch, 1);
  const Eigen::VectorXd hidden = lost.escaped + lost.at_backs + lost.covered;
  for (PatchIndex i = 0; i < room.mesh.size(); ++i) room.is_whole.push_back(hidden[i] > 0 ? 0 : 1);
  return room;
}

RowSumError row_sum_error(const Room& room, const ExchangeAreas& S) {
  const Eigen::VectorXd sums = row_sums(S);
  double squares = 0;
  double count = 0;
  RowSumError error;
  for (PatchIndex i = 0; i < room.mesh.size(); ++i) {
    if (room.is_whole[i] == 0) continue;
    const double defect = std::abs(sums[i] / room.mesh.area[i] - 1);
    squares += defect * defect;
    error.largest = std::max(error.largest, defect);
    ++count;
  }
  error.rms = std::sqrt(squares / std::max(1.0, count));
  return error;
}

std::vector<int> settings() { return {2, 4, 8, 16, 18, 32, 64}; }

double peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

int run(int count, char** values, int first) {
  values[first - 1] = values[0];
  int left = count - first + 1;
  benchmark::Initialize(&left, values + first - 1);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace patchlight::benchmarks
