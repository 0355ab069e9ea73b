#include "lighting/light_source.h"

#include "base/sampling.h"
#include "form_factor/point_polygon.h"
#include "scene/photometric_web.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace patchlight {
namespace {

// Relative intensity and color of luminaires without extent.
double relative_intensity(const PointLight&, const Luminaire&, const Vector&, const Vector&) { return 1; }
double relative_intensity(const SpotLight& spot, const Luminaire& luminaire, const Vector& direction, const Vector&) {
  return spot_profile(spot, luminaire.aim.dot(direction));
}
double relative_intensity(const WebLight& light, const Luminaire& luminaire, const Vector& direction,
                          const Vector& up) {
  const double tilt = std::acos(std::clamp(-luminaire.aim.dot(up), -1.0, 1.0)) * (180 / std::numbers::pi);
  return tilt_factor(*light.web, tilt) * candela(*light.web, {luminaire.aim, luminaire.zero_plane}, direction);
}
const Spectrum& color_of(const PointLight& light) { return light.intensity; }
const Spectrum& color_of(const SpotLight& light) { return light.intensity; }
const Spectrum& color_of(const WebLight& light) { return light.watts_per_lumen; }

// E = I cos theta / d^2
template <typename Light>
LightSample sample_of_light(const Light& light, const Luminaire& luminaire, const Vector& up, const SurfacePoint& at,
                            const Eigen::Vector2d&) {
  const Vector way = luminaire.position - at.point;
  const double square = way.squaredNorm();
  const double cosine = at.normal.dot(way) / std::sqrt(square);
  if (!(cosine > 0)) return {};
  const double intensity = relative_intensity(light, luminaire, -way / std::sqrt(square), up);
  return {luminaire.position, no_polygon, intensity * cosine / square, &color_of(light)};
}

// Directions are uniform in the solid angle of the sphere: Shirley, Wang and Zimmerman 1996, section 3.2.
LightSample sample_of_light(const SphericalLamp& lamp, const Luminaire& luminaire, const Vector&,
                            const SurfacePoint& at, const Eigen::Vector2d& uv) {
  const Vector way = luminaire.position - at.point;
  const double distance = way.norm();
  if (distance <= lamp.radius) return {};
  // The sphere fills the cone with this half angle; 1 - cos without cancellation.
  const double sine = lamp.radius / distance;
  const double lift = sine * sine / (1 + std::sqrt(1 - sine * sine));
  const double cosine = 1 - uv.x() * lift;
  const double turn = 2 * std::numbers::pi * uv.y();
  const Vector axis = way / distance;
  const Vector across = axis.unitOrthogonal();
  const Vector direction = cosine * axis + std::sqrt(std::max(0.0, 1 - cosine * cosine)) *
                                               (std::cos(turn) * across + std::sin(turn) * axis.cross(across));
  const double received = at.normal.dot(direction);
  if (!(received > 0)) return {};
  // Nearer than the sphere's middle by the half chord.
  const double along = distance * cosine;
  const double half_chord = std::sqrt(std::max(0.0, lamp.radius * lamp.radius - distance * distance + along * along));
  // L times the solid angle of the cone, 2 pi (1 - cos), with L = E / pi.
  return {at.point + (along - half_chord) * direction, no_polygon, 2 * lift * received, &lamp.exitance};
}

const SphericalLamp* sphere_of(const Luminaire& luminaire) { return std::get_if<SphericalLamp>(&luminaire.light); }

std::size_t corner_count(const EmitterFace& face) { return face.corners[2] == face.corners[3] ? 3 : 4; }

double form_factor_of(const EmitterFace& face, const SurfacePoint& at) {
  return point_to_polygon(at.point, at.normal, std::span(face.corners.data(), corner_count(face)));
}

// Above 0 if the point is in front of the face and a part of the face is above the horizon.
double possible_irradiance_of(const EmitterFace& face, const Ball& ball, const SurfacePoint& at) {
  double rise = 0;
  for (const Point& corner : face.corners) rise = std::max(rise, at.normal.dot(corner - at.point));
  const double before = face.normal.dot(at.point - face.corners[0]);
  if (!(rise > 0 && before > 0)) return 0;
  const double square = (ball.centre - at.point).squaredNorm() + face.area;
  const double far = face.area * rise * before / (std::numbers::pi * square * square);
  // The estimate from afar is too small before the end of a long face.
  const bool is_near = square < 9 * ball.radius * ball.radius;
  return face.exitance.mean() * (is_near ? std::max(far, form_factor_of(face, at)) : far);
}

// The irradiance of a surface that faces the sphere, where any of it is above the horizon.
double possible_irradiance_of(const SphericalLamp& lamp, const Ball& ball, const SurfacePoint& at) {
  const Vector way = ball.centre - at.point;
  const bool is_before = at.normal.dot(way) > -ball.radius && way.norm() > ball.radius;
  return is_before ? lamp.exitance.mean() * ball.radius * ball.radius / way.squaredNorm() : 0;
}

// Numbers at equal steps with one offset, u: each choice is made about as often as it is probable.
std::vector<std::size_t> choose_evenly(const std::vector<double>& weights, double sum, std::uint32_t count, double u) {
  std::vector<std::size_t> chosen;
  std::size_t next = 0;
  double before = 0;
  for (std::uint32_t k = 0; k < count; ++k) {
    const double wanted = (k + u) / count * sum;
    while (next + 1 < weights.size() && before + weights[next] <= wanted) before += weights[next++];
    while (next > 0 && !(weights[next] > 0)) before -= weights[--next];
    chosen.push_back(next);
  }
  return chosen;
}

}  // namespace

