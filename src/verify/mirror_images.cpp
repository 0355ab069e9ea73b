#include "verify/mirror_images.h"

#include "base/sampling.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace patchlight {
namespace {

// The direction of a ray after its reflection at a plane.
Vector mirrored_direction(const Vector& normal, const Vector& direction) {
  return direction - 2 * normal.dot(direction) * normal;
}

// Rays between ideal mirrors may never end.
constexpr std::uint64_t max_meetings = 4096;

// After so many meetings a ray ends with the probability of absorption; before, where nothing is scattered, it goes on
// with less weight.
constexpr std::uint64_t roulette_after = 4;

bool scatters(const Surface& surface) {
  return (surface.reflectance > 0).any() || (surface.exitance > 0).any() || (surface.scattered_through > 0).any();
}

}  // namespace

RayEnd walk_to_end(const PathScene& scene, std::optional<Hit> hit, const Vector& direction, std::uint32_t seed) {
  RayEnd end{std::move(hit), direction, Spectrum::Ones(scene.bands())};
  for (std::uint64_t meeting = 0; end.hit && meeting < max_meetings; ++meeting) {
    const Hit met = *end.hit;
    const Surface& surface = scene.surfaces().at(met.polygon, met.side);
    if (!surface.is_specular) break;
    const double cosine = surface.normal.dot(met.direction);
    const Spectrum through = transmittance(surface, cosine);
    const Spectrum mirrored = specular_reflectance(surface, cosine);
    const bool may_end = scatters(surface) || meeting >= roulette_after;
    const double ends = may_end ? std::max(0.0, 1 - through.mean() - mirrored.mean()) : 0;
    const double sum = through.mean() + mirrored.mean() + ends;
    const double drawn = sum * uniform({seed, meeting, 6});
    if (drawn >= through.mean() + mirrored.mean()) {
      end.factor *=
          ends > 0 ? Spectrum(relative_held(surface, cosine) * (sum / ends)) : Spectrum(Spectrum::Zero(scene.bands()));
      break;
    }
    const bool is_mirrored = drawn >= through.mean();
    end.factor *= (is_mirrored ? mirrored / mirrored.mean() : through / through.mean()) * sum;
    if (is_mirrored) end.direction = mirrored_direction(surface.normal, end.direction);
    const Ray onward{met.point, end.direction, met.polygon};
    end.hit = scene.faces().first_hits({&onward, 1}).front();
    if (!end.hit) break;
    end.hit->distance += met.distance;
    end.hit->reflections = met.reflections + (is_mirrored ? 1 : 0);
  }
  return end;
}

namespace {

constexpr std::uint32_t no_side = ~std::uint32_t{0};

// The share of draws that ignores the test rays.
constexpr double uniform_share = 0.1;

// A point closer to a mirror's plane than this share of the extent lies on it and is not seen in it.
constexpr double on_plane_share = 1e-9;

// Test rays of all mirrors together, and how many mirrors in a row they meet at most. They change the variance alone.
constexpr std::size_t test_rays = 1 << 15;
constexpr int test_reflections = 16;

}  // namespace

void MirrorImages::Tally::add(std::uint32_t to, double light) {
  const auto found = std::find(side.begin(), side.end(), to);
  if (found == side.end()) {
    side.push_back(to);
    weight.push_back(light);
  } else {
    weight[static_cast<std::size_t>(found - side.begin())] += light;
  }
  sum += light;
}

MirrorImages::MirrorImages(const Scene& scene, const PathScene& faces, const DeltaSources& sources, std::uint64_t seed)
    : faces_(faces), sources_(sources), side_of_(2 * scene.polygons.size(), no_side) {
  if (sources.empty()) return;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    for (const Side side : {Side::front, Side::back}) {
      const Surface& surface = faces.surfaces().at(p, side);
      constexpr double usual_cosine = 0.5;
      const double reflectance = surface.is_specular ? specular_reflectance(surface, usual_cosine).maxCoeff() : 0;
      if (!(reflectance > 0)) continue;
      side_of_[2 * std::size_t{p} + static_cast<std::size_t>(side)] = static_cast<std::uint32_t>(sides_.size());
      sides_.push_back({p, side, flat_polygon(corner_points(scene, p)), surface.normal, std::min(reflectance, 0.95)});
    }
  }
  next_.resize(sides_.size());
  tally_light(scene, seed);
}

// Light that sources bring straight to points of each side, and where it goes from there.
void MirrorImages::tally_light(const Scene& scene, std::uint64_t seed) {
  const auto points = static_cast<std::uint32_t>(std::clamp<std::size_t>(test_rays / (1 + sides_.size()), 4, 256));
  for (std::uint32_t s = 0; s < sides_.size(); ++s) {
    const MirrorSide& side = sides_[s];
    const std::vector<std::array<Point, 3>> triangles = triangles_of(corner_points(scene, side.polygon));
    std::vector<double> areas;
    for (const auto& [a, b, c] : triangles) areas.push_back((b - a).cross(c - a).norm() / 2);
    double area = 0;
    for (const double of_one : areas) area += of_one;
    for (double& of_one : areas) of_one /= area;
    for (const auto& u : scrambled_sobol(points, hash({seed, s, 0x74657374}))) {
      const Choice choice = choose(areas, u[0]);
      const auto& [a, b, c] = triangles[choice.index];
      const Eigen::Vector2d weights = square_to_triangle(choice.rest, u[1]);
      const Point point = a + weights[0] * (b - a) + weights[1] * (c - a);
      for (const LightSample& light : sources_.sample({point, side.normal}, u[2], {u[3], u[2]})) {
        const Segment segment{point, light.from, side.polygon, no_polygon};
        const double arriving = (light.irradiance * faces_.transmittance({&segment, 1}).row(0)).mean() * area;
        if (!(arriving > 0)) continue;
        first_.add(s, arriving);
        follow(s, {point, (point - light.from).normalized(), side.polygon}, arriving);
      }
    }
  }
}

