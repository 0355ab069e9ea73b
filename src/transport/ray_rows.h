#pragma once

#include "patchlight/base/large_array.h"
#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/transport/lost_share.h"

#include "scene/specular_faces.h"

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// Where blocks of rows are kept while they are traced, so that a run that was stopped goes on where it was: one block
/// for every `patches_of_a_block` patches, the last of them shorter. Only trace_rows() knows the content of a block.
/// keep() is called from several threads, for different blocks.
struct RowBlocks {
  static constexpr PatchIndex patches_of_a_block = 4096;

  std::function<std::optional<std::vector<std::int32_t>>(std::size_t block)> read;  ///< nothing: not kept
  std::function<void(std::size_t block, std::span<const std::int32_t> words)> keep;
};

/// How a ray of a row goes on at a stop.
enum class RayStep : std::uint8_t {
  sent,      ///< it starts from a clear polygon
  crossed,   ///< a shadow ray goes straight through a clear polygon
  through,   ///< a ray over the hemisphere goes straight through, drawn by SpecularFace::mirrored_rays()
  mirrored,  ///< or on as from a mirror
  kept,      ///< it ends on a polygon that is specular, with the share that this holds
  ends       ///< it ends, with all that is left
};
inline constexpr std::uint32_t ray_steps = 6;

/// A stop of a ray that is specular on its way, so that it has another form factor for each color of the
/// clear polygons and mirrors on it: geometry alone, 16 bytes. The ray is all stops up to one with `kept` or `ends`.
struct SpecularStop {
  static constexpr PatchIndex in_the_open = no_patch;  ///< a ray has left the scene
  static constexpr PatchIndex at_back =
      no_patch - 1;  ///< it meets a side without patches, or a face that lies on the patch

  PatchIndex patch = in_the_open;     ///< that is met
  float form_factor = 0;              ///< of the ray there, if nothing was lost on its way and all is held
  PolygonIndex polygon = no_polygon;  ///< the specular polygon that is met, or from which the ray starts
  std::uint32_t bits = 0;             ///< step, side and cosine of the angle there

  void set(RayStep step, Side side, double cosine);
  RayStep step() const { return static_cast<RayStep>(bits & 7U); }
  Side side() const { return static_cast<Side>(bits >> 3U & 1U); }
  double cosine() const { return static_cast<double>(bits >> 4U) * 0x1p-28; }
};

/// The form factors of rays for one color, ray by ray: tell(stop, form factor) at every stop, 0 where nothing is held.
void tell_form_factors(std::span<const SpecularStop> stops, const SpecularFaces& faces,
                       const std::function<void(const SpecularStop& stop, double form_factor)>& tell);

class BrightPatches;
class Occluder;

/// An entry F_ij of a row with a weight of its own.
struct RayEntry {
  PatchIndex patch = 0;
  float form_factor = 0;
};

/// Sparse rows of form factors: row i is hit_weight[i] for each time that a patch stands in its hits, and the form
/// factors of its entries.
struct RayRows {
  std::vector<std::uint64_t> first_hit;  ///< per patch; one more at the end
  LargeArray<PatchIndex> hits;
  std::vector<double> hit_weight;
  std::vector<std::uint64_t> first_entry;  ///< per patch; one more at the end
  LargeArray<RayEntry> entries;
  std::vector<std::uint64_t> first_stop = {};  ///< per patch; one more at the end; empty where nothing is specular
  LargeArray<SpecularStop> stops = {};         ///< of rays that are specular on their way

  std::span<const RayEntry> entries_of(std::size_t i) const {
    return std::span(entries).subspan(first_entry[i], first_entry[i + 1] - first_entry[i]);
  }
  std::span<const SpecularStop> stops_of(std::size_t i) const {
    return std::span(stops).subspan(first_stop[i], first_stop[i + 1] - first_stop[i]);
  }
  std::uint64_t hit_count(std::size_t i) const { return first_hit[i + 1] - first_hit[i]; }
};

/// How rows of rays are found.
struct RayOptions {
  int rays = 64;                   ///< mean number of a patch, see ray_counts()
  std::vector<double> areas = {};  ///< in proportion to which patches matter, m^2; empty: their own
  int toward_bright = 32;          ///< and towards bright patches; a multiple of 32
  int lost_share_rays = 256;       ///< of patches from which backs are seen, LostShare; of small ones mostly a quarter
  std::uint64_t seed = 1;
  std::vector<std::uint8_t> doublings = {};  ///< per patch: how often its rays over the hemisphere are doubled; empty:
                                             ///< never
};

/// The rows by two independent halves of the rays: each is unbiased, their mean is the better value, their difference
/// its error. Where there are stops of specular rays all is of the geometry alone, and no form factors yet: see
/// weighed_rows().
struct TracedRows {
  std::array<RayRows, 2> halves;
  LostShare lost;
  Eigen::VectorXd area;         ///< m^2, the exposed part of each patch
  std::vector<float> distance;  ///< per patch: harmonic mean of the lengths of its rays, metres
  std::vector<std::uint8_t>
      directed;            ///< per patch: 1 when it was bright, so that rays were sent towards it on purpose
  std::uint64_t rays = 0;  ///< over hemispheres
  std::uint64_t shadow_rays = 0;
};

/// Rows of form factors F_ij by rays over the cosine-weighted hemisphere of each patch, that start spread over it, and
/// shadow rays towards bright patches, both by the balance heuristic (Veach and Guibas 1995):
/// docs/theory/ray-method.md. Each row sums up to what its patch sees, 1 - escaped - at_backs, to rounding; where a
/// patch sees nothing but sides without patches, or all of it is covered, its rows may be empty. Where the occluder has
/// specular polygons rows are not scaled, and `lost` has of rays that are lost only those that met none of them.
/// O(size) time and memory. The same bits for any number of threads, and when some of the blocks, null for none, were
/// kept by an earlier call for the same. \throws Cancelled, and what the blocks throw.
TracedRows trace_rows(const PatchMesh& mesh, const Occluder& occluder, const BrightPatches& bright,
                      const RayOptions& options, const Observer& observer = {}, const RowBlocks* blocks = nullptr);

/// Rows of form factors for one colour: that of the clear polygons and mirrors of an occluder, which is as that by
/// which the rows were traced but for the colours. Each row sums up to the share that its patch sees by light of this
/// color. Rows without stops stay as they are. No ray is traced.
TracedRows weighed_rows(TracedRows rows, const PatchMesh& mesh, const Occluder& occluder);

/// Multiplies each row by the factor that makes its sum that of `wanted`.
void scale(RayRows& rows, const Eigen::VectorXd& wanted);

}  // namespace patchlight
