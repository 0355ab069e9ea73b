#include "patchlight/base/error.h"
#include "patchlight/simulate.h"
#include "patchlight/views/picture.h"
#include "patchlight/views/views.h"

#include "base/parallel.h"
#include "form_factor/point_polygon.h"
#include "light/photometry.h"
#include "support/daylight_office.h"
#include "support/scenes.h"
#include "support/test_room.h"
#include "verify/path_tracer.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

// Final pictures against laws of light.
namespace patchlight::pictures_test {
namespace {

using namespace test;

constexpr double pi = std::numbers::pi;

Simulation solved(const Scene& scene, std::size_t patches, Storage storage = Storage::automatic) {
  Request request;
  request.mesh.patches = patches;
  request.assembly.storage = storage;
  if (storage == Storage::rays) request.solver.solver = Solver::gmres;
  return simulate(scene, request);
}

// A view of the test room from a corner.
Camera into_room() { return {Point(0.3, 0.3, 1.6), Point(3, 2.2, 0.9), 60}; }

PictureOptions final_options(const Camera& camera, int edge, double error = 0.02) {
  return {.camera = camera, .width = edge, .height = edge, .quality = PictureQuality::final, .error = error};
}

// Luminances of all pixels, cd/m^2.
Eigen::VectorXd luminances(const Picture& picture) {
  return luminous_efficacy * picture.radiance.pixels.col(0).matrix();
}

TEST(FinalPicture, OfAFurnaceHasTheSameRadianceEverywhere) {
  // B = E + rho B: B = E / (1 - rho) in a closed room of one material.
  const Scene scene = with_box(empty_scene({grey(0.5, 3)}), Point(0, 0, 0), Point(2, 1, 1), true);
  const Picture picture =
      take_picture(solved(scene, 600), final_options({Point(0.2, 0.4, 0.3), Point(2, 0.6, 0.6), 80}, 40));
  const Eigen::ArrayXd values = luminances(picture).array();
  const double expected = luminous_efficacy * 6 / pi;
  // Half a percent for the form factors of the solution.
  EXPECT_LT(((values - expected).abs() - 4 * picture.radiance.error.array()).maxCoeff(), 0.005 * expected);
  EXPECT_NEAR(values.mean(), expected, 0.005 * expected);
}

TEST(FinalPicture, IsLinearInTheEmission) {
  Scene scene = test_room(0.6);
  const Picture first = take_picture(solved(scene, 500), final_options(into_room(), 24));
  for (Material& material : scene.materials) material.exitance *= 4;
  const Picture second = take_picture(solved(scene, 500), final_options(into_room(), 24));
  // A power of two does not change the rounding of the picture, and the solver stops by relative errors.
  EXPECT_LT((second.radiance.pixels - 4 * first.radiance.pixels).abs().maxCoeff(),
            1e-5 * second.radiance.pixels.maxCoeff());
}

TEST(FinalPicture, HasTheSameBitsOnOneThreadAndOnTwo) {
  const Scene scene = test_room(0.5);
  const Simulation simulation = solved(scene, 400);
  const auto on = [&](int threads) {
    const ThreadLimit limit(threads);
    return take_picture(simulation, final_options(into_room(), 40));
  };
  const Picture one = on(1);
  const Picture two = on(2);
  EXPECT_TRUE((one.radiance.pixels == two.radiance.pixels).all());
  EXPECT_TRUE(one.radiance.error == two.radiance.error);
}

TEST(FinalPicture, HidesTheMesh) {
  const Scene scene = test_room(0.5);
  const Eigen::ArrayXd coarse =
      luminances(take_picture(solved(scene, 400), final_options(into_room(), 64, 0.01))).array();
  const Eigen::ArrayXd fine =
      luminances(take_picture(solved(scene, 6000), final_options(into_room(), 64, 0.01))).array();
  // Lamps are so much brighter than the rest that they would dominate the mean.
  const double mean = fine.min(2 * fine.mean()).mean();
  EXPECT_LT(std::sqrt((coarse - fine).square().mean()), 0.02 * mean);
}

TEST(FinalPicture, ErrorsCoverWhatSeedsDiffer) {
  const Scene scene = test_room(0.5);
  Simulation simulation = solved(scene, 400);
  constexpr int seeds = 12;
  std::vector<Picture> pictures;
  Eigen::ArrayXd mean = Eigen::ArrayXd::Zero(32 * 32);
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    simulation.plan.assembly.seed = seed;
    pictures.push_back(take_picture(simulation, final_options(into_room(), 32)));
    mean += luminances(pictures.back()).array() / seeds;
  }
  double beyond = 0;
  for (const Picture& picture : pictures) {
    const Eigen::ArrayXd error = picture.radiance.error.array();
    beyond += ((luminances(picture).array() - mean).abs() > 2 * error).cast<double>().mean() / seeds;
  }
  // One in twenty for a normal distribution; the errors are pooled from a few samples.
  EXPECT_LT(beyond, 0.1);
}

TEST(FinalPicture, OfAFisheyeIntegratesToTheIrradianceOfASensor) {
  Scene scene = test_room(0.5);
  const Sensor sensor{Point(2, 1.5, 0.2), Vector::UnitZ()};
  scene.sensors = {{"up", {sensor}}};
  const Simulation simulation = solved(scene, 2000);
  const double expected = read_sensors(simulation).readings.irradiance(0, 0);
  Camera camera{sensor.point, sensor.point + sensor.normal, 180};
  camera.projection = Projection::hemispherical;
  const Picture picture = take_picture(simulation, final_options(camera, 200));
  // E = int L cos dw is pi times the mean over the disc, whose area is pi / 4 of the picture.
  const double found = picture.radiance.pixels.col(0).mean() * 4;
  EXPECT_NEAR(found, expected, 0.01 * expected);
}

TEST(FinalPicture, OfAMirrorIsThatFromTheMirroredEye) {
  // A box with a lamp in the middle of its ceiling, and a mirror as its wall at x = 4.
  Scene scene = empty_scene({grey(0.5), grey(0.5, 10), grey(0)});
  scene.materials[2].specular_reflectance = Spectrum::Constant(1, 0.8);
  const std::vector<Quad> faces = box_faces(Point(0, 0, 0), Point(4, 3, 2.5), true);
  for (std::size_t face = 0; face < faces.size(); ++face)
    scene = with_quad(std::move(scene), faces[face], face == 3 ? 2 : 0);
  scene = with_quad(std::move(scene), {Point(1, 1, 2.4), Point(1, 2, 2.4), Point(2, 2, 2.4), Point(2, 1, 2.4)}, 1);
  const Simulation simulation = solved(scene, 800, Storage::rays);
  constexpr int edge = 48;
  const Point at(4, 1.5, 1.3);
  const Picture mirror = take_picture(simulation, final_options({Point(2.5, 1.5, 1.3), at, 40}, edge));
  const Picture behind = take_picture(simulation, final_options({Point(5.5, 1.5, 1.3), at, 40}, edge));
  const Eigen::VectorXd in_mirror = luminances(mirror);
  const Eigen::VectorXd straight = luminances(behind);
  double square = 0, errors = 0;
  for (Eigen::Index y = 0; y < edge; ++y) {
    for (Eigen::Index x = 0; x < edge; ++x) {
      const Eigen::Index a = y * edge + x;
      const Eigen::Index b = y * edge + edge - 1 - x;
      square += std::pow(in_mirror[a] - 0.8 * straight[b], 2);
      errors += std::pow(mirror.radiance.error[a], 2) + std::pow(0.8 * behind.radiance.error[b], 2);
    }
  }
  EXPECT_GT(straight.mean(), 0);
  // Values below a thousandth of the mean are rounding of paths.
  EXPECT_LT(std::sqrt(square), 1.5 * std::sqrt(errors) + 1e-3 * straight.mean() * edge);
}

TEST(FinalPicture, AgreesWithPathTracing) {
  const Scene scene = test_room(0.5);
  const Simulation simulation = solved(scene, 2000);
  // A square of the floor, seen by an orthographic camera that covers exactly the square.
  const std::array<Point, 4> square = {Point(1, 0.1, 0), Point(1.4, 0.1, 0), Point(1.4, 0.5, 0), Point(1, 0.5, 0)};
  Camera camera{Point(1.2, 0.3, 0.05), Point(1.2, 0.3, 0)};
  camera.projection = Projection::orthographic;
  camera.height = 0.4;
  const Picture picture = take_picture(simulation, final_options(camera, 32, 0.005));
  const PathReceiver receiver{square, 0, Side::front};
  const PathEstimate paths = trace_irradiance(scene, simulation.plan.sides, {&receiver, 1}, {.paths = 1 << 18});
  const double expected = 0.5 / pi * paths.irradiance(0, 0);
  EXPECT_NEAR(picture.radiance.pixels.col(0).mean(), expected, 0.01 * expected);
}

// A level square of a floor at z = 0, from just above it.
Camera above_floor(const Point& middle, double edge) {
  Camera camera{middle + Vector(0, 0, 0.05), middle};
  camera.projection = Projection::orthographic;
  camera.height = edge;
  return camera;
}

// Compares the irradiance of a floor of reflectance 0.5, from its pixels, with a function of the place. Pixels are
// weighted by their errors: the mean of squared difference over squared error is 1.
template <class Irradiance>
void expect_irradiance(const Picture& picture, const Irradiance& irradiance) {
  const Image& image = picture.radiance;
  const double step = picture.camera.height / image.height;
  double found = 0, expected = 0, square = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      // In pictures from above, y points up and x to the right.
      const Point place =
          picture.camera.target + step * Vector(x + 0.5 - 0.5 * image.width, 0.5 * image.height - y - 0.5, 0);
      const double wanted = 0.5 / pi * irradiance(place);
      const Eigen::Index k = static_cast<Eigen::Index>(y) * image.width + x;
      const double value = image.pixels(k, 0);
      found += value;
      expected += wanted;
      const double error = image.error[k] / luminous_efficacy + 1e-3 * wanted;
      square += std::pow((value - wanted) / error, 2) / static_cast<double>(image.pixels.rows());
    }
  }
  EXPECT_NEAR(found, expected, 0.003 * expected);
  // Errors are pooled from a few samples of a pixel and its neighbors.
  EXPECT_LT(square, 2);
}

