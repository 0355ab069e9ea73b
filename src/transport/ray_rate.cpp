#include "transport/ray_rate.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "form_factor/pair_samples.h"
#include "form_factor/patch_shape.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <vector>

namespace patchlight {
namespace {

constexpr std::size_t rays_per_pair = 4;
constexpr std::size_t pairs_per_packet = ShadowPacket::size / rays_per_pair;
constexpr std::size_t packets_per_task = 64;
constexpr std::size_t most_packets = 16384;

// Packets as those of an assembly with few samples: pairs of one patch with patches that follow each other.
struct PacketMaker {
  const PatchMesh& mesh;
  const std::vector<PatchShape> shapes = patch_shapes(mesh);
  const SampleTable table{rays_per_pair, 1};
  TracingFrame frame;

  ShadowPacket packet(std::uint32_t number) const {
    // Patches that do not face each other are drawn again, a few times.
    PatchIndex i = 0;
    PatchIndex j = 0;
    for (std::uint32_t draw = 0; draw < 16; ++draw) {
      i = hash({number, draw, 0}) % mesh.size();
      j = hash({number, draw, 1}) % mesh.size();
      if (orientation(shapes[i], shapes[j]) != Orientation::averted) break;
    }
    PairSamples samples;
    const SampledPatch from = sampled_patch(shapes[i], mesh.polygon[i], frame);
    for (std::size_t n = 0; n < pairs_per_packet; ++n) {
      const auto second = static_cast<PatchIndex>((j + n) % mesh.size());
      const SampledPatch to = sampled_patch(shapes[second], mesh.polygon[second], frame);
      add_samples(samples, static_cast<int>(n * rays_per_pair), static_cast<int>(rays_per_pair), from, to,
                  table.of_pair(i, second), 0, frame.scale);
    }
    return samples.rays;
  }
};

}  // namespace

double bare_ray_rate(const PatchMesh& mesh, const Occluder& occluder, std::uint64_t rays) {
  const std::size_t packets = std::min<std::size_t>(rays / ShadowPacket::size, most_packets);
  const std::size_t tasks = packets / packets_per_task;
  if (tasks == 0 || mesh.size() < 2) return 0;
  const PacketMaker maker{.mesh = mesh, .frame = occluder.frame()};
  std::vector<ShadowPacket> made(tasks * packets_per_task);
  parallel_for(made.size(), [&](std::size_t k) { made[k] = maker.packet(static_cast<std::uint32_t>(k)); });

  std::vector<std::uint32_t> blocked(tasks);
  const double start = wall_seconds();
  parallel_for(tasks, [&](std::size_t task) {
    for (std::size_t k = 0; k < packets_per_task; ++k) {
      blocked[task] += occluder.occluded(made[task * packets_per_task + k]);
    }
  });
  const double seconds = wall_seconds() - start;
  return seconds > 0 ? static_cast<double>(made.size() * ShadowPacket::size) / seconds : 0;
}

}  // namespace patchlight
