#include "patchlight/simulate.h"
#include "patchlight/views/picture.h"
#include "patchlight/views/views.h"

#include "form_factor/point_polygon.h"
#include "light/photometry.h"
#include "render/light_samples.h"
#include "scene/photometric_web.h"
#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

// The view of an observer who stands in a room: glare and illuminance at the eye.
namespace patchlight::observers_test {
namespace {

using namespace test;

constexpr double pi = std::numbers::pi;

Simulation solved(const Scene& scene, std::size_t patches) {
  Request request;
  request.mesh.patches = patches;
  return simulate(scene, request);
}

TEST(Observers, HaveTheUnifiedGlareRatingOfCie117) {
  // A room of 6 x 4 x 3 m with two luminous squares of 0.6 m in its ceiling, 3,000 cd/m^2 each, seen from 1.2 m. The
  // reference computes omega of each square by its two triangles and p at its middle by Guth's formula. The background
  // is the illuminance at the eye less the squares' own: pi L F.
  Scene scene = empty_scene({grey(0.6), grey(0.6, 3000 * pi / luminous_efficacy)});
  scene = with_box(std::move(scene), Point(0, 0, 0), Point(6, 4, 3), true);
  std::vector<Quad> squares;
  for (const double x : {2.7, 4.4}) {
    const Point low(x, 1.7, 2.995);
    squares.push_back({low, low + Vector(0, 0.6, 0), low + Vector(0.6, 0.6, 0), low + Vector(0.6, 0, 0)});
    scene = with_quad(std::move(scene), squares.back(), 1);
  }
  const Camera camera{Point(0.5, 2, 1.2), Point(5, 2, 1.2), 50, "desk"};
  const Simulation simulation = solved(scene, 2000);
  const ObserverReading found = read_observers(simulation, {camera})[0];

  double sum = 0, from_squares = 0;
  for (const Quad& square : squares) {
    const double omega = SphericalTriangle(camera.eye, {square[0], square[1], square[2]}).solid_angle() +
                         SphericalTriangle(camera.eye, {square[0], square[2], square[3]}).solid_angle();
    const Vector way = ((square[0] + square[2]) / 2 - camera.eye).normalized();
    // The square is straight above the line of sight: tau = 0, so p = exp(33.98e-3 sigma + 21e-5 sigma^2).
    const double sigma = std::acos(way.x()) * 180 / pi;
    const double p = std::exp(33.98e-3 * sigma + 21e-5 * sigma * sigma);
    sum += 3000.0 * 3000 * omega / (p * p);
    from_squares += pi * 3000 * point_to_polygon(camera.eye, Vector::UnitX(), square);
  }
  const double background = (found.vertical_illuminance - from_squares) / pi;
  EXPECT_NEAR(found.background_luminance, background, 0.02 * background);
  EXPECT_NEAR(*found.unified_glare_rating, 8 * std::log10(0.25 / background * sum), 0.1);
}

TEST(Observers, HaveTheCylindricalIlluminanceOfAPointOfLight) {
  // Black walls: E_v = I cos(g) / d^2 at the altitude g toward the lamp. A plane turned by a gets cos(a) of it, if
  // positive. The mean over all a is 1 / pi.
  Scene scene = with_box(empty_scene({grey(0)}), Point(-5, -5, 0), Point(5, 5, 4), true);
  Luminaire lamp;
  lamp.position = Point(1.1, 2.3, 3.1);
  lamp.light = PointLight{Spectrum::Constant(1, 100 / luminous_efficacy)};
  scene.luminaires = {lamp};
  const Camera camera{Point(0, 0, 1.2), Point(1.1, 2.3, 1.2), 50, "desk"};
  const ObserverReading found = read_observers(solved(scene, 100), {camera})[0];
  const Vector way = lamp.position - camera.eye;
  const double vertical = 100 * std::hypot(way.x(), way.y()) / std::pow(way.norm(), 3);
  EXPECT_NEAR(found.vertical_illuminance, vertical, 1e-6 * vertical);
  EXPECT_NEAR(found.cylindrical_illuminance, vertical / pi, 0.01 * vertical / pi);
  EXPECT_FALSE(found.unified_glare_rating) << "it has no extent";
}

// Lambertian: I = 3000 cd/m^2 of 0.36 m^2 times the cosine.
std::shared_ptr<PhotometricWeb> glowing_square() {
  auto web = std::make_shared<PhotometricWeb>();
  web->horizontal = {0};
  for (int angle = 0; angle <= 90; ++angle) {
    web->vertical.push_back(angle);
    web->candela.push_back(3000 * 0.36 * std::cos(angle * pi / 180));
  }
  web->opening = Vector(0.6, 0.6, 0);
  return web;
}

TEST(Observers, SeeLuminairesAsTheirLuminousOpenings) {
  // The same room with measured luminaires instead of the squares, computed as in CIE 117: L = I / A_p, omega = A_p /
  // d^2, p at the middle. The direct E at the eye is I cos / d^2.
  Scene scene = with_box(empty_scene({grey(0.6)}), Point(0, 0, 0), Point(6, 4, 3), true);
  const Camera camera{Point(0.5, 2, 1.2), Point(5, 2, 1.2), 50, "desk"};
  double sum = 0, straight = 0;
  for (const double x : {3.0, 4.7}) {
    Luminaire lamp;
    lamp.position = Point(x, 2, 2.995);
    lamp.light = WebLight{glowing_square(), Spectrum::Constant(1, 1 / luminous_efficacy)};
    scene.luminaires.push_back(lamp);
    const Vector way = lamp.position - camera.eye;
    const double distance = way.norm();
    const double area = 0.36 * way.z() / distance;
    const double intensity = 3000 * area;
    const double sigma = std::acos(way.x() / distance) * 180 / pi;
    const double p = std::exp(33.98e-3 * sigma + 21e-5 * sigma * sigma);
    sum += std::pow(intensity / area / p, 2) * area / (distance * distance);
    straight += intensity * way.x() / std::pow(distance, 3);
  }
  const ObserverReading found = read_observers(solved(scene, 2000), {camera})[0];
  const double background = (found.vertical_illuminance - straight) / pi;
  EXPECT_NEAR(found.background_luminance, background, 0.02 * background);
  EXPECT_NEAR(*found.unified_glare_rating, 8 * std::log10(0.25 / background * sum), 0.1);

  // A board in front of one luminaire leaves the other alone visible.
  Scene behind = scene;
  behind = with_quad(std::move(behind), {Point(2, 1, 2.9), Point(2, 3, 2.9), Point(3.6, 3, 2.9), Point(3.6, 1, 2.9)});
  const ObserverReading half = read_observers(solved(behind, 2000), {camera})[0];
  EXPECT_NEAR(
      half.glare_solid_angle,
      found.glare_solid_angle * 0.36 * 1.795 / std::pow(std::hypot(4.2, 1.795), 3) /
          (0.36 * 1.795 / std::pow(std::hypot(4.2, 1.795), 3) + 0.36 * 1.795 / std::pow(std::hypot(2.5, 1.795), 3)),
      1e-6);
}

TEST(DefaultView, StandsInsideTheRoomWithMostLight) {
  // Two closed rooms side by side. The lamp hangs in either, and the other room is larger.
  for (const double lamp_x : {2.0, 9.0}) {
    Scene scene = with_box(empty_scene({grey(0.5), grey(0, 10)}), Point(0, 0, 0), Point(4, 3, 2.5), true);
    scene = with_box(std::move(scene), Point(6, 0, 0), Point(12, 5, 3), true);
    const Point low(lamp_x, 1.2, 2.2);
    scene = with_quad(std::move(scene),
                      {low, low + Vector(0, 0.6, 0), low + Vector(0.6, 0.6, 0), low + Vector(0.6, 0, 0)}, 1);
    const Picture picture = take_picture(solved(scene, 300), {.width = 16, .height = 16});
    const Box room = lamp_x < 5 ? Box(Point(0, 0, 0), Point(4, 3, 2.5)) : Box(Point(6, 0, 0), Point(12, 5, 3));
    EXPECT_TRUE(room.contains(picture.camera.eye)) << picture.camera.eye.transpose();
    EXPECT_GT(picture.radiance.pixels.minCoeff(), 0) << "every pixel shows a lit surface";
  }
}

}  // namespace
}  // namespace patchlight::observers_test
