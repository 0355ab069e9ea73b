#include "lighting/mirror_paths.h"

#include "base/sampling.h"
#include "base/tolerances.h"
#include "form_factor/point_polygon.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

namespace patchlight {
namespace {

// Up to 256 faces of the strongest emitting polygons, each polygon with both sides, because a chain does not
// distinguish them. Their chains are ranked; other faces are sampled by all chains.
std::vector<EmitterFace> ranked_faces(const Scene& scene) {
  struct Emitter {
    std::vector<EmitterFace> faces;
    double flux = 0;
  };
  std::vector<Emitter> emitters;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (!is_lamp(scene, p)) continue;
    Emitter emitter;
    for (const Side side : {Side::front, Side::back}) {
      if (!emits(scene, p, side)) continue;
      for (const EmitterFace& face : emitter_faces(scene, p, side)) {
        emitter.faces.push_back(face);
        emitter.flux += face.area * face.exitance.mean();
      }
    }
    emitters.push_back(std::move(emitter));
  }
  std::stable_sort(emitters.begin(), emitters.end(), [](const auto& a, const auto& b) { return a.flux > b.flux; });
  std::vector<EmitterFace> ranked;
  for (const Emitter& emitter : emitters) {
    if (ranked.size() + emitter.faces.size() > 256) break;  // the cost grows with faces times mirrors
    ranked.insert(ranked.end(), emitter.faces.begin(), emitter.faces.end());
  }
  return ranked;
}

}  // namespace

// The places at the mirrors of a chain where light on its way from one end of a segment to the other is reflected.
struct MirrorPaths::Way {
  std::size_t segment = 0;
  std::vector<Point> places;
};

MirrorPaths::MirrorPaths(const Scene& scene, std::shared_ptr<const SurfaceOptics> optics, MirrorChains chains)
    : chains_(std::move(chains)),
      optics_(std::move(optics)),
      least_height_(tolerance_of_shapes * bounds(scene).diagonal().norm()),
      flat_(scene.polygons.size()),
      balls_(scene.polygons.size()) {
  for (const MirrorChain& chain : chains_.chains) {
    for (const MirrorSide& mirror : chain.mirrors) {
      const PolygonIndex p = mirror.polygon;
      if (!flat_[p].corners.empty()) continue;
      const std::vector<Point> corners = corner_points(scene, p);
      flat_[p] = flat_polygon(corners);
      balls_[p] = ball_around(corners);
    }
  }
}

bool MirrorPaths::carries(const MirrorChain& chain, std::uint32_t source) const {
  const auto holds = [&](const std::vector<std::uint32_t>& ids) {
    return std::binary_search(ids.begin(), ids.end(), source);
  };
  return holds(chain.sources) || !holds(chains_.ranked);
}

Spectrum MirrorPaths::unfollowed_irradiance(const LightSampler& lights, const Point& place,
                                            const Vector& normal) const {
  Spectrum irradiance = Spectrum::Zero(optics_->bands());
  for (const auto& [corners, exitance, is_of_faces] : chains_.unfollowed)
    if (lights.has_any(is_of_faces)) irradiance += point_to_polygon(place, normal, corners) * exitance;
  return irradiance;
}

// All these lines lie in the hull of the two balls, no farther from the segment between the centers than the larger
// radius; so they meet the plane no farther from where the segment does than that over the cosine there.
bool MirrorPaths::may_pass(const MirrorChain& chain, const Ball& receiver, const Ball& source) const {
  const MirrorSide& last = chain.mirrors.back();
  const Ball& mirror = balls_[last.polygon];
  const Point image = chain.image * receiver.centre;
  const double before = last.normal.dot(source.centre - last.on_plane);
  const double behind = last.normal.dot(last.on_plane - image);
  if (before < -source.radius || behind < -receiver.radius) return false;
  const Vector way = source.centre - image;
  const double squared_length = way.squaredNorm();
  const double along = squared_length > 0 ? std::clamp((mirror.centre - image).dot(way) / squared_length, 0.0, 1.0) : 0;
  const double wide = std::max(receiver.radius, source.radius);
  const double reach = mirror.radius + wide;
  if ((image + along * way - mirror.centre).squaredNorm() > (1 + tolerance_of_coordinates) * reach * reach)
    return false;
  if (!(before > source.radius && behind > receiver.radius)) return true;

  const FlatPolygon& flat = flat_[last.polygon];
  const Eigen::Vector2d place = flat.in_plane(image + behind / (before + behind) * way);
  const double spread = wide * std::sqrt(squared_length) / (before + behind);
  return flat.box.squaredExteriorDistance(place) <= (1 + tolerance_of_coordinates) * spread * spread;
}

bool MirrorPaths::may_pass(const MirrorChain& chain, const Ball& receiver, const Vector& toward_source) const {
  const Ball& mirror = balls_[chain.mirrors.back().polygon];
  const Vector way = mirror.centre - chain.image * receiver.centre;
  const double along = std::max(0.0, way.dot(toward_source));
  const double reach = mirror.radius + receiver.radius;
  return (along * toward_source - way).squaredNorm() <= (1 + tolerance_of_coordinates) * reach * reach;
}

