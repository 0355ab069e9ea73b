#include "benchmarks/shadow_packets.h"

#include "form_factor/pair_samples.h"
#include "form_factor/patch_keys.h"

#include <algorithm>

namespace patchlight::benchmarks {
namespace {

constexpr int packet = static_cast<int>(ShadowPacket::size);

// Pairs that come one after the other are of the same clusters: so many are taken together, as in the assembly.
constexpr std::size_t pairs_together = 256;

struct PacketMaker {
  const std::vector<PatchShape>& shapes;
  std::vector<SampledPatch> patches;
  std::vector<std::uint32_t> keys;
  SampleTable table;
  double scale;
  std::vector<ShadowPacket> made;

  // So many samples of some pairs; each packet holds as many of a pair as fill it evenly.
  void add(const std::vector<SampledEntry>& pairs, int end) {
    PairSamples next;
    for (int k = 0; k < end;) {
      const int step = k % 16 == 0 && end - k >= 16 ? 16
                       : k % 8 == 0 && end - k >= 8 ? 8
                       : k % 4 == 0 && end - k >= 4 ? 4
                                                    : 2;
      const auto at_once = static_cast<std::size_t>(packet / step);
      for (std::size_t p = 0; p < pairs.size(); p += at_once) {
        for (std::size_t n = 0; n < at_once; ++n) {
          const SampledEntry& pair = pairs[std::min(p + n, pairs.size() - 1)];
          add_samples(next, static_cast<int>(n) * step, step, patches[pair.first], patches[pair.second],
                      table.of_pair(keys[pair.first], keys[pair.second]), static_cast<std::uint32_t>(k), scale);
        }
        made.push_back(next.rays);
      }
      k += step;
    }
  }
};

}  // namespace

std::vector<ShadowPacket> shadow_packets(const Room& room, const TracingFrame& frame, const AssemblyOptions& options,
                                         const std::vector<SampledEntry>& sampled, std::size_t packets) {
  const std::vector<PatchShape> shapes = patch_shapes(room.mesh);
  PacketMaker maker{shapes,      {}, patch_keys(room.mesh), SampleTable(static_cast<std::uint32_t>(options.samples), 1),
                    frame.scale, {}};
  for (PatchIndex i = 0; i < room.mesh.size(); ++i) {
    maker.patches.push_back(sampled_patch(shapes[i], room.mesh.polygon[i], frame));
  }
  const double rays = static_cast<double>(sampled.size()) * options.samples;
  const auto stride = pairs_together * static_cast<std::size_t>(1 + rays / (packet * static_cast<double>(packets)));
  for (std::size_t first = 0; first < sampled.size() && maker.made.size() < packets; first += stride) {
    std::vector<SampledEntry> pairs;
    for (std::size_t k = first; k < std::min(sampled.size(), first + pairs_together); ++k) {
      if (is_adjacent(shapes[sampled[k].first], shapes[sampled[k].second])) continue;
      pairs.push_back(sampled[k]);
    }
    maker.add(pairs, options.samples);
  }
  return std::move(maker.made);
}

}  // namespace patchlight::benchmarks
