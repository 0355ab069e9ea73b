#include "input/building/cut_openings.h"

#include "base/tolerances.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <geos_c.h>
#include <iterator>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

namespace patchlight {
namespace {

using FlatPoint = Eigen::Vector2d;
using FlatRing = std::vector<FlatPoint>;

// The plane of an outline, with one axis along the longest edge.
struct Plane {
  Point origin;
  Vector x, y;
  double grid = 0;  // meters; the overlay rounds coordinates to multiples of it

  FlatPoint flat(const Point& point) const { return {x.dot(point - origin), y.dot(point - origin)}; }
  Point lifted(const FlatPoint& point) const { return origin + point.x() * x + point.y() * y; }
  FlatRing flat(const std::vector<Point>& ring) const {
    FlatRing result;
    for (const Point& point : ring) result.push_back(flat(point));
    return result;
  }
};

Plane plane_of(const std::vector<Point>& outline) {
  Box box;
  Vector longest = Vector::Zero();
  for (std::size_t k = 0; k < outline.size(); ++k) {
    box.extend(outline[k]);
    const Vector edge = outline[(k + 1) % outline.size()] - outline[k];
    if (edge.norm() > longest.norm()) longest = edge;
  }
  const Vector normal = area_vector(outline).normalized();
  const Vector x = (longest - normal.dot(longest) * normal).normalized();
  return {outline[0], x, normal.cross(x), tolerance_of_shapes * box.diagonal().norm()};
}

double twice_the_area(const FlatRing& ring) {
  double sum = 0;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const FlatPoint a = ring[k] - ring[0];
    const FlatPoint b = ring[(k + 1) % ring.size()] - ring[0];
    sum += a.x() * b.y() - a.y() * b.x();
  }
  return sum;
}

FlatPoint nearest_on_edge(const FlatPoint& point, const FlatPoint& a, const FlatPoint& b) {
  const double length = (b - a).squaredNorm();
  if (!(length > 0)) return a;
  return a + std::clamp((b - a).dot(point - a) / length, 0.0, 1.0) * (b - a);
}

FlatPoint nearest_on(const FlatRing& outline, const FlatPoint& point) {
  FlatPoint nearest = outline[0];
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const FlatPoint other = nearest_on_edge(point, outline[k], outline[(k + 1) % outline.size()]);
    if ((other - point).squaredNorm() < (nearest - point).squaredNorm()) nearest = other;
  }
  return nearest;
}

// A ray along x from an inside point crosses the edges an odd number of times.
bool is_inside(const FlatRing& outline, const FlatPoint& point) {
  bool is_odd = false;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const FlatPoint a = outline[k] - point;
    const FlatPoint b = outline[(k + 1) % outline.size()] - point;
    if ((a.y() > 0) == (b.y() > 0)) continue;
    if (a.x() + a.y() / (a.y() - b.y()) * (b.x() - a.x()) > 0) is_odd = !is_odd;
  }
  return is_odd;
}

struct Geos {
  GEOSContextHandle_t context = GEOS_init_r();  // one per thread
  Geos() = default;
  ~Geos() { GEOS_finish_r(context); }
  Geos(const Geos&) = delete;
  Geos& operator=(const Geos&) = delete;
};

struct DestroyShape {
  GEOSContextHandle_t context = nullptr;
  void operator()(GEOSGeometry* shape) const { GEOSGeom_destroy_r(context, shape); }
};
using Shape = std::unique_ptr<GEOSGeometry, DestroyShape>;  // null where GEOS fails

// Boolean operations on flat shapes by GEOS. A null argument gives a null result.
class ShapeCutter {
 public:
  explicit ShapeCutter(double grid) : grid_(grid) {}