// A floor of 4 x 4 m around the origin, seen from above.
Scene lonely_floor() {
  Scene scene = empty_scene({grey(0.5), grey(0, 10), grey(0)});
  return with_quad(std::move(scene), {Point(-2, -2, 0), Point(2, -2, 0), Point(2, 2, 0), Point(-2, 2, 0)});
}

TEST(FinalPicture, OfManyLampsHasTheirClosedForm) {
  Scene scene = lonely_floor();
  std::vector<Quad> lamps;
  for (int k = 0; k < 9; ++k) {
    const Point corner(k % 3 - 1.2, k / 3 - 1.1, 1 + 0.1 * k);
    lamps.push_back({corner, corner + Vector(0, 0.3, 0), corner + Vector(0.4, 0.3, 0), corner + Vector(0.4, 0, 0)});
    scene = with_quad(std::move(scene), lamps.back(), 1);
  }
  const Picture picture = take_picture(solved(scene, 300), final_options(above_floor({0.1, 0, 0}, 1.5), 48));
  expect_irradiance(picture, [&](const Point& place) {
    double sum = 0;
    for (const Quad& lamp : lamps) sum += 10 * point_to_polygon(place, Vector::UnitZ(), lamp);
    return sum;
  });
}

TEST(FinalPicture, OfManyLuminairesHasTheirClosedForm) {
  Scene scene = lonely_floor();
  for (int k = 0; k < 6; ++k) {
    Luminaire luminaire;
    luminaire.position = Point(std::cos(k), std::sin(k), 0.8 + 0.2 * k);
    luminaire.light = PointLight{Spectrum::Constant(1, 1 + k)};
    scene.luminaires.push_back(luminaire);
  }
  const Picture picture = take_picture(solved(scene, 300), final_options(above_floor({0.1, 0, 0}, 1.5), 48));
  // I cos / r^2 for each luminaire.
  expect_irradiance(picture, [&](const Point& place) {
    double sum = 0;
    for (int k = 0; k < 6; ++k) {
      const Vector way = scene.luminaires[static_cast<std::size_t>(k)].position - place;
      sum += (1 + k) * way.z() / std::pow(way.norm(), 3);
    }
    return sum;
  });
}

