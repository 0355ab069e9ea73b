#include "mesh/graded_edges.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace patchlight {
namespace {

// An edge of an outline, by whose ends its neighbours are found.
struct PlacedEdge {
  Point first, last;  // its ends, that which comes first first
  std::uint32_t polygon;
  std::uint32_t edge;
  bool forward;  // the outline goes from the first to the last
};

bool have_same_ends(const PlacedEdge& a, const PlacedEdge& b) { return a.first == b.first && a.last == b.last; }

std::vector<PlacedEdge> placed_edges(std::span<const Outline> outlines) {
  std::vector<PlacedEdge> edges;
  for (std::uint32_t p = 0; p < outlines.size(); ++p) {
    const std::vector<Point>& corners = outlines[p].corners;
    for (std::uint32_t k = 0; k < corners.size(); ++k) {
      const Point& from = corners[k];
      const Point& to = corners[(k + 1) % corners.size()];
      const bool forward = comes_before(from, to);
      edges.push_back({forward ? from : to, forward ? to : from, p, k, forward});
    }
  }
  std::stable_sort(edges.begin(), edges.end(), [](const PlacedEdge& a, const PlacedEdge& b) {
    return a.first == b.first ? comes_before(a.last, b.last) : comes_before(a.first, b.first);
  });
  return edges;
}

// Calls back with every edge and every one of another polygon that has the same ends.
void for_each_shared(std::span<const PlacedEdge> edges, const auto& visit) {
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && have_same_ends(edges[begin], edges[end])) ++end;
    for (std::size_t a = begin; a < end; ++a) {
      for (std::size_t b = begin; b < end; ++b) {
        if (edges[a].polygon != edges[b].polygon) visit(edges[a], edges[b]);
      }
    }
  }
}

// From an edge into the face, perpendicular to the edge; unit.
Vector way_in(const Outline& outline, const PlacedEdge& edge) {
  const Vector along = edge.forward ? edge.last - edge.first : edge.first - edge.last;
  return outline.normal.cross(along).normalized();
}

// Does a kept side of the first face see one of the second beyond their edge, at less than 150 degrees?
bool sees(const PlacedEdge& a, const PlacedEdge& b, std::span<const Outline> outlines, const KeptSides& sides) {
  const Outline& one = outlines[a.polygon];
  const Outline& other = outlines[b.polygon];
  const Vector into_one = way_in(one, a);
  const Vector into_other = way_in(other, b);
  if (into_one.dot(into_other) < -smooth_cosine) return false;
  constexpr double flat = 1e-3;  // the sine of an angle at which two faces lie on each other
  const auto is_kept = [&](std::uint32_t polygon, double height) {
    return height > flat ? sides.front[polygon] != 0 : height < -flat && sides.back[polygon] != 0;
  };
  return is_kept(a.polygon, one.normal.dot(into_other)) && is_kept(b.polygon, other.normal.dot(into_one));
}

// Along an edge, from the end that comes first.
Grading grading_along(const Outline& outline, const PlacedEdge& edge) {
  const Grading grading = grading_of_edge(outline, edge.edge);
  return edge.forward ? grading : Grading{grading.at_to, grading.at_from};
}

// Takes back what shrinks patches along an edge towards ends where the neighbour's do not. Is there any?
bool even_out(Outline& outline, const PlacedEdge& edge, const Grading& neighbour) {
  const Grading own = grading_along(outline, edge);
  const auto clear = [&](bool at_first) {
    outline.is_graded[(edge.edge + (edge.forward == at_first ? 3 : 1)) % 4] = 0;
  };
  const bool first = own.at_from && !neighbour.at_from;
  const bool last = own.at_to && !neighbour.at_to;
  if (first) clear(true);
  if (last) clear(false);
  return first || last;
}

}  // namespace

std::vector<Outline> graded(std::vector<Outline> outlines, const KeptSides& sides) {
  const std::vector<PlacedEdge> edges = placed_edges(outlines);
  for (Outline& outline : outlines) {
    if (is_quad_grid(outline)) outline.is_graded.assign(4, 0);
  }
  for_each_shared(edges, [&](const PlacedEdge& a, const PlacedEdge& b) {
    Outline& outline = outlines[a.polygon];
    if (!outline.is_graded.empty() && sees(a, b, outlines, sides)) outline.is_graded[a.edge] = 1;
  });
  for (bool changed = true; changed;) {
    changed = false;
    for_each_shared(edges, [&](const PlacedEdge& a, const PlacedEdge& b) {
      const double cosine = outlines[a.polygon].normal.dot(outlines[b.polygon].normal);
      if (std::abs(cosine) < smooth_cosine) return;
      if (even_out(outlines[a.polygon], a, grading_along(outlines[b.polygon], b))) changed = true;
    });
  }
  return outlines;
}

}  // namespace patchlight