  // The area inside a ring, even if the ring crosses or touches itself.
  Shape inside(const FlatRing& ring) const {
    std::vector<double> values;
    for (std::size_t k = 0; k <= ring.size(); ++k)
      for (const double value : ring[k % ring.size()]) values.push_back(value);
    GEOSCoordSequence* corners =
        GEOSCoordSeq_copyFromBuffer_r(geos_.context, values.data(), static_cast<unsigned>(ring.size() + 1), 0, 0);
    GEOSGeometry* closed = corners == nullptr ? nullptr : GEOSGeom_createLinearRing_r(geos_.context, corners);
    const Shape polygon =
        owned(closed == nullptr ? nullptr : GEOSGeom_createPolygon_r(geos_.context, closed, nullptr, 0));
    if (!polygon) return owned(nullptr);
    return owned(GEOSMakeValid_r(geos_.context, polygon.get()));
  }

  Shape all_of(std::vector<Shape> shapes) const {
    std::vector<GEOSGeometry*> parts;
    for (Shape& shape : shapes)
      if (shape) parts.push_back(shape.release());
    const Shape collection = owned(GEOSGeom_createCollection_r(geos_.context, GEOS_GEOMETRYCOLLECTION, parts.data(),
                                                               static_cast<unsigned>(parts.size())));
    return owned(collection ? GEOSUnaryUnion_r(geos_.context, collection.get()) : nullptr);
  }

  Shape difference(const Shape& a, const Shape& b) const {
    return owned(a && b ? GEOSDifferencePrec_r(geos_.context, a.get(), b.get(), grid_) : nullptr);
  }

  Shape within(const GEOSGeometry* shape, const Eigen::AlignedBox2d& box) const {
    const Shape frame =
        inside({box.corner(Eigen::AlignedBox2d::BottomLeft), box.corner(Eigen::AlignedBox2d::BottomRight),
                box.corner(Eigen::AlignedBox2d::TopRight), box.corner(Eigen::AlignedBox2d::TopLeft)});
    return owned(frame ? GEOSIntersection_r(geos_.context, shape, frame.get()) : nullptr);
  }

  std::vector<const GEOSGeometry*> polygons_of(const GEOSGeometry* shape) const {
    if (GEOSGeomTypeId_r(geos_.context, shape) == GEOS_POLYGON) {
      if (GEOSisEmpty_r(geos_.context, shape) != 0) return {};
      return {shape};
    }
    std::vector<const GEOSGeometry*> all;
    if (GEOSGeomTypeId_r(geos_.context, shape) < GEOS_MULTIPOINT) return all;
    for (int k = 0; k < GEOSGetNumGeometries_r(geos_.context, shape); ++k) {
      for (const GEOSGeometry* part : polygons_of(GEOSGetGeometryN_r(geos_.context, shape, k))) all.push_back(part);
    }
    return all;
  }

  // The outline, then the holes; the last corner is not repeated.
  std::vector<FlatRing> rings_of(const GEOSGeometry* polygon) const {
    std::vector<FlatRing> rings = {corners_of(GEOSGetExteriorRing_r(geos_.context, polygon))};
    for (int k = 0; k < GEOSGetNumInteriorRings_r(geos_.context, polygon); ++k)
      rings.push_back(corners_of(GEOSGetInteriorRingN_r(geos_.context, polygon, k)));
    return rings;
  }

  double grid() const { return grid_; }

 private:
  Shape owned(GEOSGeometry* shape) const { return {shape, {geos_.context}}; }

  FlatRing corners_of(const GEOSGeometry* ring) const {
    const GEOSCoordSequence* sequence = GEOSGeom_getCoordSeq_r(geos_.context, ring);
    unsigned count = 0;
    if (sequence == nullptr || GEOSCoordSeq_getSize_r(geos_.context, sequence, &count) == 0 || count == 0) return {};
    std::vector<double> values(std::size_t{2} * count);
    if (GEOSCoordSeq_copyToBuffer_r(geos_.context, sequence, values.data(), 0, 0) == 0) return {};
    FlatRing corners;
    for (std::size_t k = 0; k + 1 < count; ++k) corners.emplace_back(values[2 * k], values[2 * k + 1]);
    return corners;
  }

  Geos geos_;
  double grid_;
};

// An axis-parallel line, and the number of holes that it opens.
struct CutLine {
  Eigen::Index axis = 0;
  double at = 0;
  std::size_t opened = 0;
};