TEST(FinalPicture, ShowsShadowsOfTheSunAtTheirPlaces) {
  Scene scene = lonely_floor();
  scene = with_quad(std::move(scene),
                    {Point(-0.5, -0.5, 1), Point(0.5, -0.5, 1), Point(0.5, 0.5, 1), Point(-0.5, 0.5, 1)}, 2);
  const Vector to_sun = Vector(1, 0.5, 2).normalized();
  scene.sun = Sun{to_sun, Spectrum::Constant(1, 40)};
  const Picture picture = take_picture(solved(scene, 300), final_options(above_floor({-0.4, 0, 0}, 1.6), 80));
  const double step = 1.6 / 80;
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 80; ++x) {
      // The distance between the edge of the square and the ray to the sun at the height of the square, positive
      // outside.
      const Point place(-0.4 + step * (x + 0.5 - 40), step * (39.5 - y), 0);
      const double outside = std::max(std::abs(place.x() + 0.5), std::abs(place.y() + 0.25)) - 0.5;
      if (std::abs(outside) < step) continue;  // the edge lies within the pixel's filter
      const double expected = outside > 0 ? 0.5 / pi * 40 * to_sun.z() : 0;
      EXPECT_NEAR(picture.radiance.pixels(y * 80 + x, 0), expected, 1e-9) << x << ' ' << y;
    }
  }
}

