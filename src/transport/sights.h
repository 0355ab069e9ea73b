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

/// What a ray does where it has met a polygon.
enum class Onward : std::uint8_t { through, mirrored, ends };

/// Where a ray has met a polygon.
struct WayStop {
  Hit hit;
  Onward onward = Onward::ends;
};

/// All polygons that a ray meets, each specular but for the last one; empty where it meets nothing. A ray that does not
/// end at its last stop has left the scene from there. Most have one stop, for which no memory is asked for.
using Way = boost::container::small_vector<WayStop, 1>;

/// What a ray from a patch meets: a side of a polygon that has patches, nothing, a side without patches, or a face that
/// lies against the patch.
enum class Sight { patch, nothing, back, contact };

/// What a ray meets, and where.
struct Seen {
  Sight sight = Sight::nothing;
  std::optional<Hit> hit = {};
};

/// What a ray meets on its way over specular polygons, and what ends it.
struct SeenWay {
  Way way;
  Sight end = Sight::nothing;
};

/// How many rays have met this.
int count(std::span<const Seen> among, Sight sight);

/// How many have met what is no surroundings: sides without patches, or faces that lie against the patch.
int unseen(std::span<const Seen> seen);

/// What rays from patches meet: the one rule by which lost shares and rows of rays are counted.
class Sights {
 public:
  /// Keeps references to both.
  Sights(const PatchMesh& mesh, const Occluder& occluder);

  /// A ray that starts where another polygon lies over the patch is in contact with that. A ray that meets nothing is
  /// traced again from a place 1 % nearer to the patch's centroid and a little behind its plane, so that cracks between
  /// polygons and faces that lie against each other do not count as openings. Clear polygons let a ray through with the
  /// probability of their transmittance, drawn by `seed`.
  std::vector<Seen> of_rays(PatchIndex patch, std::vector<Ray> rays, std::uint32_t seed) const;

  /// The same of specular_ways().
  std::vector<SeenWay> along_ways(PatchIndex patch, std::vector<Ray> rays, std::uint32_t seed) const;

  /// Whether a side that is met has patches.
  bool has_patches(const Hit& hit) const;

  /// Does another face lie against the one that was hit, where it was? Not one that it lies over, as the floor under a
  /// rug.
  bool is_in_contact(const Hit& hit) const;

 private:
  Seen seen_at(const Hit& hit) const;
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
