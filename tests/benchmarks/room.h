#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"
#include "patchlight/transport/exchange_areas.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace patchlight::benchmarks {

struct Room {
  Scene scene;
  PatchMesh mesh;
  std::vector<std::uint8_t> is_whole;  ///< per patch: all of it sees nothing but patches, so that its row sums to 1
};

/// The front sides of a model in about so many patches; with 0 every polygon is one patch. Patches that stand on
/// others, like a floor under the leg of a table, are not whole.
Room read_room(const std::string& file, std::size_t patches);

/// How far raw row sums are from 1, over the whole patches.
struct RowSumError {
  double rms = 0;
  double largest = 0;
};
RowSumError row_sum_error(const Room& room, const ExchangeAreas& S);

/// Samples to measure the curve of error against cost at; the default of the program is among them.
std::vector<int> settings();

/// Largest resident set of this process so far, in bytes.
double peak_memory();

/// The middle one of an odd number of values.
double median(std::vector<double> values);

/// Runs the registered benchmarks; `first` is the first of the arguments that are Google Benchmark's.
int run(int count, char** values, int first);

}  // namespace patchlight::benchmarks