// A black box of 3 x 3 x 2 m with a reflecting floor. The lid has a hole of 0.6 x 0.5 m.
Scene box_with_hole(Quad& hole) {
  Scene scene = empty_scene({grey(0.5), grey(0)});
  const std::vector<Quad> faces = box_faces(Point(-1.5, -1.5, 0), Point(1.5, 1.5, 2), true);
  for (std::size_t face = 0; face < faces.size(); ++face) {
    if (face != 1) scene = with_quad(std::move(scene), faces[face], face == 0 ? 0 : 1);
  }
  hole = {Point(0.2, 0.3, 2), Point(0.2, 0.8, 2), Point(0.8, 0.8, 2), Point(0.8, 0.3, 2)};
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t next = (k + 1) % 4;
    scene = with_quad(std::move(scene), {faces[1][k], faces[1][next], hole[next], hole[k]}, 1);
  }
  return scene;
}

TEST(FinalPicture, OfASkyThroughAHoleHasItsClosedForm) {
  Quad hole;
  Scene scene = box_with_hole(hole);
  Sky sky;
  sky.horizontal_irradiance = Spectrum::Constant(1, 50);
  scene.sky = sky;
  const Picture picture = take_picture(solved(scene, 300), final_options(above_floor({0.1, 0, 0}, 2), 48));
  // A uniform sky of radiance L gives pi L F, and 50 W/m^2 = pi L.
  expect_irradiance(picture, [&](const Point& place) { return 50 * point_to_polygon(place, Vector::UnitZ(), hole); });
}

TEST(FinalPicture, OfAnOfficeByDayAgreesWithPathTracing) {
  // Three squares: one of the floor near the pane and partly in the sun, one beside the desk, and one deep in the room.
  // The reference is path tracing to 4 x 4 pieces of each.
  const Scene scene = daylight_office();
  // The mesh of 4000 patches uses a part of the allowed percent.
  const Simulation simulation = solved(scene, 4000);
  for (const Point& middle : {Point(1.5, 0.8, 0), Point(2.9, 2.5, 0), Point(2, 4.5, 0)}) {
    constexpr int pieces = 4;
    const Picture picture = take_picture(simulation, final_options(above_floor(middle, 0.4), 32, 0.01));
    std::vector<PathReceiver> receivers;
    for (int k = 0; k < pieces * pieces; ++k) {
      const Point low = middle + Vector(-0.2 + 0.1 * (k % pieces), 0.1 - 0.1 * (k / pieces), 0);
      receivers.push_back(
          {{low, low + Vector(0.1, 0, 0), low + Vector(0.1, 0.1, 0), low + Vector(0, 0.1, 0)}, 0, Side::front});
    }
    const PathEstimate paths = trace_irradiance(scene, simulation.plan.sides, receivers, {.paths = 1 << 15});
    double square = 0, allowed = 0, found = 0, expected = 0;
    for (int k = 0; k < pieces * pieces; ++k) {
      double value = 0;
      for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 8; ++x)
          value += picture.radiance.pixels((8 * (k / pieces) + y) * 32 + 8 * (k % pieces) + x, 0) / 64;
      }
      const double wanted = 0.6 / pi * paths.irradiance(k, 0);
      found += value;
      expected += wanted;
      square += std::pow(value - wanted, 2);
      // The requested error of pixels, and three times that of paths.
      allowed += std::pow(0.01 * wanted, 2) + std::pow(3 * 0.6 / pi * paths.standard_error(k, 0), 2);
    }
    EXPECT_NEAR(found, expected, 0.01 * expected) << middle.transpose();
    EXPECT_LT(square, allowed) << middle.transpose();
  }
}