Eigen::AlignedBox2d box_of(const FlatRing& ring) {
  Eigen::AlignedBox2d box;
  for (const FlatPoint& point : ring) box.extend(point);
  return box;
}

// Position of the cut: along an edge of the hole if one is perpendicular to the axis, which adds no corner, else
// through the middle.
double place_of_cut(const FlatRing& hole, Eigen::Index axis, double grid) {
  for (std::size_t k = 0; k < hole.size(); ++k) {
    const FlatPoint& a = hole[k];
    const FlatPoint& b = hole[(k + 1) % hole.size()];
    if (a[axis] == b[axis] && std::abs(a[1 - axis] - b[1 - axis]) > grid) return a[axis];
  }
  return box_of(hole).center()[axis];
}

// For each axis, a line through the hole nearest to the middle; returns the line that opens more holes.
CutLine best_cut(const std::vector<FlatRing>& rings, double grid, bool through_middle) {
  const FlatPoint middle = box_of(rings[0]).center();
  std::vector<Eigen::AlignedBox2d> boxes;
  for (std::size_t k = 1; k < rings.size(); ++k) boxes.push_back(box_of(rings[k]));
  CutLine best;
  for (const Eigen::Index axis : {0, 1}) {
    const auto hole = std::min_element(boxes.begin(), boxes.end(), [&](const auto& a, const auto& b) {
      return std::abs(a.center()[axis] - middle[axis]) < std::abs(b.center()[axis] - middle[axis]);
    });
    const FlatRing& ring = rings[1 + static_cast<std::size_t>(hole - boxes.begin())];
    CutLine line{axis, through_middle ? hole->center()[axis] : place_of_cut(ring, axis, grid), 0};
    line.opened = static_cast<std::size_t>(std::count_if(boxes.begin(), boxes.end(), [&](const auto& box) {
      return box.min()[axis] <= line.at && line.at <= box.max()[axis];
    }));
    if (line.opened > best.opened) best = line;
  }
  return best;
}

std::array<Eigen::AlignedBox2d, 2> halves_of(const Eigen::AlignedBox2d& box, const CutLine& line) {
  std::array<Eigen::AlignedBox2d, 2> halves = {box, box};
  halves[0].max()[line.axis] = line.at;
  halves[1].min()[line.axis] = line.at;
  return halves;
}

std::size_t holes_in(const ShapeCutter& cutter, const std::vector<Shape>& shapes) {
  std::size_t holes = 0;
  for (const Shape& shape : shapes) {
    for (const GEOSGeometry* polygon : cutter.polygons_of(shape.get())) holes += cutter.rings_of(polygon).size() - 1;
  }
  return holes;
}

// The parts of a polygon on both sides of a line; empty where GEOS fails.
std::vector<Shape> sides_of(const ShapeCutter& cutter, const GEOSGeometry* polygon, Eigen::AlignedBox2d box,
                            const CutLine& line) {
  const FlatPoint margin = FlatPoint::Constant(0.1 * box.diagonal().norm());
  box = Eigen::AlignedBox2d(box.min() - margin, box.max() + margin);
  std::vector<Shape> sides;
  for (const Eigen::AlignedBox2d& half : halves_of(box, line)) sides.push_back(cutter.within(polygon, half));
  return sides[0] && sides[1] ? std::move(sides) : std::vector<Shape>{};
}

std::vector<Shape> cut_through_holes(const ShapeCutter& cutter, const GEOSGeometry* polygon,
                                     const std::vector<FlatRing>& rings) {
  for (const bool through_middle : {false, true}) {
    std::vector<Shape> sides =
        sides_of(cutter, polygon, box_of(rings[0]), best_cut(rings, cutter.grid(), through_middle));
    if (!sides.empty() && holes_in(cutter, sides) + 1 < rings.size()) return sides;
  }
  return {};
}

