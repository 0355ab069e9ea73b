#include "benchmarks/sampled_entries.h"

#include "form_factor/patch_cluster.h"
#include "form_factor/patch_shape.h"

namespace patchlight::benchmarks {

std::vector<SampledEntry> sampled_entries(const Room& room, const Assembly& assembly) {
  const std::vector<PatchShape> shapes = patch_shapes(room.mesh);
  const std::vector<PatchCluster> clusters = patch_clusters(room.mesh, shapes);
  std::vector<SampledEntry> entries;
  const auto add = [&](PatchIndex i, PatchIndex j) {
    const EntryKind kind = assembly.entry_errors.kind(i, j);
    if (kind == EntryKind::exact) return;
    entries.push_back({i, j, unoccluded_exchange_area(shapes[i], shapes[j]), kind == EntryKind::estimated});
  };
  for (std::size_t row = 0; row < clusters.size(); ++row) {
    for (std::size_t column = row; column < clusters.size(); ++column) {
      for (int a = 0; a < clusters[row].size; ++a) {
        for (int b = column == row ? a + 1 : 0; b < clusters[column].size; ++b) {
          add(clusters[row].patches[static_cast<std::size_t>(a)],
              clusters[column].patches[static_cast<std::size_t>(b)]);
        }
      }
    }
  }
  return entries;
}

}  // namespace patchlight::benchmarks
