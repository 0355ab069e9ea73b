#include "mesh/cut_polygons.h"

#include "base/parallel.h"
#include "base/tolerances.h"
#include "mesh/noded_lines.h"
#include "scene/extent.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

namespace patchlight {
namespace {

struct Plane {
  Point origin;
  Eigen::Matrix<double, 3, 2> axes;

  FlatPoint flat(const Point& point) const { return axes.transpose() * (point - origin); }
  Point lifted(const FlatPoint& point) const { return origin + axes * point; }
};

Plane plane_along(const Point& origin, const Vector& along, const Vector& normal) {
  Plane plane{origin, {}};
  plane.axes.col(0) = (along - along.dot(normal) * normal).normalized();
  plane.axes.col(1) = normal.cross(plane.axes.col(0));
  return plane;
}

// Where on an edge a point lies, from 0 to 1.
double place_on(const FlatLine& edge, const FlatPoint& point) {
  const auto& [from, to] = edge;
  return (point - from).dot(to - from) / (to - from).squaredNorm();
}

bool is_on(const FlatLine& edge, const FlatPoint& point, double near) { return to_line(point, edge).norm() <= near; }

double length_of(const std::vector<FlatLine>& lines) {
  double length = 0;
  for (const auto& [from, to] : lines) length += (to - from).norm();
  return length;
}

// The outline of one polygon in its plane.
class FlatOutline {
 public:
  FlatOutline(const std::vector<Point>& corners, const Vector& normal, double grid)
      : corners_(corners), plane_(plane_along(corners[0], corners[1] - corners[0], normal)), grid_(grid) {
    std::vector<FlatPoint> flat;
    for (const Point& corner : corners) flat.push_back(plane_.flat(corner));
    edges_ = edges_of(flat);
  }

  std::vector<FlatLine> flat(const std::vector<ContactLine>& lines, double least_gap, double largest_gap) const {
    std::vector<FlatLine> result;
    for (const ContactLine& line : lines) {
      if (line.gap >= least_gap && line.gap <= largest_gap)
        result.push_back({snapped(plane_.flat(line.from)), snapped(plane_.flat(line.to))});
    }
    return result;
  }

  // The parts of the lines that lie inside, cut where they meet, without those that run along an edge in less than this
  // width.
  std::vector<FlatLine> parts_inside(std::vector<FlatLine> lines, double narrow) const {
    lines.insert(lines.end(), edges_.begin(), edges_.end());
    std::vector<FlatLine> parts = noded_lines(lines, grid_);
    std::erase_if(parts, [&](const FlatLine& part) {
      const FlatPoint middle = (part[0] + part[1]) / 2;
      return !marks_at(middle).empty() || runs_along(part, narrow) || !is_inside(middle, edges_);
    });
    return parts;
  }

  // Is the line a part of an edge?
  bool runs_along(const FlatLine& line) const { return runs_along(line, near()); }

  bool runs_along(const FlatLine& line, double width) const {
    return std::any_of(edges_.begin(), edges_.end(), [&](const FlatLine& edge) {
      return is_on(edge, line[0], width) && is_on(edge, line[1], width);
    });
  }

  LineEnd end_at(const FlatPoint& point) const {
    for (std::size_t k = 0; k < edges_.size(); ++k) {
      if ((edges_[k][0] - point).norm() <= near()) return {{}, corners_[k]};
    }
    const std::vector<Mark> marks = marks_at(point);
    if (marks.empty()) return {{}, plane_.lifted(point)};
    return {marks.front(), {}};
  }

  // On every edge that goes through a point: both of a seam.
  std::vector<Mark> marks_at(const FlatPoint& point) const {
    std::vector<Mark> marks;
    for (std::size_t k = 0; k < edges_.size(); ++k) {
      if (!is_on(edges_[k], point, near())) continue;
      const double t = place_on(edges_[k], point);
      const bool is_backward = comes_before(corners_[(k + 1) % corners_.size()], corners_[k]);
      marks.push_back({k, is_backward ? 1 - t : t});
    }
    return marks;
  }