// Outlines of polygons without holes that partition the shape; empty where GEOS fails.
std::optional<std::vector<FlatRing>> simple_parts(const ShapeCutter& cutter, Shape shape) {
  std::vector<FlatRing> parts;
  std::vector<Shape> left;
  left.push_back(std::move(shape));
  while (!left.empty()) {
    const Shape next = std::move(left.back());
    left.pop_back();
    if (!next) return std::nullopt;
    for (const GEOSGeometry* polygon : cutter.polygons_of(next.get())) {
      std::vector<FlatRing> rings = cutter.rings_of(polygon);
      if (rings.size() == 1) {
        parts.push_back(std::move(rings[0]));
        continue;
      }
      std::vector<Shape> sides = cut_through_holes(cutter, polygon, rings);
      if (sides.empty()) return std::nullopt;
      std::move(sides.begin(), sides.end(), std::back_inserter(left));
    }
  }
  return parts;
}

// Openings of an outline, with their bounding boxes.
struct Holes {
  std::vector<FlatRing> rings;
  std::vector<Eigen::AlignedBox2d> boxes;
};

// The holes in a part of the outline.
struct HolesInPart {
  Shape part;
  Eigen::AlignedBox2d box;
  std::vector<std::size_t> holes;
};

// The line at the median of the hole centers, across the longer side of their bounding box.
CutLine median_line(const Holes& holes, const HolesInPart& of) {
  Eigen::AlignedBox2d around;
  for (const std::size_t hole : of.holes) around.extend(holes.boxes[hole].center());
  CutLine line;
  around.sizes().maxCoeff(&line.axis);
  std::vector<double> centers;
  for (const std::size_t hole : of.holes) centers.push_back(holes.boxes[hole].center()[line.axis]);
  const auto middle = centers.begin() + static_cast<std::ptrdiff_t>(centers.size() / 2);
  std::nth_element(centers.begin(), middle, centers.end());
  line.at = *middle;
  return line;
}

// Both sides of the line with their holes; empty where GEOS fails, or where a side keeps almost all holes.
std::vector<HolesInPart> halved(const ShapeCutter& cutter, const Holes& holes, const HolesInPart& whole) {
  const CutLine line = median_line(holes, whole);
  std::vector<HolesInPart> sides;
  for (const Eigen::AlignedBox2d& box : halves_of(whole.box, line)) {
    HolesInPart side{cutter.within(whole.part.get(), box), box, {}};
    if (!side.part) return {};
    for (const std::size_t hole : whole.holes) {
      const bool reaches = holes.boxes[hole].min()[line.axis] < box.max()[line.axis] &&
                           holes.boxes[hole].max()[line.axis] > box.min()[line.axis];
      if (reaches) side.holes.push_back(hole);
    }
    if (side.holes.size() > whole.holes.size() * 3 / 4) return {};
    sides.push_back(std::move(side));
  }
  return sides;
}

// Outlines of polygons without holes that partition the outline minus the openings; empty where GEOS fails. The outline
// is halved until each part has at most 64 holes: GEOS needs more than linear time, and later steps are quadratic in
// the corners of a polygon.
std::optional<std::vector<FlatRing>> parts_without(const ShapeCutter& cutter, const FlatRing& outline,
                                                   const Holes& holes) {
  Eigen::AlignedBox2d box = box_of(outline);
  const FlatPoint margin = FlatPoint::Constant(0.1 * box.diagonal().norm());
  std::vector<HolesInPart> left;
  left.push_back({cutter.inside(outline), {box.min() - margin, box.max() + margin}, {}});
  for (std::size_t hole = 0; hole < holes.rings.size(); ++hole) left[0].holes.push_back(hole);
  std::vector<FlatRing> parts;
  while (!left.empty()) {
    HolesInPart next = std::move(left.back());
    left.pop_back();
    std::vector<HolesInPart> sides;
    if (next.part && next.holes.size() > 64) sides = halved(cutter, holes, next);
    if (!sides.empty()) {
      std::move(sides.begin(), sides.end(), std::back_inserter(left));
      continue;
    }
    std::vector<Shape> inside;
    for (const std::size_t hole : next.holes) inside.push_back(cutter.inside(holes.rings[hole]));
    std::optional<std::vector<FlatRing>> found =
        simple_parts(cutter, cutter.difference(next.part, cutter.all_of(std::move(inside))));
    if (!found) return std::nullopt;
    std::move(found->begin(), found->end(), std::back_inserter(parts));
  }
  return parts;
}

