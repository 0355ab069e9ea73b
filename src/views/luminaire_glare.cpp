#include "views/luminaire_glare.h"

#include "light/photometry.h"
#include "lighting/lighting.h"

#include <array>
#include <cmath>
#include <numbers>
#include <variant>

namespace patchlight {
namespace {

// Parts of an opening across and along it, whose middles the eye sees or not.
constexpr int parts = 4;

constexpr double quarter_pi = std::numbers::pi / 4;

constexpr double square(double x) { return x * x; }

using PartsSeen = std::array<Segment, static_cast<std::size_t>(parts) * parts>;

PartsSeen ways_to_parts(const Luminaire& luminaire, const PhotometricWeb& web, const Point& eye) {
  const Vector side = luminaire.zero_plane.cross(luminaire.aim);
  PartsSeen ways;
  for (int row = 0; row < parts; ++row) {
    for (int column = 0; column < parts; ++column) {
      const double across = ((row + 0.5) / parts - 0.5) * web.opening[0];
      const double along = ((column + 0.5) / parts - 0.5) * web.opening[1];
      ways[static_cast<std::size_t>(row * parts + column)] = {
          eye, luminaire.position + across * side + along * luminaire.zero_plane};
    }
  }
  return ways;
}

}  // namespace

double projected_opening(const PhotometricWeb& web, const LuminaireFrame& frame, const Vector& direction) {
  // Width, length and height, and the cosines between the direction and each.
  const Vector& sizes = web.opening;
  const Vector cosines = Vector(direction.dot(frame.zero_plane.cross(frame.aim)), direction.dot(frame.zero_plane),
                                direction.dot(frame.aim))
                             .cwiseAbs();
  // Of the ends of an elliptical cylinder along an axis, and the band of its side.
  const auto of_cylinder = [&](int axis) {
    const int p = (axis + 1) % 3, q = (axis + 2) % 3;
    return quarter_pi * sizes[p] * sizes[q] * cosines[axis] +
           sizes[axis] * std::hypot(sizes[p] * cosines[q], sizes[q] * cosines[p]);
  };
  const Vector faces(sizes[1] * sizes[2] * cosines[0], sizes[0] * sizes[2] * cosines[1],
                     sizes[0] * sizes[1] * cosines[2]);
  switch (web.shape) {
    case OpeningShape::box:
      return faces.sum();
    case OpeningShape::upright_cylinder:
      return of_cylinder(2);
    case OpeningShape::cylinder_by_length:
      return of_cylinder(1);
    case OpeningShape::cylinder_by_width:
      return of_cylinder(0);
    case OpeningShape::ellipsoid:
      return quarter_pi * faces.norm();
  }
  return 0;
}

std::vector<GlareSource> luminaire_glare(const Scene& scene, const Occluder& faces, const Point& eye,
                                         const Vector& forward, const Vector& upward) {
  const Bands bands = bands_of(scene);
  std::vector<GlareSource> sources;
  for (const Luminaire& luminaire : scene.luminaires) {
    const WebLight* const light = std::get_if<WebLight>(&luminaire.light);
    const Vector way = luminaire.position - eye;
    const double distance = way.norm();
    if (!light || !(way.dot(forward) > 0)) continue;
    const Vector towards = way / distance;
    const double area = projected_opening(*light->web, {luminaire.aim, luminaire.zero_plane}, towards);
    const Arrival arrival = from_luminaire(luminaire, scene.up, {eye, towards}, Eigen::Vector2d::Zero());
    if (!(area > 0 && arrival.irradiance > 0)) continue;
    // I = E d^2 of a plane that faces the luminaire
    const Spectrum intensity = arrival.irradiance * square(distance) * *arrival.colour;
    const double average = luminance(Spectrum(intensity / area), bands);
    const double solid_angle = area / square(distance) / (parts * parts);
    const PartsSeen ways = ways_to_parts(luminaire, *light->web, eye);
    const std::vector<float> seen = faces.transmittance(ways);
    for (std::size_t k = 0; k < ways.size(); ++k) {
      const Vector direction = (ways[k].to - eye).normalized();
      if (seen[k] > 0) sources.push_back({seen[k] * average, solid_angle, position_index(direction, forward, upward)});
    }
  }
  return sources;
}

}  // namespace patchlight
