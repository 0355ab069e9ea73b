#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/scene/scene.h"

#include "scene/coverings.h"
#include "scene/specular_faces.h"
#include "visibility/shaft.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// A shadow ray: the open segment between two points. The two polygons it starts and ends on cannot block it, as a
/// planar polygon never shades itself.
struct Segment {
  Point from;
  Point to;
  PolygonIndex from_polygon = no_polygon;
  PolygonIndex to_polygon = no_polygon;
};

/// Sixteen shadow rays in the occluder's frame (Occluder::frame), in single precision.
struct alignas(64) ShadowPacket {
  static constexpr std::size_t size = 16;
  std::array<float, size> from_x, from_y, from_z;
  std::array<float, size> toward_x, toward_y, toward_z;  ///< from one end to the other
  std::array<PolygonIndex, size> from_polygon, to_polygon;
};

/// Positions as an occluder traces them: scale * (point - centre).
struct TracingFrame {
  Point centre;
  double scale = 1;  ///< 1 / extent of the scene, 1/m
};

/// A ray without end.
struct Ray {
  Point origin;
  Vector direction;                        ///< unit
  PolygonIndex from_polygon = no_polygon;  ///< hits on this polygon are ignored
};

/// Where a ray ends.
struct Hit {
  PolygonIndex polygon = no_polygon;
  Side side = Side::front;  ///< the side of the polygon that was hit
  Point point;
  double distance = 0;                ///< metres from the ray's origin, along its way
  Vector direction = Vector::Zero();  ///< unit, in which the ray arrives
  std::uint32_t reflections = 0;      ///< on the way, as at mirrors
};

/// Decides visibility: every polygon of the scene, unless left out (Blockers), is opaque from both sides, but for clear
/// ones, which let light through as a SpecularFace does. Immutable and safe to use from several threads. Rays are
/// traced in single precision, in a scene recentered and scaled to unit extent; a hit counts only if the plane of the
/// polygon separates the two ends of the ray in double precision, by more than 1e-9 of the extent at each end. So a
/// surface never shades itself or its neighbor at a shared edge, and a wall of no thickness is tight up to 1e-7 of the
/// extent from its foot. Of polygons that lie one on the other in one plane the lower one is out of sight: a shadow ray
/// from or to a place of it is blocked.
class Occluder {
 public:
  /// Which polygons can block a segment.
  enum class Blockers {
    inside_hull,  ///< all but those on the scene's convex hull: enough between points of the scene's surfaces, and
                  ///< faster
    all,          ///< all: for points that may lie outside
    opaque,       ///< all but the clear openings, which count as not there
    clear,        ///< the clear openings alone, as if they were opaque
    none          ///< none: as if nothing stood in the way
  };

  /// A ray that has met so many specular polygons ends on the next one.
  static constexpr std::size_t most_meetings = 64;

  explicit Occluder(const Scene& scene, Blockers blockers = Blockers::inside_hull, Coverings coverings = {},
                    Reflections reflections = Reflections::kept);

  /// Of the same scene as another one, with its faces, coverings and reflections, but with other blockers. Neither of
  /// the two may be `opaque` or `clear`.
  Occluder(const Scene& scene, Blockers blockers, const Occluder& like);
  ~Occluder();
  Occluder(Occluder&&) noexcept;
  Occluder& operator=(Occluder&&) noexcept;

  /// The share of the light along each segment that arrives: 0 where some polygon blocks it, else the product of the
  /// transmittances, at the angle at which each is met, of the clear polygons between its ends. An end on a clear
  /// polygon multiplies it by relative_held() there, so that times held_share() it is what goes from one polygon to the
  /// other, docs/theory/panes-mirrors-sheets.md (15); it may be above 1. Embree works in packets: pass hundreds at
  /// once.
  std::vector<float> transmittance(std::span<const Segment> segments) const;

  /// The same of each ray of a packet. For speed: the ends are given in single precision, so that the rule above holds
  /// with 3e-7 of the extent instead of 1e-9.
  std::array<float, ShadowPacket::size> transmittance(const ShadowPacket& packet) const;

  /// The share of light in a unit direction that a polygon lets straight through; 0 where it is opaque, or Blockers do
  /// not let light through clear polygons.
  double transmittance(PolygonIndex polygon, const Vector& direction) const;

  /// The share of light in a unit direction that a polygon reflects as a mirror does; 0 where it does not, or
  /// reflections are not followed.
  double specular_reflectance(PolygonIndex polygon, const Vector& direction) const;

  /// The polygons that let light through or go on from them as from mirrors.
  const SpecularFaces& specular_faces() const;

