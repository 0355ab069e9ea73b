#include "verify/delta_sources.h"

#include "base/sampling.h"
#include "base/streams.h"
#include "base/tolerances.h"
#include "scene/photometric_web.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace patchlight {
namespace {

constexpr double degrees = 180 / std::numbers::pi;

// The angle between two unit vectors; accurate for small angles.
double angle_between(const Vector& a, const Vector& b) { return std::atan2(a.cross(b).norm(), a.dot(b)) * degrees; }

// A value at an angle as a weighted mean of two neighbors in a table.
struct Neighbors {
  std::size_t below = 0;
  std::size_t above = 0;
  double weight_above = 0;
};

// Angles outside the table take its nearest end.
Neighbors neighbors_in(const std::vector<double>& angles, double angle) {
  std::size_t above = 0;
  while (above + 1 < angles.size() && angles[above] < angle) ++above;
  if (above == 0 || angle >= angles.back()) return {above, above, 0};
  return {above - 1, above, (angle - angles[above - 1]) / (angles[above] - angles[above - 1])};
}

// But for rounding.
bool is_outside(const std::vector<double>& angles, double angle) {
  return angle < angles.front() - 1e-6 || angle > angles.back() + 1e-6;
}

struct WebAngles {
  double vertical = 0;
  double horizontal = 0;
};

// IES LM-63: type C measures the vertical angle from the aim; types A and B measure both angles from it.
WebAngles web_angles(PhotometricType type, const Luminaire& luminaire, const Vector& direction) {
  const double x = luminaire.zero_plane.dot(direction);
  const double y = luminaire.zero_plane.cross(luminaire.aim).dot(direction);
  const double z = luminaire.aim.dot(direction);
  switch (type) {
    case PhotometricType::a:
      return {std::asin(std::clamp(x, -1.0, 1.0)) * degrees, std::atan2(-y, z) * degrees};
    case PhotometricType::b:
      return {std::atan2(x, z) * degrees, std::asin(std::clamp(-y, -1.0, 1.0)) * degrees};
    case PhotometricType::c:
      break;
  }
  const double turn = std::atan2(y, x) * degrees;
  return {angle_between(luminaire.aim, direction), turn < 0 ? turn + 360 : turn};
}

// Section 5.13 of LM-63-02: tables of less than a full turn are continued by their symmetry.
double fold_horizontal(const PhotometricWeb& web, double angle) {
  const double first = std::round(web.horizontal.front());
  const double last = std::round(web.horizontal.back());
  if (web.type != PhotometricType::c) return first < 0 ? angle : std::abs(angle);
  if (first == 90 && last == 270) return angle < 90 ? 180 - angle : angle > 270 ? 540 - angle : angle;
  if (last > 180) return angle;
  const double of_half = std::min(angle, 360 - angle);
  return last > 90 ? of_half : std::min(of_half, 180 - of_half);
}

double candela_in(const PhotometricWeb& web, const Luminaire& luminaire, const Vector& direction) {
  WebAngles angles = web_angles(web.type, luminaire, direction);
  if (is_outside(web.vertical, angles.vertical)) return 0;
  const bool is_round = web.horizontal.size() == 1;
  angles.horizontal = is_round ? web.horizontal.front() : fold_horizontal(web, angles.horizontal);
  if (is_outside(web.horizontal, angles.horizontal)) return 0;
  const Neighbors v = neighbors_in(web.vertical, angles.vertical);
  const Neighbors h = neighbors_in(web.horizontal, angles.horizontal);
  const auto on_plane = [&](std::size_t plane) {
    const std::size_t row = plane * web.vertical.size();
    return (1 - v.weight_above) * web.candela[row + v.below] + v.weight_above * web.candela[row + v.above];
  };
  return (1 - h.weight_above) * on_plane(h.below) + h.weight_above * on_plane(h.above);
}

double tilt_in(const PhotometricWeb& web, double tilt) {
  if (web.tilt.empty()) return 1;
  const Neighbors at = neighbors_in(web.tilt, tilt);
  return (1 - at.weight_above) * web.tilt_factor[at.below] + at.weight_above * web.tilt_factor[at.above];
}

// 2^-(angle / beam)^p, with p such that a tenth is left at the field angle.
double spot_falloff(const SpotLight& spot, double angle) {
  const double p = std::log(std::log2(10.0)) / std::log(spot.field_half_angle / spot.beam_half_angle);
  return std::exp2(-std::pow(angle / spot.beam_half_angle, p));
}

// E = I cos(theta) / d^2
LightSample from_point(const Luminaire& luminaire, const Vector& up, const LitPoint& at) {
  const Vector way = luminaire.position - at.point;
  const double distance = way.norm();
  const double cosine = at.normal.dot(way) / distance;
  const Spectrum intensity = radiant_intensity(luminaire, up, -way / distance);
  return {luminaire.position, std::max(0.0, cosine) / (distance * distance) * intensity};
}

// A direction uniform in the cone that the sphere fills: L cos(theta) over its density 1 / (2 pi (1 - cos(cone))).
// Shirley, Wang and Zimmerman 1996, section 3.2.
LightSample from_sphere(const SphericalLamp& lamp, const Point& center, const LitPoint& at, const Eigen::Vector2d& uv) {
  LightSample dark{center, Spectrum::Zero(lamp.exitance.size())};
  const double distance = (center - at.point).norm();
  if (distance <= lamp.radius) return dark;
  const double sine_of_cone = lamp.radius / distance;
  const double below_one = sine_of_cone * sine_of_cone / (1 + std::sqrt(1 - sine_of_cone * sine_of_cone));  // 1 - cos
  const double z = 1 - uv.x() * below_one;
  const double across = std::sqrt(std::max(0.0, 1 - z * z));
  const double turn = 2 * std::numbers::pi * uv.y();
  const Vector direction =
      frame_around((center - at.point) / distance) * Vector(across * std::cos(turn), across * std::sin(turn), z);
  const double cosine = at.normal.dot(direction);
  if (!(cosine > 0)) return dark;
  const double middle = distance * z;
  const double chord = lamp.radius * lamp.radius - (distance * distance - middle * middle);
  const Point near = at.point + (middle - std::sqrt(std::max(0.0, chord))) * direction;
  return {near, 2 * below_one * cosine * lamp.exitance};
}

// Perez, Seals and Michalsky 1993, table 1. One row per class of clearness: a1 to a4, b1 to b4, up to e4.
constexpr double perez_coefficients_of_classes[8][20] = {
    {1.3525, -0.2576, -0.2690, -1.4366, -0.7670, 0.0007, 1.2734, -0.1233, 2.8000,  0.6004,
     1.2375, 1.0000,  1.8734,  0.6297,  0.9738,  0.2809, 0.0356, -0.1246, -0.5718, 0.9938},
    {-1.2219, -0.7730, 1.4148,  1.1016,  -0.2054, 0.0367, -3.9128, 0.9156, 6.9750,  0.1774,
     6.4477,  -0.1239, -1.5798, -0.5081, -1.7812, 0.1080, 0.2624,  0.0672, -0.2190, -0.4285},
    {-1.1000,  -0.2515, 0.8952,  0.0156, 0.2782, -0.1812, -4.5000, 1.1766, 24.7219, -13.0812,
     -37.7000, 34.8438, -5.0000, 1.5218, 3.9229, -2.6204, -0.0156, 0.1597, 0.4199,  -0.5562},
    {-0.5484,  -0.6654, -0.2672, 0.7117, 0.7234, -0.6219, -5.6812, 2.6297,  33.3389, -18.3000,
     -62.2500, 52.0781, -3.5000, 0.0016, 1.1477, 0.1062,  0.4659,  -0.3296, -0.0876, -0.0329},
    {-0.6000,  -0.3566, -2.5000, 2.3250,  0.2937, 0.0496, -5.6812, 1.8415, 21.0000, -4.7656,
     -21.5906, 7.2492,  -3.5000, -0.1554, 1.4062, 0.3988, 0.0032,  0.0766, -0.0656, -0.1294},
    {-1.0156, -0.3670, 1.0078,  1.4051,  0.2875,  -0.5328, -3.8500, 3.3750, 14.0000, -0.9999,
     -7.1406, 7.5469,  -3.4000, -0.1078, -1.0750, 1.5702,  -0.0672, 0.4016, 0.3017,  -0.4844},
    {-1.0000, 0.0211,  0.5025,  -0.5119, -0.3000, 0.1922, 0.7023, -1.6317, 19.0000, -5.0000,
     1.2438,  -1.9094, -4.0000, 0.0250,  0.3844,  0.2656, 1.0468, -0.3788, -2.4517, 1.4656},
    {-1.0500,  0.0289,  0.4260,  0.3590, -0.3250, 0.1156, 0.7781, 0.0025,  31.0625, -14.5000,
     -46.1148, 55.3750, -7.2312, 0.4050, 13.3500, 0.6234, 1.5000, -0.6426, 1.8564,  0.5636}};

// The brightness in the fit: from 0.01 (0.2 for the clearnesses 1.065 to 2.8) to 0.6, and not beyond the first
// value at which the gradation 1 + a exp(b / cos zeta) grows without bound toward the horizon.
double brightness_of_fit(const double* x, std::size_t row, double brightness, double zenith) {
  double fit = std::min(std::max(brightness, row >= 1 && row <= 4 ? 0.2 : 0.01), 0.6);
  const double a = x[0] + x[1] * zenith;
  const double b = x[4] + x[5] * zenith;
  const double a_slope = x[2] + x[3] * zenith;
  const double b_slope = x[6] + x[7] * zenith;
  if (a + fit * a_slope > 0 && b + fit * b_slope > 0)
    fit = std::max(a_slope > 0 ? -a / a_slope : 0.01, b_slope > 0 ? -b / b_slope : 0.01);
  return fit;
}

// Equations 3 to 7 of the paper, with the sun's zenith angle in radians.
std::array<double, 5> perez_sky(double clearness, double stated_brightness, double zenith) {
  const std::size_t row = perez_class(clearness);
  const double* const x = perez_coefficients_of_classes[row];
  const double brightness = brightness_of_fit(x, row, stated_brightness, zenith);
  std::array<double, 5> sky{};
  for (std::size_t k = 0; k < sky.size(); ++k)
    sky[k] = x[4 * k] + x[4 * k + 1] * zenith + brightness * (x[4 * k + 2] + x[4 * k + 3] * zenith);
  if (row == 0) {
    sky[2] = std::exp(std::pow(brightness * (x[8] + x[9] * zenith), x[10])) - x[11];
    sky[3] = -std::exp(brightness * (x[12] + x[13] * zenith)) + x[14] + brightness * x[15];
  }
  return sky;
}

constexpr std::uint32_t no_side = ~std::uint32_t{0};

}  // namespace