// Maps flat corners to their positions in the model.
class Corners {
 public:
  explicit Corners(const Plane& plane) : plane_(plane) {}

  // If several corners coincide, the first one is used.
  void add(const FlatPoint& flat, const Point& point) { places_.emplace(step_of(flat), point); }

  std::vector<Point> lifted(const FlatRing& ring) const {
    std::vector<Point> points;
    for (const FlatPoint& corner : ring) {
      const auto found = places_.find(step_of(corner));
      points.push_back(found == places_.end() ? plane_.lifted(corner) : found->second);
    }
    return points;
  }

 private:
  using Step = std::array<std::int64_t, 2>;
  Step step_of(const FlatPoint& point) const {
    return {std::llround(point.x() / plane_.grid), std::llround(point.y() / plane_.grid)};
  }

  Plane plane_;
  std::map<Step, Point> places_;
};

// An opening with corners near the outline snapped to it.
struct SnappedOpening {
  FlatRing ring;
  bool is_beyond = false;
};

SnappedOpening snapped(FlatRing ring, const FlatRing& outline, double tolerance) {
  SnappedOpening result{std::move(ring), false};
  for (FlatPoint& corner : result.ring) {
    const FlatPoint nearest = nearest_on(outline, corner);
    if ((nearest - corner).norm() <= tolerance) {
      corner = nearest;
    } else if (!is_inside(outline, corner)) {
      result.is_beyond = true;
    }
  }
  return result;
}

std::vector<std::vector<Point>> lifted_parts(const std::vector<FlatRing>& parts, const Corners& corners, double grid) {
  std::vector<std::vector<Point>> lifted;
  for (const FlatRing& part : parts) {
    const double area = twice_the_area(part);
    if (!(std::abs(area) > 10 * grid * box_of(part).diagonal().norm())) continue;
    lifted.push_back(corners.lifted(part));
    if (area < 0) std::reverse(lifted.back().begin(), lifted.back().end());
  }
  return lifted;
}

}  // namespace

CutOutline without_openings(const std::vector<Point>& outline, const std::vector<std::vector<Point>>& openings,
                            double tolerance) {
  if (openings.empty() || !(area_vector(outline).norm() > 0)) return {{outline}, 0, true};

  // 1. All rings in the plane.
  const Plane plane = plane_of(outline);
  const FlatRing flat_outline = plane.flat(outline);
  Corners corners(plane);
  for (std::size_t k = 0; k < outline.size(); ++k) corners.add(flat_outline[k], outline[k]);
  const ShapeCutter cutter(plane.grid);
  CutOutline cut;
  Holes holes;
  for (const std::vector<Point>& opening : openings) {
    if (opening.size() < 3) continue;
    SnappedOpening hole = snapped(plane.flat(opening), flat_outline, tolerance);
    for (std::size_t k = 0; k < opening.size(); ++k) {
      const Point at = plane.lifted(hole.ring[k]);
      corners.add(hole.ring[k], (at - opening[k]).norm() <= plane.grid ? opening[k] : at);
    }
    cut.beyond += hole.is_beyond ? 1 : 0;
    holes.boxes.push_back(box_of(hole.ring));
    holes.rings.push_back(std::move(hole.ring));
  }

  // 2. The outline without them, in parts without holes.
  const auto parts = parts_without(cutter, flat_outline, holes);
  if (!parts) return {{outline}, 0, false};
  cut.parts = lifted_parts(*parts, corners, plane.grid);
  return cut;
}

Scene with_parts(Scene scene, Polygon polygon, const std::vector<std::vector<Point>>& parts) {
  for (const std::vector<Point>& part : parts) {
    polygon.corners.resize(part.size());
    std::iota(polygon.corners.begin(), polygon.corners.end(), static_cast<std::uint32_t>(scene.vertices.size()));
    scene.vertices.insert(scene.vertices.end(), part.begin(), part.end());
    scene.polygons.push_back(polygon);
  }
  return scene;
}

}  // namespace patchlight