  /// The unit direction of a ray after it was reflected at a polygon as at a mirror.
  Vector mirrored(PolygonIndex polygon, const Vector& direction) const;

  /// The share of light from all directions alike that a side of a polygon keeps: 1 but for clear ones and mirrors.
  double held_share(PolygonIndex polygon, Side side) const;

  /// The share of light in a unit direction that a polygon keeps, over held_share(): 1 if it is opaque.
  double relative_held(PolygonIndex polygon, const Vector& direction) const;

  /// The direction, in a frame whose third axis is the polygon's normal, that belongs to (u, v) of the unit square if
  /// directions are distributed as what the polygon keeps of light from all directions alike: if it is opaque,
  /// square_to_cosine_hemisphere().
  Vector held_direction(PolygonIndex polygon, double u, double v) const;

  /// The clear polygons that each ray of a packet crosses between its ends, in their order in the scene; nothing where
  /// an opaque one blocks it.
  std::array<std::optional<std::vector<PolygonIndex>>, ShadowPacket::size> crossings(const ShadowPacket& packet) const;

  /// 1 for each segment along which nothing arrives, else 0.
  std::vector<std::uint8_t> occluded(std::span<const Segment> segments) const;

  /// Bit k is set when some opaque polygon blocks ray k.
  std::uint16_t occluded(const ShadowPacket& packet) const;

  TracingFrame frame() const;

  /// Tells where shadow rays are not needed, as nothing is in the way.
  const ShaftCuller& shafts() const;

  /// True when one polygon hides the convex hulls of two groups of points from each other: it cuts every segment
  /// between them. May be false when they are hidden by several. The polygons tried are those that a ray between the
  /// middles meets first from either end, but for the groups' own, which rounding may have bent.
  bool hides(std::span<const Point> first, std::span<const Point> second, std::span<const PolygonIndex> own = {}) const;

  /// The first polygon that each ray meets, if any; with Blockers::opaque or clear only these are met.
  std::vector<std::optional<Hit>> first_hits(std::span<const Ray> rays) const;

  /// The same, but a ray goes through a clear polygon with the probability of its transmittance at the ray's angle, and
  /// is reflected with that of its reflectance: so in the mean hits count as the polygons hold back light. Rays with
  /// the same key and seed go on alike; without `keys` each has its place as its key.
  std::vector<std::optional<Hit>> first_held_hits(std::span<const Ray> rays, std::uint64_t seed,
                                                  std::span<const std::size_t> keys = {}) const;

  /// True when another polygon lies over this place of a side of a polygon, in one plane with it.
  bool is_covered(PolygonIndex polygon, Side side, const Point& place) const;

  /// True when `upper` lies over some place of this side of `polygon`.
  bool lies_over(PolygonIndex upper, PolygonIndex polygon, Side side) const;

  /// True when another polygon lies over some place of this side.
  bool is_covered_in_part(PolygonIndex polygon, Side side) const;

  /// True when a polygon is clear. Else false when none can stand between two points of the scene's surfaces, because
  /// every polygon lies on the scene's convex hull and none over another: then shadow rays are not needed.
  bool can_occlude() const;

 private:
  struct Tracer;
  std::unique_ptr<Tracer> tracer_;
};

/// Which polygons of a scene lie over which, and an occluder for each set of blockers. The one between patches is built
/// at once, the others when they are first asked for. The scene must outlive the object. Safe to use from several
/// threads.
class Tracing {
 public:
  explicit Tracing(const Scene& scene, Coverings coverings = {},
                   Occluder::Blockers between_patches = Occluder::Blockers::inside_hull,
                   Reflections reflections = Reflections::kept);
  ~Tracing();

  const Coverings& coverings() const { return coverings_; }

  /// Whether light goes on that mirrors and clear faces reflect.
  Reflections reflections() const { return reflections_; }

  /// True when there are mirrors or clear faces.
  bool has_specular_faces() const { return has_specular_faces_; }

  /// For rays between points of patches.
  const Occluder& between_patches() const { return *between_patches_; }

  /// For points that may lie anywhere: every polygon blocks.
  const Occluder& all_faces() const;

  /// Every polygon that lets no light through blocks, and the others count as not there.
  std::shared_ptr<const Occluder> opaque_faces() const;

  /// Every clear polygon blocks, and the others count as not there. Null where there are none.
  std::shared_ptr<const Occluder> clear_faces() const;

 private:
  struct Later;

  const Scene& scene_;
  Coverings coverings_;
  Occluder::Blockers kind_;
  bool has_openings_;
  bool has_specular_faces_;
  Reflections reflections_;
  std::shared_ptr<const Occluder> between_patches_;
  std::unique_ptr<Later> later_;
};

}  // namespace patchlight