Spectrum radiant_intensity(const Luminaire& luminaire, const Vector& up, const Vector& direction) {
  if (const auto* point = std::get_if<PointLight>(&luminaire.light)) return point->intensity;
  if (const auto* spot = std::get_if<SpotLight>(&luminaire.light))
    return spot_falloff(*spot, angle_between(luminaire.aim, direction)) * spot->intensity;
  const auto& measured = std::get<WebLight>(luminaire.light);
  const double tilt = angle_between(luminaire.aim, -up);
  return tilt_in(*measured.web, tilt) * candela_in(*measured.web, luminaire, direction) * measured.watts_per_lumen;
}

DeltaSources::DeltaSources(const Scene& scene, const PathScene& faces)
    : faces_(faces), luminaires_(scene.luminaires), up_(scene.up) {
  if (scene.sun && scene.sun->direction.dot(scene.up) > 0) sun_ = scene.sun;
}

std::vector<LightSample> DeltaSources::sample(const LitPoint& at, double choice, const Eigen::Vector2d& uv) const {
  std::vector<LightSample> samples;
  std::vector<double> sizes;
  for (const Luminaire& luminaire : luminaires_) {
    const auto* sphere = std::get_if<SphericalLamp>(&luminaire.light);
    samples.push_back(sphere != nullptr ? from_sphere(*sphere, luminaire.position, at, uv)
                                        : from_point(luminaire, up_, at));
    sizes.push_back(samples.back().irradiance.mean());
  }
  double sum = 0;
  for (const double size : sizes) sum += size;
  std::vector<LightSample> chosen;
  if (sum > 0) {
    for (double& size : sizes) size /= sum;
    const std::size_t k = Chooser(sizes).at(choice).index;
    chosen.push_back({samples[k].from, samples[k].irradiance / sizes[k]});
  }
  const double cosine = sun_ ? at.normal.dot(sun_->direction) : 0;
  if (cosine > 0) chosen.push_back({faces_.beyond(at.point, sun_->direction), cosine * sun_->normal_irradiance});
  return chosen;
}

