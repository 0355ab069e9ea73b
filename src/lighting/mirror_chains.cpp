#include "lighting/mirror_chains.h"

#include "base/sampling.h"
#include "form_factor/point_polygon.h"
#include "light/pane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

namespace patchlight {
namespace {

constexpr std::size_t most_chains = 1024;

// Each receiver samples every source by each chain that may lead to it: 64 sources by all chains, or more by fewer.
constexpr std::size_t most_sources_of_chains = 64 * most_chains;

// The work of the search after single mirrors: a beam that is clipped to a side counts 1, and its flux 16 more.
constexpr std::size_t most_work = 5'000'000;
constexpr std::size_t work_of_flux = 16;

// Directions of equal flux of a source: they resolve narrow sources, and points of a mirror resolve small mirrors.
constexpr int directions_of_source = 64;

// The largest reflectance over the bands; for a clear material that of light from all directions alike.
double reflectance_of(const Material& material) {
  if (material.specular_reflectance.size() > 0) return material.specular_reflectance.maxCoeff();
  double most = 0;
  for (const Pane& pane : panes_of(material.index, material.transmittance))
    most = std::max(most, hemispherical_reflectance(pane));
  return most;
}

// A source, its flux, and directions each of which stands for the same share of it.
struct SourceFlux {
  const LightSource* source;
  Spectrum flux;  // W; of the sun: onto all mirrors
  std::vector<Vector> directions;
};

struct DirectionCell {
  Vector direction;
  Spectrum flux;
};

// I dOmega in cells of directions, each evaluated at its middle. Rings around the axis become narrower towards it, by a
// factor of 1,000 in all. Light with extent is seen from afar.
std::vector<DirectionCell> direction_cells(const LightSource& source) {
  constexpr int rings = 40;
  constexpr int cells_of_ring = 16;
  const Ball& ball = source.extent().ball;
  const double distance = ball.radius > 0 ? 100 * ball.radius : 1;
  const Vector across = source.axis().unitOrthogonal();
  const Vector third = source.axis().cross(across);
  const auto angle_of = [](double ring) {
    return std::numbers::pi * std::expm1(std::log(1000.0) * ring / rings) / 999;
  };
  std::vector<DirectionCell> cells;
  for (int ring = 0; ring < rings; ++ring) {
    const double middle = (angle_of(ring) + angle_of(ring + 1)) / 2;
    const double half_width = (angle_of(ring + 1) - angle_of(ring)) / 2;
    const double solid_angle = 4 * std::numbers::pi / cells_of_ring * std::sin(middle) * std::sin(half_width);
    for (int cell = 0; cell < cells_of_ring; ++cell) {
      const double turn = 2 * std::numbers::pi * (cell + 0.5) / cells_of_ring;
      const Vector toward =
          std::cos(middle) * source.axis() + std::sin(middle) * (std::cos(turn) * across + std::sin(turn) * third);
      const SurfacePoint at{ball.centre + distance * toward, -toward, no_polygon};
      const LightSample sample = source.sample(at, {0.5, 0.5});
      if (sample.irradiance > 0)
        cells.push_back({toward, distance * distance * solid_angle * sample.irradiance * *sample.color});
    }
  }
  return cells;
}

SourceFlux flux_of(const LightSource& source, Eigen::Index bands) {
  SourceFlux found{&source, Spectrum::Zero(bands), {}};
  if (source.extent().direction) return found;
  const std::vector<DirectionCell> cells = direction_cells(source);
  for (const DirectionCell& cell : cells) found.flux += cell.flux;
  const double step = found.flux.mean() / directions_of_source;
  double sum = 0;
  for (const DirectionCell& cell : cells) {
    sum += cell.flux.mean();
    while (found.directions.size() < directions_of_source &&
           sum > (static_cast<double>(found.directions.size()) + 0.5) * step)
      found.directions.push_back(cell.direction);
  }
  return found;
}

// So far before a plane something has to be to count.
double tolerance_in(const Scene& scene) { return 1e-7 * bounds(scene).diagonal().norm(); }

bool has_corner_before(std::span<const Point> corners, const MirrorSide& mirror, double tolerance) {
  return std::any_of(corners.begin(), corners.end(),
                     [&](const Point& corner) { return mirror.normal.dot(corner - mirror.on_plane) > tolerance; });
}

std::vector<MirrorSide> mirror_sides(const Scene& scene) {
  const double tolerance = tolerance_in(scene);
  std::vector<double> by_material;
  for (const Material& material : scene.materials) by_material.push_back(reflectance_of(material));
  std::vector<MirrorSide> sides;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const Polygon& polygon = scene.polygons[p];
    const bool is_clear = is_opening(scene, p);
    for (const Side side : {Side::front, Side::back}) {
      const double reflectance = by_material[material_on(polygon, side)];
      if (!(reflectance > 0) || !(is_clear || is_mirror(scene, p, side))) continue;
      const Vector front = front_normal(scene, p);
      const MirrorSide mirror{p, side, side == Side::front ? front : Vector(-front), scene.vertices[polygon.corners[0]],
                              reflectance};
      if (has_corner_before(scene.vertices, mirror, tolerance)) sides.push_back(mirror);
    }
  }
  return sides;
}

// Counter-clockwise from the side.
std::vector<Point> corners_of(const Scene& scene, const MirrorSide& side) {
  std::vector<Point> corners = corner_points(scene, side.polygon);
  if (side.side == Side::back) std::reverse(corners.begin(), corners.end());
  return corners;
}

// The convex hull of points of a plane, counter-clockwise around its normal. Andrew's monotone chain.
std::vector<Point> convex_hull(std::vector<Point> points, const Vector& normal) {
  const Vector u = normal.unitOrthogonal();
  const Vector v = normal.cross(u);
  std::sort(points.begin(), points.end(), [&](const Point& a, const Point& b) {
    return std::pair(u.dot(a), v.dot(a)) < std::pair(u.dot(b), v.dot(b));
  });
  std::vector<Point> hull;
  const auto add_half = [&](auto first, auto last) {
    const std::size_t start = hull.size();
    for (; first != last; ++first) {
      const auto turns_right = [&](const Point& a, const Point& b) {
        return normal.dot((b - a).cross(*first - b)) <= 0;
      };
      while (hull.size() >= start + 2 && turns_right(hull[hull.size() - 2], hull.back())) hull.pop_back();
      hull.push_back(*first);
    }
    hull.pop_back();
  };
  add_half(points.begin(), points.end());
  add_half(points.rbegin(), points.rend());
  return hull;
}

// x - 2 n n . (x - p)
Eigen::Affine3d reflection_at(const MirrorSide& mirror) {
  Eigen::Affine3d reflection;
  reflection.linear() = Eigen::Matrix3d::Identity() - 2 * mirror.normal * mirror.normal.transpose();
  reflection.translation() = 2 * mirror.normal.dot(mirror.on_plane) * mirror.normal;
  return reflection;
}

// A source as one sees it in the mirrors of a chain.
SourceExtent image_of(const SourceExtent& source, const Eigen::Affine3d& image) {
  const Eigen::Affine3d back = image.inverse(Eigen::Isometry);
  SourceExtent seen = source;
  if (seen.direction) seen.direction = back.linear() * *source.direction;
  seen.ball.centre = back * source.ball.centre;
  return seen;
}

// The half-space of the light that leaves a source and passes a mirror inside of one of its edges: its plane contains
// the edge and touches the ball of the source. Nothing where the edge does not limit the light.
std::optional<Vector> normal_inside(const Point& a, const Point& b, const Point& inside, const SourceExtent& source) {
  const Vector edge = b - a;
  Vector way = source.direction ? *source.direction : Vector(source.ball.centre - a);
  way -= edge * (edge.dot(way) / edge.squaredNorm());
  const double distance = way.norm();
  const double sine = source.direction ? 0 : source.ball.radius / distance;
  if (!(edge.squaredNorm() > 0 && sine < 1)) return std::nullopt;
  Vector normal = edge.cross(way).normalized();
  if (normal.dot(inside - a) < 0) normal = -normal;
  return std::sqrt(1 - sine * sine) * normal - sine * (way / distance);
}

// The light of one source that meets the first mirror of a chain from the receiver: where, and the flux if all mirrors
// before it reflected all light.
struct Beam {
  std::size_t source = 0;
  std::vector<Point> section;  // convex, in the plane of the mirror
  Spectrum flux;
};

// The part of a convex polygon that light of the source reaches by way of a section of a mirror.
std::vector<Point> lit_part(std::vector<Point> polygon, const MirrorSide& mirror, std::span<const Point> section,
                            const SourceExtent& source) {
  polygon = clip_to_half_space(polygon, mirror.on_plane, mirror.normal);
  const Point inside = ball_around(section).centre;
  for (std::size_t k = 0; k < section.size() && !polygon.empty(); ++k) {
    const Point& next = section[(k + 1) % section.size()];
    if (const auto normal = normal_inside(section[k], next, inside, source))
      polygon = clip_to_half_space(polygon, section[k], *normal);
  }
  return polygon;
}

bool is_lit_from(const MirrorSide& side, const SourceExtent& source) {
  if (source.direction) return side.normal.dot(*source.direction) > 0;
  return side.normal.dot(source.ball.centre - side.on_plane) > -source.ball.radius;
}

bool meets(const std::vector<Point>& section, const Vector& normal, const Point& from, const Vector& direction) {
  const double facing = -normal.dot(direction);
  const double height = normal.dot(from - section[0]);
  if (!(facing > 0 && height > 0)) return false;
  const Point place = from + height / facing * direction;
  for (std::size_t k = 0; k < section.size(); ++k) {
    const Point& next = section[(k + 1) % section.size()];
    if (normal.dot((next - section[k]).cross(place - section[k])) < 0) return false;
  }
  return true;
}

// The integral of E d^2 / cos theta over the solid angle of a section, seen from the source. Parallel light and sources
// in the mirror's plane use a distant point above its middle.
Spectrum flux_by_points(const SourceFlux& light, const SourceExtent& seen, std::span<const Point> section,
                        const MirrorSide& side, const Eigen::Affine3d& image,
                        std::span<const std::array<double, 4>> points) {
  const Ball around = ball_around(section);
  const double height = side.normal.dot(seen.ball.centre - side.on_plane);
  const bool is_before = !seen.direction && height > seen.ball.radius;
  const Point eye = is_before ? seen.ball.centre : Point(around.centre + 1000 * around.radius * side.normal);
  Spectrum sum = Spectrum::Zero(light.flux.size());
  for (const auto& [u, v, s, t] : points) {
    const SeenPoint sample = sample_seen_point(eye, section, u, v);
    if (!(sample.solid_angle > 0)) continue;
    const SurfacePoint at{sample.point, side.normal, side.polygon};
    const SurfacePoint reflected{image * at.point, image.linear() * at.normal, side.polygon};
    const LightSample arriving = light.source->sample(reflected, {s, t});
    if (!(arriving.irradiance > 0)) continue;
    const Vector way = eye - at.point;
    const double area_per_angle = way.squaredNorm() * way.norm() / side.normal.dot(way);
    sum += sample.solid_angle * sample.weight * area_per_angle * arriving.irradiance * *arriving.color;
  }
  return sum / static_cast<double>(points.size());
}

Spectrum flux_by_directions(const SourceFlux& light, const SourceExtent& seen, const std::vector<Point>& section,
                            const MirrorSide& side, const Eigen::Affine3d& image) {
  if (seen.direction || seen.ball.radius > 0) return Spectrum::Zero(light.flux.size());
  const Eigen::Matrix3d back = image.linear().transpose();
  const auto met = std::count_if(light.directions.begin(), light.directions.end(), [&](const Vector& direction) {
    return meets(section, side.normal, seen.ball.centre, back * direction);
  });
  return light.flux * (static_cast<double>(met) / directions_of_source);
}

// Bound of the light of all longer chains, relative to a chain of n mirrors. Each further mirror reflects rho, so the
// sum is at most rho / (1 - rho). Images recede between two mirrors, like k = n + 1, n + 2 ..., so that it is less than
// the sum of n^2 / k^2, which is less than n.
double light_beyond(std::size_t mirrors, double reflectance) {
  const auto n = static_cast<double>(mirrors);
  return reflectance < 1 ? std::min(n, reflectance / (1 - reflectance)) : n;
}

// A chain that may be followed. Those with the largest share come first, of equal ones those that were found first.
struct QueuedChain {
  MirrorChain chain;
  std::size_t first = 0;  // of its mirrors from the receiver, among all sides
  std::vector<Beam> beams;
  double share = 0;
  std::size_t number = 0;

