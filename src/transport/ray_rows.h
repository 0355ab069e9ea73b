#pragma once

#include "patchlight/base/large_array.h"
#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/transport/lost_share.h"

#include "optics/surface_optics.h"

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// Storage for blocks of rows during tracing, so that a stopped run can continue. Each block has `patches_of_a_block`
/// patches; the last one may be shorter. Only trace_rows() knows the content of a block. Several threads call keep()
/// for different blocks.
struct RowBlocks {
  static constexpr PatchIndex patches_of_a_block = 4096;

  std::function<std::optional<std::vector<std::int32_t>>(std::size_t block)> read;  ///< empty: not stored
  std::function<void(std::size_t block, std::span<const std::int32_t> words)> keep;
};

/// How a ray of a row continues at a stop.
enum class RayStep : std::uint8_t {
  sent,      ///< the ray starts from a clear polygon
  crossed,   ///< a shadow ray passes straight through a clear polygon
  through,   ///< a hemisphere ray passes straight through, as drawn by SpecularSurface::mirrored_rays()
  mirrored,  ///< a hemisphere ray continues as from a mirror
  kept,      ///< the ray ends on a specular polygon, with the nonspecular fraction there
  ends       ///< the ray ends, with the full remaining share
};
inline constexpr std::uint32_t ray_steps = 6;

/// A stop of a ray on a specular path, whose form factor depends on the color of the clear polygons and mirrors on it.
/// Geometry only, 16 bytes. A ray is the sequence of stops up to one with `kept` or `ends`.
struct SpecularStop {
  static constexpr PatchIndex in_the_open = no_patch;  ///< the ray has left the scene
  static constexpr PatchIndex at_back =
      no_patch - 1;  ///< the ray hits a side without patches, or a face that lies on the patch

  PatchIndex patch = in_the_open;     ///< the patch hit
  float form_factor = 0;              ///< of the ray there, without specular losses
  PolygonIndex polygon = no_polygon;  ///< the specular polygon hit, or from which the ray starts
  std::uint32_t bits = 0;             ///< step, side and cosine of the angle there

  void set(RayStep step, Side side, double cosine);
  RayStep step() const { return static_cast<RayStep>(bits & 7U); }
  Side side() const { return static_cast<Side>(bits >> 3U & 1U); }
  double cosine() const { return static_cast<double>(bits >> 4U) * 0x1p-28; }
};

/// Computes the form factors of rays for one color and calls `tell`(stop, form factor) at every stop; 0 where all
/// light is specular.
void tell_form_factors(std::span<const SpecularStop> stops, const SurfaceOptics& faces,
                       const std::function<void(const SpecularStop& stop, double form_factor)>& tell);

class BrightPatches;
class Occluder;

/// An entry F_ij of a row with its own weight.
struct RayEntry {
  PatchIndex patch = 0;
  float form_factor = 0;
};

/// Sparse rows of form factors: row i is the sum of hit_weight[i] for each occurrence of a patch in its hits, and the
/// form factors of its entries.
struct RayRows {
  std::vector<std::uint64_t> first_hit;  ///< per patch; one more at the end
  LargeArray<PatchIndex> hits;
  std::vector<double> hit_weight;
  std::vector<std::uint64_t> first_entry;  ///< per patch; one more at the end
  LargeArray<RayEntry> entries;
  std::vector<std::uint64_t> first_stop = {};  ///< per patch; one more at the end; empty where nothing is specular
  LargeArray<SpecularStop> stops = {};         ///< of rays on specular paths

  std::span<const RayEntry> entries_of(std::size_t i) const {
    return std::span(entries).subspan(first_entry[i], first_entry[i + 1] - first_entry[i]);
  }
  std::span<const SpecularStop> stops_of(std::size_t i) const {
    return std::span(stops).subspan(first_stop[i], first_stop[i + 1] - first_stop[i]);
  }
  std::uint64_t hit_count(std::size_t i) const { return first_hit[i + 1] - first_hit[i]; }
};

/// Options for tracing rows of rays.
struct RayOptions {
  int rays = 64;                   ///< mean number per patch, see ray_counts()
  std::vector<double> areas = {};  ///< weights of the patches, m^2; empty: their own areas
  int toward_bright = 32;          ///< rays per patch towards bright patches; a multiple of 32
  int lost_share_rays = 256;  ///< rays of patches that see backs, for LostShare; mostly a quarter for small patches
  std::uint64_t seed = 1;
  std::vector<std::uint8_t> doublings = {};  ///< per patch: how many times its hemisphere rays are doubled; empty: 0
};

/// The rows by two independent halves of the rays. Each is unbiased; their mean is the better value and their
/// difference gives its error. With specular stops everything depends on geometry only, and the form factors follow
/// from weighed_rows().
struct TracedRows {
  std::array<RayRows, 2> halves;
  LostShare lost;
  Eigen::VectorXd area;                ///< m^2, the exposed part of each patch
  std::vector<float> distance;         ///< per patch: harmonic mean of the lengths of its rays, meters
  std::vector<std::uint8_t> directed;  ///< per patch: 1 if it was bright, so that rays sampled it directly
  std::uint64_t rays = 0;              ///< over hemispheres
  std::uint64_t shadow_rays = 0;
};

/// Computes rows of form factors F_ij by rays over the cosine-weighted hemisphere of each patch, which start spread
/// over it, and by shadow rays towards bright patches. The balance heuristic combines both (Veach and Guibas 1995):
/// docs/theory/ray-method.md. Each row sums to the visible share of its patch, 1 - escaped - at_backs, up to rounding.
/// Rows may be empty if a patch is covered or sees only sides without patches. If the occluder has specular polygons,
/// rows are not scaled, and `lost` includes only lost rays without specular hits. O(size) time and memory. The same
/// bits for any number of threads, also when `blocks` (null for none) returns blocks of an earlier identical call.
/// \throws Canceled, and the exceptions of the blocks.
TracedRows trace_rows(const PatchMesh& mesh, const Occluder& occluder, const BrightPatches& bright,
                      const RayOptions& options, const Observer& observer = {}, const RowBlocks* blocks = nullptr);

/// Rows of form factors for one color: that of the clear polygons and mirrors of `occluder`, which may differ from the
/// occluder of the rows in colors only. Each row sums to the visible share of its patch in light of this color. Rows
/// without stops stay unchanged. No ray is traced.
TracedRows weighed_rows(TracedRows rows, const PatchMesh& mesh, const Occluder& occluder);

/// Scales each row to the sum given in `wanted`.
void scale(RayRows& rows, const Eigen::VectorXd& wanted);

}  // namespace patchlight