SkyRadiance::SkyRadiance(const Sky& sky, const Vector& up) : kind_(sky.kind), up_(up), sun_(sky.sun_direction) {
  // ISO 15469: the CIE clear sky is 0.91 + 10 exp(-3 gamma) + 0.45 cos^2 gamma, times 1 - exp(-0.32 / cos zeta).
  if (kind_ == SkyKind::cie_clear) coefficients_ = {-1, -0.32, 10 / 0.91, -3, 0.45 / 0.91};
  if (kind_ == SkyKind::perez)
    coefficients_ = perez_sky(sky.clearness, sky.brightness, std::acos(std::clamp(sun_.dot(up), 0.0, 1.0)));
  // A fit without light, far outside its data, counts as a uniform sky.
  if (!(relative(up) > 0 && relative_horizontal_irradiance() > 0)) kind_ = SkyKind::uniform;
  scale_ = sky.horizontal_irradiance.size() > 0 ? Spectrum(sky.horizontal_irradiance / relative_horizontal_irradiance())
                                                : Spectrum(sky.zenith_radiance / relative(up));
  ground_ = sky.ground_radiance.size() > 0 ? sky.ground_radiance : Spectrum(Spectrum::Zero(scale_.size()));
}

double SkyRadiance::relative(const Vector& direction) const {
  const double sine = up_.dot(direction);
  if (kind_ == SkyKind::uniform) return 1;
  if (kind_ == SkyKind::cie_overcast) return (1 + 2 * std::max(sine, 0.0)) / 3;
  const auto& [a, b, c, d, e] = coefficients_;
  const double gamma = std::atan2(sun_.cross(direction).norm(), sun_.dot(direction));
  const double cosine = std::cos(gamma);
  // The exponent has a pole at the horizon; the fit ends above it.
  const double gradation = 1 + a * std::exp(b / std::max(sine, 0.01));
  return std::max(0.0, gradation * (1 + c * std::exp(d * gamma) + e * cosine * cosine));
}