Ball ball_around(std::span<const Point> points) {
  Ball ball;
  for (const Point& point : points) ball.centre += point / static_cast<double>(points.size());
  for (const Point& point : points) ball.radius = std::max(ball.radius, (point - ball.centre).norm());
  return ball;
}

std::vector<EmitterFace> emitter_faces(const Scene& scene, PolygonIndex polygon, Side side) {
  std::vector<Point> corners = corner_points(scene, polygon);
  if (side == Side::back) std::reverse(corners.begin(), corners.end());
  const Spectrum& exitance = scene.materials[material_on(scene.polygons[polygon], side)].exitance;
  const Vector normal = (side == Side::front ? 1 : -1) * front_normal(scene, polygon);
  std::vector<EmitterFace> faces;
  for (const std::array<Point, 4>& piece : convex_pieces(corners))
    faces.push_back({piece, normal, area_vector(piece).norm(), polygon, exitance});
  return faces;
}

LightSource::LightSource(const Luminaire& luminaire, const Vector& up, std::uint32_t id)
    : id_(id),
      is_delta_(sphere_of(luminaire) == nullptr),
      extent_{{}, {luminaire.position, is_delta_ ? 0 : sphere_of(luminaire)->radius}},
      axis_(luminaire.aim),
      of_(OfLuminaire{&luminaire, up}) {}

LightSource::LightSource(const Lighting& lighting, const Sun& sun, std::uint32_t id)
    : id_(id), is_delta_(true), extent_{sun.direction, {}}, axis_(-sun.direction), of_(OfSun{&lighting, &sun}) {}

LightSource::LightSource(EmitterFace face, std::uint32_t id)
    : id_(id),
      is_delta_(false),
      extent_{{}, ball_around(face.corners)},
      axis_(face.normal),
      of_(OfFace{face, QuadPoints(face.corners)}) {}

LightSample LightSource::sample_of(const OfLuminaire& source, const SurfacePoint& at, const Eigen::Vector2d& uv) const {
  const Luminaire& luminaire = *source.luminaire;
  const auto by = [&](const auto& light) { return sample_of_light(light, luminaire, source.up, at, uv); };
  return std::visit(by, luminaire.light);
}

LightSample LightSource::sample_of(const OfSun& source, const SurfacePoint& at, const Eigen::Vector2d&) const {
  const Vector& direction = source.sun->direction;
  const double cosine = at.normal.dot(direction);
  if (!(cosine > 0)) return {};
  return {source.lighting->paths.beyond(at.point, direction), no_polygon, cosine, &source.sun->normal_irradiance};
}

