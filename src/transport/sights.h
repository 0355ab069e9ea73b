#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include "visibility/occluder.h"

#include <Eigen/Core>
#include <boost/container/small_vector.hpp>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// A right-handed frame that turns with the patch: along its first edge, across it, and along the normal.
Eigen::Matrix3d patch_frame(const PatchMesh& mesh, PatchIndex patch);

/// How a ray goes on where it has met a polygon.
enum class Onward : std::uint8_t { through, mirrored, ends };

/// Where a ray has met a polygon.
struct WayStop {
  Hit hit;
  Onward onward = Onward::ends;
};

/// All polygons that a ray meets, each specular but for the last one; empty where it meets nothing. Most rays have one
/// stop, for which no memory is allocated.
using Way = boost::container::small_vector<WayStop, 1>;

/// True when the ray does not end at its last stop: it has left the scene from there.
inline bool has_left(const Way& way) { return way.empty() || way.back().onward != Onward::ends; }

/// The end of a ray from a patch: a side of a polygon that has patches, nothing, a side without patches, or a face that
/// lies against the patch.
enum class Sight { patch, nothing, back, contact };

/// The places that a ray meets, and its end.
template <typename Met>
struct SeenBy {
  Met met = {};
  Sight sight = Sight::nothing;
};
using Seen = SeenBy<std::optional<Hit>>;
using SeenWay = SeenBy<Way>;  ///< over specular polygons

/// How many rays have this end.
int count(std::span<const Seen> among, Sight sight);

/// How many have met no surroundings: sides without patches, or faces that lie against the patch.
int unseen(std::span<const Seen> seen);

/// The rule by which all lost shares and rows of rays classify the ends of rays from patches.
class Sights {
 public:
  /// Keeps references to both.
  Sights(const PatchMesh& mesh, const Occluder& occluder);

  /// A ray that starts where another polygon lies over the patch is in contact with that. A ray that meets nothing is
  /// traced again from a place 1 % nearer to the patch's centroid and a little behind its plane, so that cracks between
  /// polygons and faces that lie against each other do not count as openings. Clear polygons let a ray through with the
  /// probability of their transmittance, drawn by `seed`.
  std::vector<Seen> of_rays(PatchIndex patch, std::vector<Ray> rays, std::uint32_t seed) const;

  /// The same by geometry alone: from clear polygons and mirrors every ray goes on, whatever their colors, at a clear
  /// one with SpecularFace::mirrored_rays() as from a mirror, else straight.
  std::vector<SeenWay> along_ways(PatchIndex patch, std::vector<Ray> rays, std::uint32_t seed) const;

  /// Whether a side that is met has patches.
  bool has_patches(const Hit& hit) const;

  /// Does another face lie against the one that was hit, where it was? Not one that it lies over, as the floor under a
  /// rug.
  bool is_in_contact(const Hit& hit) const;

 private:
  Sight sight_at(const Hit& hit) const { return has_patches(hit) ? Sight::patch : Sight::back; }
  // `trace` gives the places that rays meet, with their keys.
  template <typename Met, typename Trace>
  std::vector<SeenBy<Met>> seen_by(PatchIndex patch, std::vector<Ray> rays, const Trace& trace) const;
  std::vector<std::uint8_t> covered_starts(PatchIndex patch, std::vector<Ray>& rays) const;
  Ray moved(PatchIndex patch, Ray ray) const;
  // Whether a face that a second try met at this height over its start lies behind the patch, or under it in its plane.
  bool lies_behind(PatchIndex patch, double height, const Hit& hit) const;
  // Nothing when the face that was met lies behind the patch.
  Sight sight_of_second_try(PatchIndex patch, const Ray& ray, const Hit& hit) const;

  const PatchMesh& mesh_;
  const Occluder& occluder_;
  double behind_;  // metres
};

}  // namespace patchlight
