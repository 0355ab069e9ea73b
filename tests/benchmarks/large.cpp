// What geometry of many corners and faces takes, and by what power of their number it grows: 1 and a little for N log
// N. usage: benchmark_large
#include "base/parallel.h"
#include "scene/coverings.h"
#include "scene/simple_polygon.h"
#include "scene/triangulate.h"
#include "support/large_shapes.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>

namespace {

using namespace patchlight;
using namespace patchlight::test;

// The least of three runs.
double seconds_of(const std::function<void()>& run) {
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const double begin = cpu_seconds();
    run();
    least = std::min(least, cpu_seconds() - begin);
  }
  return least;
}

void measure(const char* name, int few, const std::function<void(int)>& work) {
  const double less = seconds_of([&] { work(few); });
  const double more = seconds_of([&] { work(4 * few); });
  std::printf("%-22s %8d: %.4f CPU s  %8d: %.4f CPU s  power %.2f\n", name, few, less, 4 * few, more,
              std::log(more / less) / std::log(4));
}

}  // namespace

int main() {
  measure("triangles of a disc", 32000, [](int n) { triangulate(disc(n)); });
  measure("crossings of a disc", 32000, [](int n) { crosses_itself(disc(n)); });
  measure("leaves on one edge", 16000, [](int n) {
    const Scene scene = book(n);
    find_coverings(scene, kept_sides(scene, Sides::both));
  });
  return 0;
}