  bool operator<(const QueuedChain& other) const {
    return share != other.share ? share > other.share : number < other.number;
  }
};

class ChainSearch {
 public:
  ChainSearch(const Scene& scene, std::span<const LightSource> sources);
  MirrorChains run();

 private:
  QueuedChain continued(const QueuedChain& before, std::size_t side);
  std::vector<Spectrum>& left_by(const Beam& beam) { return left_[sources_[beam.source].source->is_face() ? 1 : 0]; }
  double share_of(const Beam& beam) const { return beam.flux.mean() / sources_[beam.source].flux.mean(); }
  void add(QueuedChain candidate);
  void add_single();
  double add_longer(const QueuedChain& candidate);
  void leave_out(const QueuedChain& candidate, const Beam& beam);
  void leave_out_longer(const QueuedChain& candidate);

  double tolerance_;
  std::vector<MirrorSide> sides_;
  std::vector<std::vector<Point>> corners_;  // of each side
  std::vector<std::vector<Point>> hulls_;
  std::vector<SourceFlux> sources_;
  std::vector<std::array<double, 4>> points_ = scrambled_sobol(16, 1);  // of a mirror
  double most_reflectance_ = 0;
  std::size_t work_ = 0;
  double reflected_ = 0;                       // W, straight from the sources, mean of the bands
  std::array<std::vector<Spectrum>, 2> left_;  // of others and of faces: W, from each side
  std::set<QueuedChain> queue_;
  std::size_t number_ = 0;
  MirrorChains found_;
};

ChainSearch::ChainSearch(const Scene& scene, std::span<const LightSource> sources)
    : tolerance_(tolerance_in(scene)), sides_(mirror_sides(scene)) {
  const Eigen::Index bands = number_of_bands(scene);
  for (const MirrorSide& side : sides_) {
    corners_.push_back(corners_of(scene, side));
    hulls_.push_back(convex_hull(corners_.back(), side.normal));
    most_reflectance_ = std::max(most_reflectance_, side.reflectance);
  }
  left_.fill(std::vector<Spectrum>(sides_.size(), Spectrum::Zero(bands)));
  for (const LightSource& source : sources) {
    sources_.push_back(flux_of(source, bands));
    found_.ranked.push_back(source.id());
  }
  std::sort(found_.ranked.begin(), found_.ranked.end());
}

// With one mirror more, nearest to the receiver; and the beams that get there.
QueuedChain ChainSearch::continued(const QueuedChain& before, std::size_t number) {
  const MirrorSide& side = sides_[number];
  QueuedChain longer;
  longer.chain = before.chain;
  longer.chain.mirrors.insert(longer.chain.mirrors.begin(), side);
  longer.chain.reflectance *= side.reflectance;
  longer.chain.image = before.chain.image * reflection_at(side);
  longer.first = number;
  for (const Beam& beam : before.beams) {
    const SourceFlux& light = sources_[beam.source];
    const SourceExtent seen = image_of(light.source->extent(), before.chain.image);
    ++work_;
    if (!is_lit_from(side, seen)) continue;
    std::vector<Point> section = hulls_[number];
    if (!beam.section.empty()) section = lit_part(std::move(section), before.chain.mirrors.front(), beam.section, seen);
    if (section.empty()) continue;
    work_ += work_of_flux;
    const Spectrum by_points = flux_by_points(light, seen, section, side, before.chain.image, points_);
    const Spectrum by_directions = flux_by_directions(light, seen, section, side, before.chain.image);
    longer.beams.push_back({beam.source, std::move(section), by_points.max(by_directions)});
  }
  return longer;
}

// Chains that continue it are counted with it.
void ChainSearch::leave_out(const QueuedChain& candidate, const Beam& beam) {
  const double all = 1 + light_beyond(candidate.chain.mirrors.size(), most_reflectance_);
  left_by(beam)[candidate.first] += all * candidate.chain.reflectance * beam.flux;
}

// The chains that continue one that is followed itself.
void ChainSearch::leave_out_longer(const QueuedChain& candidate) {
  found_.is_cut = true;
  const double longer = light_beyond(candidate.chain.mirrors.size(), most_reflectance_);
  for (const Beam& beam : candidate.beams)
    left_by(beam)[candidate.first] += longer * candidate.chain.reflectance * beam.flux;
}

// Beams with less than 1e-7 of the flux of their source are not followed. No more chains wait than may be followed yet:
// a chain never carries more than the one that it continues.
void ChainSearch::add(QueuedChain candidate) {
  std::vector<Beam> beams;
  for (Beam& beam : candidate.beams) {
    const double share = candidate.chain.reflectance * share_of(beam);
    candidate.share = std::max(candidate.share, share);
    if (share >= 1e-7)
      beams.push_back(std::move(beam));
    else
      leave_out(candidate, beam);
  }
  if (beams.empty()) return;
  candidate.beams = std::move(beams);
  candidate.number = number_++;
  queue_.insert(std::move(candidate));
  if (found_.chains.size() + queue_.size() <= most_chains) return;
  found_.is_cut = true;
  const auto last = std::prev(queue_.end());
  for (const Beam& beam : last->beams) leave_out(*last, beam);
  queue_.erase(last);
}

// The same with one mirror more, as far as there is work left. Returns the highest reflectance of one with which it is
// too long to be followed.
double ChainSearch::add_longer(const QueuedChain& candidate) {
  const MirrorSide& first = sides_[candidate.first];
  double too_long = 0;
  bool is_complete = true;
  for (std::size_t k = 0; k < sides_.size(); ++k) {
    const MirrorSide& side = sides_[k];
    if (!has_corner_before(corners_[k], first, tolerance_)) continue;
    if (!has_corner_before(corners_[candidate.first], side, tolerance_)) continue;
    const bool is_followed = candidate.chain.mirrors.size() < most_mirrors &&
                             candidate.chain.reflectance * side.reflectance >= least_reflectance;
    if (!is_followed)
      too_long = std::max(too_long, side.reflectance);
    else if (work_ < most_work)
      add(continued(candidate, k));
    else
      is_complete = false;
  }
  if (!is_complete) leave_out_longer(candidate);
  return too_long;
}

// Light of all sources that goes to each side of a mirror.
void ChainSearch::add_single() {
  QueuedChain straight;
  for (std::size_t k = 0; k < sources_.size(); ++k) straight.beams.push_back({k, {}, sources_[k].flux});
  std::vector<QueuedChain> single;
  for (std::size_t k = 0; k < sides_.size(); ++k) {
    single.push_back(continued(straight, k));
    for (const Beam& beam : single.back().beams) {
      reflected_ += sides_[k].reflectance * beam.flux.mean();
      SourceFlux& light = sources_[beam.source];
      if (light.source->extent().direction) light.flux += beam.flux;
    }
  }
  for (QueuedChain& candidate : single) add(std::move(candidate));
  work_ = 0;
}

MirrorChains ChainSearch::run() {
  add_single();
  std::size_t pairs = 0;
  while (!queue_.empty()) {
    QueuedChain next = std::move(queue_.extract(queue_.begin()).value());
    if (pairs + next.beams.size() > most_sources_of_chains) {
      found_.is_cut = true;
      for (const Beam& beam : next.beams) leave_out(next, beam);
      continue;
    }
    pairs += next.beams.size();
    for (const Beam& beam : next.beams) next.chain.sources.push_back(sources_[beam.source].source->id());
    std::sort(next.chain.sources.begin(), next.chain.sources.end());
    found_.chains.push_back(next.chain);
    found_.chains.back().beyond = light_beyond(next.chain.mirrors.size(), add_longer(next));
  }
  double left = 0;
  for (const bool is_of_faces : {false, true}) {
    for (std::size_t k = 0; k < sides_.size(); ++k) {
      const Spectrum& of_side = left_[is_of_faces ? 1 : 0][k];
      if (!(of_side > 0).any()) continue;
      left += of_side.mean();
      found_.unfollowed.push_back({corners_[k], of_side / area_vector(corners_[k]).norm(), is_of_faces});
    }
  }
  found_.unfollowed_share = reflected_ > 0 ? left / reflected_ : 0;
  return found_;
}

}  // namespace

MirrorChains mirror_chains(const Scene& scene, std::span<const LightSource> sources) {
  return ChainSearch(scene, sources).run();
}

}  // namespace patchlight