TEST(FinalPicture, OfAFisheyeByDayIntegratesToTheIrradianceOfASensor) {
  Scene scene = daylight_office();
  const Sensor sensor{Point(2, 2, 1.4), -Vector::UnitY()};
  scene.sensors = {{"to the pane", {sensor}}};
  scene.sun.reset();  // its disc is smaller than a pixel
  const Simulation simulation = solved(scene, 1500);
  const double expected = read_sensors(simulation).readings.irradiance(0, 0);
  Camera camera{sensor.point, sensor.point + sensor.normal, 180};
  camera.projection = Projection::hemispherical;
  const Picture picture = take_picture(simulation, final_options(camera, 200));
  // The luminaire is behind the sensor and does not light it.
  EXPECT_NEAR(picture.radiance.pixels.col(0).mean() * 4, expected, 0.01 * expected);
}

TEST(FinalPicture, HidesTheMeshByDay) {
  const Scene scene = daylight_office();
  const Camera camera{Point(3.7, 4.7, 1.6), Point(1, 1, 0.6), 60};
  const auto picture_by = [&](std::size_t patches) {
    return take_picture(solved(scene, patches), final_options(camera, 64, 0.01));
  };
  const Picture coarse = picture_by(400);
  const Picture fine = picture_by(6000);
  // Only pixels inside, as the sky would dominate the mean.
  const Eigen::ArrayXd inside = (coarse.radiance.outlook.array() < 0.01).cast<double>();
  const Eigen::ArrayXd a = luminances(coarse).array() * inside;
  const Eigen::ArrayXd b = luminances(fine).array() * inside;
  EXPECT_LT(std::sqrt((a - b).square().sum() / inside.sum()), 0.02 * b.sum() / inside.sum());
}

TEST(FinalPicture, ShowsSpheresThatEmit) {
  // A sphere of radius 0.3 and exitance M, 2 m in front of a black wall: parallel rays see a disc of radiance M / pi.
  Scene scene = empty_scene({grey(0)});
  scene = with_quad(std::move(scene), {Point(-9, 4, -9), Point(9, 4, -9), Point(9, 4, 9), Point(-9, 4, 9)});
  Luminaire lamp;
  lamp.position = Point(0, 2, 0);
  lamp.light = SphericalLamp{0.3, Spectrum::Constant(1, 5)};
  scene.luminaires = {lamp};
  Camera camera{Point(0, 0, 0), Point(0, 1, 0)};
  camera.projection = Projection::orthographic;
  camera.height = 1;
  const Simulation simulation = solved(scene, 50);
  for (const PictureQuality quality : {PictureQuality::draft, PictureQuality::final}) {
    PictureOptions options = final_options(camera, 64);
    options.quality = quality;
    const Picture picture = take_picture(simulation, options);
    EXPECT_NEAR(picture.radiance.pixels(32 * 64 + 32, 0), 5 / pi, 1e-9);
    EXPECT_EQ(picture.radiance.pixels(0, 0), 0);
    // The outline of length 2 pi 0.3 in 64 pixels is resolved to less than a tenth of a pixel.
    EXPECT_NEAR(picture.radiance.pixels.col(0).mean(), 0.09 * 5, 0.1 / 64 * 2 * pi * 0.3 * 5 / pi);
  }
}

TEST(FinalPicture, WithoutTimeIsCancelled) {
  const Scene scene = test_room(0.5);
  const Simulation simulation = solved(scene, 400);
  EXPECT_THROW(take_picture(simulation, final_options(into_room(), 40), [](const Progress&) { return false; }),
               Canceled);
}

// A room without its wall at low x, under a sky.
Scene room_with_an_open_end(double length) {
  Scene scene = empty_scene({grey(0.5)});
  const std::vector<Quad> faces = box_faces(Point(0, 0, 0), Point(length, 3, 2.7), true);
  for (std::size_t k = 0; k < 5; ++k) scene = with_quad(std::move(scene), faces[k]);
  scene.sky = Sky{};
  scene.sky->horizontal_irradiance = watts(20);
  return scene;
}

// By day the default view of such a room is from inside.
TEST(DefaultView, ByDayIsInsideARoomWithAnOpenEnd) {
  for (const double length : {7.0, 9.0}) {
    const Scene scene = room_with_an_open_end(length);
    const Point eye = take_picture(solved(scene, 300), {.width = 4, .height = 4}).camera.eye;
    EXPECT_TRUE(bounds(scene).contains(eye)) << eye.transpose();
  }
}

}  // namespace
}  // namespace patchlight::pictures_test