// The midpoint rule in polar coordinates around the sun, where the radiance varies most.
double SkyRadiance::relative_horizontal_irradiance() const {
  using std::numbers::pi;
  constexpr int steps = 600;
  const Vector across = sun_.unitOrthogonal();
  const Vector aside = sun_.cross(across);
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double polar = pi * (i + 0.5) / steps;
    for (int j = 0; j < steps; ++j) {
      const double turn = 2 * pi * (j + 0.5) / steps;
      const Vector direction =
          std::cos(polar) * sun_ + std::sin(polar) * (std::cos(turn) * across + std::sin(turn) * aside);
      const double sine = up_.dot(direction);
      if (sine > 0) sum += relative(direction) * sine * std::sin(polar);
    }
  }
  return sum * (pi / steps) * (2 * pi / steps);
}

Spectrum SkyRadiance::radiance_from(const Vector& direction) const {
  return up_.dot(direction) < 0 ? ground_ : Spectrum(relative(direction) * scale_);
}

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
      const double reflectance = surface.is_specular ? specular_reflectance(surface, 0.5).maxCoeff() : 0;
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
  // About 2^15 rays of all mirrors together. Their number changes the variance alone, as that of reflections does.
  const auto points = static_cast<std::uint32_t>(std::clamp<std::size_t>((1 << 15) / (1 + sides_.size()), 4, 256));
  for (std::uint32_t s = 0; s < sides_.size(); ++s) {
    const MirrorSide& side = sides_[s];
    const std::vector<std::array<Point, 3>> triangles = triangles_of(corner_points(scene, side.polygon));
    std::vector<double> areas;
    for (const auto& [a, b, c] : triangles) areas.push_back((b - a).cross(c - a).norm() / 2);
    double area = 0;
    for (const double of_one : areas) area += of_one;
    for (double& of_one : areas) of_one /= area;
    const Chooser by_area(areas);
    for (const auto& u : scrambled_sobol(points, hash({seed, s, stream::mirror_tests}))) {
      const Choice choice = by_area.at(u[0]);
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
  for (int k = 0; k < 16 && light > 0; ++k) {
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
  const double share = tally.sum > 0 ? 0.1 : 1;  // of draws that ignore the test rays
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
    if (sides_.size() < 2 || uniform({sample.seed, length, stream::next_mirror}) >= last.reflectance) return sum;
    draw = draw_side(next_[draw.side], uniform({sample.seed, length, stream::side_of_next_mirror}));
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
    if (!(mirror.height(image.point) > tolerance_of_shapes * faces_.extent())) return sum;  // it is on the plane
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
    const double least = tolerance_of_shapes * faces_.extent();
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