// A ray of light on its way to a side, from mirror to mirror.
void MirrorImages::follow(std::uint32_t side, Ray ray, double light) {
  for (int k = 0; k < test_reflections && light > 0; ++k) {
    const MirrorSide& mirror = sides_[side];
    const Surface& surface = faces_.surfaces().at(mirror.polygon, mirror.side);
    light *= specular_reflectance(surface, mirror.normal.dot(ray.direction)).mean();
    ray = {ray.origin, mirrored_direction(mirror.normal, ray.direction), mirror.polygon};
    const auto hit = faces_.faces().first_hits({&ray, 1}).front();
    if (!hit) return;
    const std::uint32_t met = side_of_[2 * std::size_t{hit->polygon} + static_cast<std::size_t>(hit->side)];
    if (met == no_side) return;
    next_[side].add(met, light);
    side = met;
    ray.origin = hit->point;
  }
}

MirrorImages::Draw MirrorImages::draw_side(const Tally& tally, double u) const {
  const auto count = static_cast<double>(sides_.size());
  const double share = tally.sum > 0 ? uniform_share : 1;
  Draw draw;
  if (u < share) {
    draw.side = static_cast<std::uint32_t>(std::min(u / share * count, count - 1));
  } else {
    double left = (u - share) / (1 - share) * tally.sum;
    std::size_t k = 0;
    while (k + 1 < tally.weight.size() && left >= tally.weight[k]) left -= tally.weight[k++];
    draw.side = tally.side[k];
  }
  const auto found = std::find(tally.side.begin(), tally.side.end(), draw.side);
  const double tallied =
      found == tally.side.end() ? 0 : tally.weight[static_cast<std::size_t>(found - tally.side.begin())] / tally.sum;
  draw.probability = share / count + (1 - share) * tallied;
  return draw;
}

// Every beginning of the chain counts, over the probability that a chain begins so.
Spectrum MirrorImages::sample_irradiance(const LitPoint& at, PolygonIndex polygon, const MirrorSample& sample) const {
  Spectrum sum = Spectrum::Zero(faces_.bands());
  std::vector<std::uint32_t> chain;
  Draw draw = draw_side(first_, sample.first_mirror);
  double probability = draw.probability;
  for (std::uint64_t length = 1;; ++length) {
    chain.push_back(draw.side);
    sum += along_chain(chain, at, polygon, sample) / probability;
    const MirrorSide& last = sides_[draw.side];
    if (sides_.size() < 2 || uniform({sample.seed, length, 1}) >= last.reflectance) return sum;
    draw = draw_side(next_[draw.side], uniform({sample.seed, length, 2}));
    probability *= last.reflectance * draw.probability;
  }
}

// The image of the point in the mirrors of the chain, the one next to the point first, is straight behind the mirror
// next to the source. There the source lights it as it lights the point.
Spectrum MirrorImages::along_chain(const std::vector<std::uint32_t>& chain, const LitPoint& at, PolygonIndex polygon,
                                   const MirrorSample& sample) const {
  Spectrum sum = Spectrum::Zero(faces_.bands());
  LitPoint image = at;
  std::vector<Point> images(chain.size() + 1, at.point);
  for (std::size_t m = chain.size(); m-- > 0;) {
    const MirrorSide& mirror = sides_[chain[m]];
    if (!(mirror.height(image.point) > on_plane_share * faces_.extent())) return sum;
    image = {mirror.mirrored(image.point), mirrored_direction(mirror.normal, image.normal)};
    images[m] = image.point;
  }
  for (const LightSample& light : sources_.sample(image, sample.luminaire, sample.on_luminaire)) {
    const auto way = unfold(chain, images, light.from, polygon);
    if (!way) continue;
    Spectrum share = faces_.transmittance(*way).colwise().prod();
    for (std::size_t m = 0; m < chain.size(); ++m) {
      const MirrorSide& mirror = sides_[chain[m]];
      const double cosine = mirror.normal.dot(((*way)[m].from - (*way)[m].to).normalized());
      share *= specular_reflectance(faces_.surfaces().at(mirror.polygon, mirror.side), cosine);
    }
    sum += light.irradiance * share;
  }
  return sum;
}

// The parts of the way from the source to the point, if each mirror is met inside its outline and from its front.
std::optional<std::vector<Segment>> MirrorImages::unfold(const std::vector<std::uint32_t>& chain,
                                                         const std::vector<Point>& images, const Point& source,
                                                         PolygonIndex polygon) const {
  std::vector<Segment> way;
  Point from = source;
  PolygonIndex from_polygon = no_polygon;
  for (std::size_t m = 0; m < chain.size(); ++m) {
    const MirrorSide& mirror = sides_[chain[m]];
    const double before = mirror.height(from);
    const double behind = -mirror.height(images[m]);
    const double least = on_plane_share * faces_.extent();
    if (!(before > least && behind > least)) return {};
    const Point met = from + before / (before + behind) * (images[m] - from);
    if (!contains(mirror.outline, met)) return {};
    way.push_back({from, met, from_polygon, mirror.polygon});
    from = met;
    from_polygon = mirror.polygon;
  }
  way.push_back({from, images.back(), from_polygon, polygon});
  return way;
}

}  // namespace patchlight