 private:
  double near() const { return 2 * grid_; }

  // A point as near to the outline as faces that touch are lies on it.
  FlatPoint snapped(const FlatPoint& point) const {
    const double touching = 10 * grid_;
    for (const auto& [corner, next] : edges_) {
      if ((corner - point).norm() <= touching) return corner;
    }
    for (const FlatLine& edge : edges_) {
      if (is_on(edge, point, touching)) return edge[0] + place_on(edge, point) * (edge[1] - edge[0]);
    }
    return point;
  }

  const std::vector<Point>& corners_;
  Plane plane_;
  double grid_;
  std::vector<FlatLine> edges_;
};

// The diagonal of all of them together.
double size_of(const std::vector<FlatLine>& lines) {
  Eigen::AlignedBox2d box;
  for (const FlatLine& line : lines) box.extend(line[0]).extend(line[1]);
  return box.isEmpty() ? 0 : box.diagonal().norm();
}

// Contact lines whose gaps are of about one width.
struct GapClass {
  std::vector<FlatLine> lines;
  double widest;  // meters; 0: they touch
};

// The ones whose gap is at most a quarter of the size of the patches, `detail`.
std::vector<GapClass> by_gap(const FlatOutline& outline, const std::vector<ContactLine>& contacts, double detail) {
  std::vector<double> gaps;
  for (const ContactLine& line : contacts) {
    if (line.gap <= 0.25 * detail) gaps.push_back(line.gap);
  }
  std::sort(gaps.begin(), gaps.end(), std::greater());
  std::vector<GapClass> classes;
  for (std::size_t k = 0; k < gaps.size();) {
    const double widest = gaps[k];
    while (k < gaps.size() && (4 * gaps[k] > widest || widest == 0)) ++k;
    classes.push_back({outline.flat(contacts, gaps[k - 1], widest), widest});
  }
  return classes;
}

// True for lines long enough that the light under them matters: the gap's area is 0.75 % of a patch or more.
bool are_long(const std::vector<FlatLine>& lines, double gap, double detail) {
  return length_of(lines) * gap >= 0.0075 * detail * detail;
}

// Light that gets under an edge fades over a few widths of the gap. Lines one and three widths from the edge resolve
// this, if the edge is long and the lines stay within 7.5 % of a patch.
std::vector<FlatLine> lines_beside_gap(const std::vector<FlatLine>& edges, double grid, double gap, double detail) {
  if (!are_long(edges, gap, detail)) return {};
  std::vector<FlatLine> beside;
  for (const double widths : {1.0, 3.0}) {
    if (widths * gap > 0.075 * detail) continue;
    const std::vector<FlatLine> some = lines_beside(edges, grid, widths * gap);
    beside.insert(beside.end(), some.begin(), some.end());
  }
  return beside;
}

// Not those of lines along the outline, unless they are worth lines beside them.
bool matters(const FlatOutline& outline, const GapClass& gap, double detail) {
  return are_long(gap.lines, gap.widest, detail) ||
         !std::all_of(gap.lines.begin(), gap.lines.end(), [&](const auto& line) { return outline.runs_along(line); });
}

CutPolygon cut_polygon(std::vector<Point> corners, const Vector& normal, const std::vector<ContactLine>& contacts,
                       double detail, double grid) {
  CutPolygon cut{std::move(corners), normal, 4 * grid, {}, {}};
  if (contacts.empty()) return cut;
  const FlatOutline outline(cut.corners, normal, grid);
  std::vector<FlatLine> lines;
  for (const GapClass& gap : by_gap(outline, contacts, detail)) {
    const double tolerance = 0.01 * detail;  // lines may move by 1 % of a patch
    // Farther away than four times its size the shadow of a line has no edge.
    const double least_size = std::max(16 * tolerance, 4 * gap.widest);
    if (size_of(gap.lines) < least_size || !matters(outline, gap, detail)) continue;
    const std::vector<FlatLine> edges = simplified_lines(gap.lines, grid, tolerance, least_size);
    const std::vector<FlatLine> beside = lines_beside_gap(edges, grid, gap.widest, detail);
    lines.insert(lines.end(), edges.begin(), edges.end());
    lines.insert(lines.end(), beside.begin(), beside.end());
  }
  if (lines.empty()) return cut;
  // Narrower strips along edges come from rounding.
  for (const FlatLine& part : outline.parts_inside(std::move(lines), 5e-4 * detail)) {
    cut.lines.push_back({outline.end_at(part[0]), outline.end_at(part[1])});
    for (const FlatPoint& end : part) {
      if (!outline.end_at(end).mark) continue;
      for (const Mark& mark : outline.marks_at(end)) cut.marks.push_back(mark);
    }
  }
  return cut;
}

using EdgeKey = std::array<double, 6>;

// The ends of an edge, in the order of comes_before().
EdgeKey key_of(const std::vector<Point>& corners, std::size_t edge) {
  const Point* a = &corners[edge];
  const Point* b = &corners[(edge + 1) % corners.size()];
  if (comes_before(*b, *a)) std::swap(a, b);
  return {a->x(), a->y(), a->z(), b->x(), b->y(), b->z()};
}

struct MarksOfEdge {
  Vector normal;
  double near;
  std::vector<double> places;  // in order
};

// Per edge with marks, those of every polygon that has it, with one in place of several at one place.
using MarksByEdge = std::map<EdgeKey, std::vector<MarksOfEdge>>;

double length_of(const EdgeKey& key) { return Point(key[3] - key[0], key[4] - key[1], key[5] - key[2]).norm(); }

MarksByEdge marks_by_edge(const std::vector<CutPolygon>& polygons) {
  MarksByEdge all;
  for (const CutPolygon& polygon : polygons) {
    for (const Mark& mark : polygon.marks) {
      std::vector<MarksOfEdge>& of_edge = all[key_of(polygon.corners, mark.edge)];
      const auto same = std::find_if(of_edge.begin(), of_edge.end(), [&](const MarksOfEdge& other) {
        return std::abs(other.normal.dot(polygon.normal)) >= smooth_cosine;
      });
      (same == of_edge.end() ? of_edge.emplace_back(MarksOfEdge{polygon.normal, polygon.near, {}}) : *same)
          .places.push_back(mark.t);
    }
  }
  for (auto& [key, of_edge] : all) {
    const double step = of_edge.front().near / length_of(key);
    for (MarksOfEdge& marks : of_edge) {
      std::sort(marks.places.begin(), marks.places.end());
      std::vector<double> apart;
      for (const double t : marks.places) {
        if (apart.empty() || t - apart.back() > step) apart.push_back(t);
      }
      marks.places = std::move(apart);
    }
  }
  return all;
}

// The places on an edge of a polygon where lines of it or of its neighbor end.
std::vector<double> places_on(const MarksByEdge& all, const CutPolygon& polygon, std::size_t edge) {
  const auto found = all.find(key_of(polygon.corners, edge));
  if (found == all.end()) return {};
  for (const MarksOfEdge& marks : found->second) {
    if (std::abs(marks.normal.dot(polygon.normal)) >= smooth_cosine) return marks.places;
  }
  return {};
}

// The same bits from both polygons that have the edge.
Point marked_point(const EdgeKey& key, double t) {
  const Point from(key[0], key[1], key[2]);
  return from + t * (Point(key[3], key[4], key[5]) - from);
}

Outline outline_with_marks(const CutPolygon& polygon, const MarksByEdge& all, double max_edge) {
  if (all.empty() && polygon.lines.empty()) return make_outline(polygon.corners, polygon.normal, max_edge);
  std::vector<Point> corners;
  for (std::size_t k = 0; k < polygon.corners.size(); ++k) {
    corners.push_back(polygon.corners[k]);
    std::vector<double> places = places_on(all, polygon, k);
    const EdgeKey key = places.empty() ? EdgeKey{} : key_of(polygon.corners, k);
    if (comes_before(polygon.corners[(k + 1) % polygon.corners.size()], polygon.corners[k]))
      std::reverse(places.begin(), places.end());
    for (const double t : places) corners.push_back(marked_point(key, t));
  }
  Outline outline = make_outline(std::move(corners), polygon.normal, max_edge);

  const auto point_at = [&](const LineEnd& end) -> Point {
    if (!end.mark) return end.point;
    const std::vector<double> places = places_on(all, polygon, end.mark->edge);
    const double nearest = *std::min_element(places.begin(), places.end(), [&](double a, double b) {
      return std::abs(a - end.mark->t) < std::abs(b - end.mark->t);
    });
    return marked_point(key_of(polygon.corners, end.mark->edge), nearest);
  };
  for (const auto& [from, to] : polygon.lines) outline.lines.push_back({point_at(from), point_at(to)});
  std::erase_if(outline.lines, [](const auto& line) { return line[0] == line[1]; });
  return outline;
}

// Polygons that share an edge share its points: as many parts as the finest of them takes.
std::vector<Outline> with_shared_parts(std::vector<Outline> outlines) {
  std::map<EdgeKey, std::uint32_t> parts;
  for (const Outline& outline : outlines)
    for (std::size_t k = 0; k < outline.corners.size(); ++k) {
      std::uint32_t& finest = parts[key_of(outline.corners, k)];
      finest = std::max(finest, outline.parts[k]);
    }
  for (Outline& outline : outlines)
    for (std::size_t k = 0; k < outline.corners.size(); ++k) outline.parts[k] = parts.at(key_of(outline.corners, k));
  return outlines;
}

}  // namespace

double followed_detail(const ContactLines& contacts, double max_edge) {
  const double detail = std::min(contacts.of_edge * max_edge, contacts.detail);
  return std::ldexp(contacts.size,
                    static_cast<int>(std::floor(std::log2(detail / contacts.size) + tolerance_of_shapes)));
}

std::vector<CutPolygon> cut_polygons(const Scene& scene, const LooseCorners& loose, const ContactLines& contacts,
                                     const PatchEdges& edges) {
  return cut_again({}, scene, loose, contacts, edges, false);
}

std::vector<CutPolygon> cut_again(std::vector<CutPolygon> polygons, const Scene& scene, const LooseCorners& loose,
                                  const ContactLines& contacts, const PatchEdges& edges, bool same_detail) {
  const bool any = !contacts.on.empty();
  const double grid = any ? 2e-7 * extent_of(scene) : 0;  // on which lines meet
  const double detail = any ? followed_detail(contacts, edges.max_edge) : 0;
  static const std::vector<ContactLine> none;
  const bool all = polygons.empty();
  polygons.resize(scene.polygons.size());
  parallel_for(polygons.size(), [&](std::size_t p) {
    const std::vector<ContactLine>& lines = any ? contacts.on[p] : none;
    const bool is_loose = !loose.empty() && !loose[p].empty();
    if (!all && !is_loose && (same_detail || lines.empty())) return;
    const auto polygon = static_cast<PolygonIndex>(p);
    polygons[p] = cut_polygon(coarse_outline(scene, loose, polygon, edges.max_edge), front_normal(scene, polygon),
                              lines, detail, grid);
  });
  return polygons;
}

std::vector<Outline> cut_outlines(const std::vector<CutPolygon>& polygons, const PatchEdges& edges,
                                  std::span<const std::uint8_t> is_needed) {
  const MarksByEdge marks = marks_by_edge(polygons);
  std::vector<Outline> outlines(polygons.size());
  parallel_for(polygons.size(), [&](std::size_t p) {
    if (is_needed[p]) outlines[p] = outline_with_marks(polygons[p], marks, edges.on(p));
  });
  return edges.coarsest.empty() ? outlines : with_shared_parts(std::move(outlines));
}

std::vector<Outline> cut_outlines(const std::vector<CutPolygon>& polygons, const PatchEdges& edges) {
  return cut_outlines(polygons, edges, std::vector<std::uint8_t>(polygons.size(), 1));
}

}  // namespace patchlight
