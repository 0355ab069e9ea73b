#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include "visibility/occluder.h"

#include <Eigen/Core>
#include <boost/container/small_vector.hpp>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// A right-handed frame fixed to the patch: along its first edge, across it, and along the normal.
Eigen::Matrix3d patch_frame(const PatchMesh& mesh, PatchIndex patch);

/// How a ray continues after it hits a polygon.
enum class Onward : std::uint8_t { through, mirrored, ends };

/// A hit on a path.
struct WayStop {
  Hit hit;
  Onward onward = Onward::ends;
};

/// All polygons that a ray hits, each specular except the last; empty if it hits nothing. Most rays have one stop, for
/// which no memory is allocated.
using Way = boost::container::small_vector<WayStop, 1>;

/// True when the ray leaves the scene from its last stop.
inline bool has_left(const Way& way) { return way.empty() || way.back().onward != Onward::ends; }

/// The end of a ray from a patch: a side with patches, nothing, a side without patches, or a face in contact with the
/// patch.
enum class Sight { patch, nothing, back, contact };

/// The hits of a ray, and its end.
template <typename Met>
struct SeenBy {
  Met met = {};
  Sight sight = Sight::nothing;
};
using Seen = SeenBy<std::optional<Hit>>;
using SeenWay = SeenBy<Way>;  ///< over specular polygons

/// The number of rays with this end.
int count(std::span<const Seen> among, Sight sight);

/// The number of rays that end at sides without patches or at faces in contact.
int unseen(std::span<const Seen> seen);

/// The common rule that classifies the ends of rays from patches, for lost shares and rows of rays.
class Sights {
 public:
  /// Keeps references to both.
  Sights(const PatchMesh& mesh, const Occluder& occluder);

  /// A ray that starts under another polygon has the end `contact`. A ray that hits nothing is traced again from a
  /// place 1 % nearer to the patch's centroid and slightly behind its plane. So cracks between polygons, and faces in
  /// contact, do not count as openings. Clear polygons pass a ray with the probability of their transmittance, drawn by
  /// `seed`.
  std::vector<Seen> of_rays(PatchIndex patch, std::vector<Ray> rays, std::uint32_t seed) const;

  /// The same by geometry only: every ray continues from clear polygons and mirrors, whatever their colors. At a clear
  /// polygon it is mirrored as SpecularSurface::mirrored_rays() decides, else it passes straight through.
  std::vector<SeenWay> along_ways(PatchIndex patch, std::vector<Ray> rays, std::uint32_t seed) const;

  /// Whether the side that was hit has patches.
  bool has_patches(const Hit& hit) const;

  /// Whether another face lies against the face that was hit, at the hit point. Excludes a face under it, e.g. the
  /// floor under a rug.
  bool is_in_contact(const Hit& hit) const;

 private:
  Sight sight_at(const Hit& hit) const { return has_patches(hit) ? Sight::patch : Sight::back; }
  // `trace` returns the hits of rays, with their keys.
  template <typename Met, typename Trace>
  std::vector<SeenBy<Met>> seen_by(PatchIndex patch, std::vector<Ray> rays, const Trace& trace) const;
  std::vector<std::uint8_t> covered_starts(PatchIndex patch, std::vector<Ray>& rays) const;
  Ray moved(PatchIndex patch, Ray ray) const;
  // Whether a face that the second attempt hit, at this height above its start, lies behind the patch or under it in
  // its plane.
  bool lies_behind(PatchIndex patch, double height, const Hit& hit) const;
  // Sight::nothing if the face that was hit lies behind the patch.
  Sight sight_of_second_try(PatchIndex patch, const Ray& ray, const Hit& hit) const;

  const PatchMesh& mesh_;
  const Occluder& occluder_;
  double behind_;  // meters
};

}  // namespace patchlight