// E G A
LightSample LightSource::sample_of(const OfFace& source, const SurfacePoint& at, const Eigen::Vector2d& uv) const {
  const Point place = source.points.at(uv.x(), uv.y());
  const Vector toward = place - at.point;
  const double cosine = at.normal.dot(toward);
  const double cosine_there = -source.face.normal.dot(toward);
  const double square = toward.squaredNorm();
  const double geometry =
      cosine > 0 && cosine_there > 0 ? cosine * cosine_there / (std::numbers::pi * square * square) : 0;
  return {place, source.face.polygon, geometry * source.face.area, &source.face.exitance};
}

LightSample LightSource::sample(const SurfacePoint& at, const Eigen::Vector2d& uv) const {
  return std::visit([&](const auto& source) { return sample_of(source, at, uv); }, of_);
}

std::optional<double> LightSource::unoccluded(const SurfacePoint& at) const {
  const auto* const of_face = std::get_if<OfFace>(&of_);
  if (of_face == nullptr) return std::nullopt;
  return form_factor_of(of_face->face, at);
}

double LightSource::possible_irradiance(const SurfacePoint& at) const {
  if (is_delta_) {
    const LightSample arriving = sample(at, {0.5, 0.5});
    return arriving.irradiance > 0 ? arriving.irradiance * arriving.color->mean() : 0;
  }
  if (const auto* const of_face = std::get_if<OfFace>(&of_))
    return possible_irradiance_of(of_face->face, extent_.ball, at);
  return possible_irradiance_of(*sphere_of(*std::get<OfLuminaire>(of_).luminaire), extent_.ball, at);
}

LightSampler::LightSampler(const Lighting& lighting, std::vector<EmitterFace> faces) : lighting_(&lighting) {
  std::uint32_t id = 1U << 31;
  for (const Luminaire& luminaire : lighting.luminaires) sources_.emplace_back(luminaire, lighting.up, id++);
  if (lighting.sun) sources_.emplace_back(lighting, *lighting.sun, id);
  without_faces_ = sources_.size();
  for (EmitterFace& face : faces) {
    const std::uint32_t of_polygon = face.polygon;
    sources_.emplace_back(std::move(face), of_polygon);
  }
}

void LightSampler::choose_among(bool are_delta, std::span<const double> weights, std::uint32_t rays, double u,
                                std::vector<SourceChoice>& chosen) const {
  constexpr std::size_t few_sources = 4;
  const std::uint32_t least = are_delta ? 1 : 2;
  std::vector<double> of_kind(weights.begin(), weights.end());
  double sum = 0;
  std::uint32_t lit_by = 0;
  for (std::size_t k = 0; k < of_kind.size(); ++k) {
    if (sources_[k].is_delta() != are_delta) of_kind[k] = 0;
    sum += of_kind[k];
    lit_by += of_kind[k] > 0 ? 1 : 0;
  }
  if (lit_by == 0) return;
  if (lit_by <= few_sources) {
    const std::uint32_t each = are_delta ? 1 : std::max(least, rays / lit_by);
    for (std::uint32_t k = 0; k < of_kind.size(); ++k)
      if (of_kind[k] > 0) chosen.push_back({k, each, 1});
    return;
  }
  const std::uint32_t count = std::max<std::uint32_t>(1, rays / least);
  for (const std::size_t k : choose_evenly(of_kind, sum, count, u))
    chosen.push_back({static_cast<std::uint32_t>(k), least, sum / (of_kind[k] * count)});
}

std::vector<SourceChoice> LightSampler::choose(const SurfacePoint& at, std::uint32_t rays, double u) const {
  std::vector<SourceChoice> chosen;
  std::vector<double> weights;
  weights.reserve(sources_.size());
  for (std::uint32_t k = 0; k < sources_.size(); ++k) {
    const double possible = sources_[k].possible_irradiance(at);
    const bool is_sun = sources_[k].extent().direction.has_value();
    if (is_sun && possible > 0) chosen.push_back({k, 1, 1});
    weights.push_back(is_sun ? 0 : possible);
  }
  for (const bool are_delta : {true, false}) choose_among(are_delta, weights, rays, u, chosen);
  return chosen;
}

}  // namespace patchlight
