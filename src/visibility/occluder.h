#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/scene/scene.h"

#include "optics/surface_optics.h"
#include "scene/coverings.h"
#include "visibility/shaft.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// A shadow ray: the open segment between two points. The polygons that it starts and ends on cannot block it, because
/// a planar polygon never shades itself.
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

/// The coordinates in which an occluder traces: `scale * (point - centre)`.
struct TracingFrame {
  Point centre;
  double scale = 1;  ///< 1 / extent of the scene, 1/m
};

/// An endless ray.
struct Ray {
  Point origin;
  Vector direction;                        ///< unit
  PolygonIndex from_polygon = no_polygon;  ///< hits on this polygon are ignored
};

/// The end of a ray.
struct Hit {
  PolygonIndex polygon = no_polygon;
  Side side = Side::front;  ///< the side of the polygon that was hit
  Point point;
  double distance = 0;                ///< meters from the ray's origin, along its path
  Vector direction = Vector::Zero();  ///< unit, direction of the arriving ray
  std::uint32_t reflections = 0;      ///< mirror reflections on the path
};

/// Decides visibility. Every polygon of the scene is opaque from both sides, unless Blockers exclude it; clear polygons
/// transmit light as SpecularSurface describes. Immutable and thread-safe.
///
/// Rays are traced in single precision, in a scene recentered and scaled to unit extent. A hit counts only if the plane
/// of the polygon separates the two ends of the ray in double precision, by more than 1e-9 of the extent at each end.
/// So a surface never shades itself or its neighbor at a shared edge, and a wall without thickness is tight up to 1e-7
/// of the extent from its foot. If two polygons overlap in one plane, the lower one is hidden: a shadow ray from or to
/// a covered place is blocked.
class Occluder {
 public:
  /// The set of polygons that can block a segment.
  enum class Blockers {
    inside_hull,  ///< all polygons except those on the scene's convex hull: sufficient between points of the scene's
                  ///< surfaces, and faster
    all,          ///< all polygons: for points that may lie outside
    opaque,       ///< all polygons except the clear ones, which are ignored
    clear,        ///< only the clear polygons, as if they were opaque
    none          ///< no polygons: everything is visible
  };

  /// The largest number of specular hits on a path: the ray ends on the next specular polygon.
  static constexpr std::size_t most_meetings = 64;

  explicit Occluder(const Scene& scene, Blockers blockers = Blockers::inside_hull, Coverings coverings = {},
                    Reflections reflections = Reflections::kept);

  /// Shares the faces, coverings and reflections of `like`, an occluder of the same scene, but has other blockers.
  /// Neither of the two may be `opaque` or `clear`.
  Occluder(const Scene& scene, Blockers blockers, const Occluder& like);
  ~Occluder();
  Occluder(Occluder&&) noexcept;
  Occluder& operator=(Occluder&&) noexcept;

  /// The transmittance along each segment. It is 0 if a polygon blocks the segment. Else it is the product of the
  /// transmittances of the clear polygons between its ends, at their angles of incidence. An end on a clear polygon
  /// multiplies it by nonspecular_profile() there. Times nonspecular_fraction() it is then the share of light from one
  /// polygon to the other, docs/theory/panes-mirrors-sheets.md (15); it may exceed 1. Embree works in packets: pass
  /// hundreds of segments at once.
  std::vector<float> transmittance(std::span<const Segment> segments) const;

  /// The same for each ray of a packet. For speed the ends are in single precision, so the rule above holds with 3e-7
  /// of the extent instead of 1e-9.
  std::array<float, ShadowPacket::size> transmittance(const ShadowPacket& packet) const;

  /// The polygons at which rays pass through or are mirrored; none if the Blockers leave out a kind of polygon.
  const SurfaceOptics& optics() const;

  /// The clear polygons that each ray of a packet crosses between its ends, in the order of the scene; nothing if an
  /// opaque polygon blocks it.
  std::array<std::optional<std::vector<PolygonIndex>>, ShadowPacket::size> crossings(const ShadowPacket& packet) const;

  /// 1 for each blocked segment, else 0.
  std::vector<std::uint8_t> occluded(std::span<const Segment> segments) const;

  /// Bit k is set when some opaque polygon blocks ray k.
  std::uint16_t occluded(const ShadowPacket& packet) const;

  TracingFrame frame() const;

  /// The test for shafts without obstacles, where no shadow rays are needed.
  const ShaftCuller& shafts() const;

  /// True when one polygon hides the convex hulls of two groups of points from each other: it cuts every segment
  /// between them. May be false if only several polygons together hide them. Candidates are the polygons that a ray
  /// between the centers hits first from either end. The groups' `own` polygons, which rounding may have bent, are
  /// excluded.
  bool hides(std::span<const Point> first, std::span<const Point> second, std::span<const PolygonIndex> own = {}) const;

  /// The first polygon that each ray hits, if any. Blockers::opaque or clear restrict the polygons.
  std::vector<std::optional<Hit>> first_hits(std::span<const Ray> rays) const;

  /// The same, but a ray passes a clear polygon with the probability of its transmittance at the ray's angle, and is
  /// mirrored with that of its reflectance. So on average hits are weighted by the share of light that polygons hold
  /// back. Rays with the same key and seed continue alike; without `keys` the index of each ray is its key.
  std::vector<std::optional<Hit>> sample_nonspecular_hits(std::span<const Ray> rays, std::uint64_t seed,
                                                          std::span<const std::size_t> keys = {}) const;

  /// True when another polygon covers this place of a side of a polygon, in the same plane.
  bool is_covered(PolygonIndex polygon, Side side, const Point& place) const;

  /// True when `upper` covers some place of this side of `polygon`.
  bool lies_over(PolygonIndex upper, PolygonIndex polygon, Side side) const;

  /// True when another polygon covers some place of this side.
  bool is_covered_in_part(PolygonIndex polygon, Side side) const;

  /// False when shadow rays are not needed: no polygon is clear, every polygon lies on the scene's convex hull, and
  /// none lies over another.
  bool can_occlude() const;

 private:
  struct Tracer;
  std::unique_ptr<Tracer> tracer_;
};

/// The coverings of a scene, and an occluder for each set of blockers. The occluder between patches is built at once,
/// the others on first use. The scene must outlive the object. Thread-safe.
class Tracing {
 public:
  explicit Tracing(const Scene& scene, Coverings coverings = {},
                   Occluder::Blockers between_patches = Occluder::Blockers::inside_hull,
                   Reflections reflections = Reflections::kept);
  ~Tracing();

  const Coverings& coverings() const { return coverings_; }

  /// Whether rays follow the light that mirrors and clear faces reflect.
  Reflections reflections() const { return reflections_; }

  /// True when there are mirrors or clear faces.
  bool has_specular_surfaces() const { return has_specular_surfaces_; }

  /// For rays between points of patches.
  const Occluder& between_patches() const { return *between_patches_; }

  /// For points that may lie anywhere: every polygon blocks.
  const Occluder& all_faces() const;

  /// Only opaque polygons block; the others are ignored.
  std::shared_ptr<const Occluder> opaque_faces() const;

  /// Only clear polygons block; the others are ignored. Null if there are none.
  std::shared_ptr<const Occluder> clear_faces() const;

 private:
  struct Later;

  const Scene& scene_;
  Coverings coverings_;
  Occluder::Blockers kind_;
  bool has_openings_;
  bool has_specular_surfaces_;
  Reflections reflections_;
  std::shared_ptr<const Occluder> between_patches_;
  std::unique_ptr<Later> later_;
};

}  // namespace patchlight