// From the last mirror to the first: the straight line from the receiver's image behind a mirror to the place that
// light goes to from there.
std::vector<MirrorPaths::Way> MirrorPaths::ways(const MirrorChain& chain, std::span<const Segment> segments) const {
  std::vector<Way> found;
  Way way{0, std::vector<Point>(chain.mirrors.size())};
  for (std::size_t k = 0; k < segments.size(); ++k) {
    Point image = chain.image * segments[k].from;
    Point onward = segments[k].to;
    way.segment = k;
    bool meets_all = true;
    for (std::size_t m = chain.mirrors.size(); m-- > 0 && meets_all;) {
      const MirrorSide& mirror = chain.mirrors[m];
      const double before = mirror.normal.dot(onward - mirror.on_plane);
      const double behind = -mirror.normal.dot(image - mirror.on_plane);
      meets_all = before > least_height_ && behind > least_height_;
      if (!meets_all) break;
      way.places[m] = image + behind / (before + behind) * (onward - image);
      meets_all = contains(flat_[mirror.polygon], way.places[m]);
      image += 2 * behind * mirror.normal;
      onward = way.places[m];
    }
    if (meets_all) found.push_back(way);
  }
  return found;
}

Field MirrorPaths::transmittance(const MirrorChain& chain, const LightPaths& paths,
                                 std::span<const Segment> segments) const {
  Field share = Field::Zero(static_cast<Eigen::Index>(segments.size()), optics_->bands());
  const std::vector<Way> found = ways(chain, segments);
  if (found.empty()) return share;
  Field along = Field::Ones(static_cast<Eigen::Index>(found.size()), optics_->bands());
  for (std::size_t m = 0; m <= chain.mirrors.size(); ++m) {
    std::vector<Segment> parts;
    for (std::size_t w = 0; w < found.size(); ++w) {
      const Segment& whole = segments[found[w].segment];
      const bool is_first = m == 0;
      const bool is_last = m == chain.mirrors.size();
      const Segment part{is_first ? whole.from : found[w].places[m - 1], is_last ? whole.to : found[w].places[m],
                         is_first ? whole.from_polygon : chain.mirrors[m - 1].polygon,
                         is_last ? whole.to_polygon : chain.mirrors[m].polygon};
      parts.push_back(part);
      if (is_last) continue;
      const Vector direction = (part.to - part.from).normalized();
      along.row(static_cast<Eigen::Index>(w)) *= optics_->spectral_reflectance(chain.mirrors[m].polygon, direction);
    }
    along *= paths.transmittance(parts);
  }
  for (std::size_t w = 0; w < found.size(); ++w)
    share.row(static_cast<Eigen::Index>(found[w].segment)) = along.row(static_cast<Eigen::Index>(w));
  return share;
}

SpecularAim::SpecularAim(const Scene& scene, const SurfaceOptics& optics) {
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p)
    if (optics.at(p)) targets_.push_back(opening_at(scene, p));
  std::stable_sort(targets_.begin(), targets_.end(),
                   [](const Opening& a, const Opening& b) { return a.area > b.area; });
  constexpr std::size_t max_targets = 256;  // cosine-distributed rays find smaller ones
  has_all_faces_ = targets_.size() <= max_targets;
  if (!has_all_faces_) targets_.resize(max_targets);
}

Chooser SpecularAim::targets_from(const SurfacePoint& at) const {
  std::vector<double> probabilities;
  double sum = 0;
  for (const Opening& target : targets_) {
    const bool is_before = target.polygon != at.polygon && rises_above(target, at.point, at.normal, 0);
    probabilities.push_back(is_before ? apparent_size(target, at.point) : 0);
    sum += probabilities.back();
  }
  if (!(sum > 0)) return {};
  constexpr std::size_t max_targets = 32;  // each costs time for every ray
  if (probabilities.size() > max_targets) {
    std::vector<double> sorted = probabilities;
    std::nth_element(sorted.begin(), sorted.begin() + max_targets - 1, sorted.end(), std::greater<>());
    for (double& probability : probabilities)
      if (probability < sorted[max_targets - 1]) probability = 0;
    sum = std::accumulate(probabilities.begin(), probabilities.end(), 0.0);
  }
  for (double& probability : probabilities) probability /= sum;
  return Chooser(probabilities);
}

// 1/sr
double SpecularAim::aimed_density(const Chooser& targets, const SurfacePoint& at, const Vector& direction) const {
  double density = 0;
  for (const auto& [k, probability, up_to] : targets.alternatives()) {
    if (const auto distance = distance_to(targets_[k], at.point, direction))
      density += density_at(targets_[k], probability, *distance, direction);
  }
  return density;
}

std::vector<WeightedRay> SpecularAim::rays(const SurfacePoint& at, const Chooser& targets,
                                           std::span<const std::array<double, 2>> samples) const {
  const std::size_t aimed = targets.empty() ? 0 : samples.size() / 2;
  const std::size_t diffuse = samples.size() - aimed;
  std::vector<WeightedRay> rays;
  rays.reserve(samples.size());
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const auto& [s, t] = samples[k];
    Vector direction;
    if (k < diffuse) {
      direction = cosine_direction(at.normal, s, t);
    } else {
      const Choice chosen = targets.at(s);
      direction = (point_of(targets_[chosen.index], chosen.rest, t) - at.point).normalized();
    }
    const double cosine = at.normal.dot(direction);
    if (!(cosine > 0)) continue;
    const double density = static_cast<double>(diffuse) * cosine / std::numbers::pi +
                           static_cast<double>(aimed) * aimed_density(targets, at, direction);
    rays.push_back({{at.point, direction, at.polygon}, cosine / density});
  }
  return rays;
}

Mirrors::Mirrors(const Scene& scene, const Tracing& tracing, const Lighting& lighting)
    : paths(scene, lighting.paths.optics(),
            mirror_chains(scene, LightSampler(lighting, ranked_faces(scene)).sources())),
      aim(scene, *lighting.paths.optics()),
      occluder(tracing.all_faces()) {}

}  // namespace patchlight
