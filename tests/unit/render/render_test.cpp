#include "render/render.h"

#include "patchlight/base/error.h"

#include "base/parallel.h"
#include "mesh/interpolate.h"
#include "quad_scene.h"
#include "scene/photometric_web.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

namespace patchlight::render_test {
namespace {

// A square of edge 1 around `centre` in the plane `y = centre.y`, whose front faces -y.
Quad upright_square(const Point& centre) {
  return {centre + Point(-0.5, 0, -0.5), centre + Point(0.5, 0, -0.5), centre + Point(0.5, 0, 0.5),
          centre + Point(-0.5, 0, 0.5)};
}

// A camera along +y. In the image x is to the right and z upward.
Camera camera_along_y(double field_of_view) { return {Point(0, 0, 0), Point(0, 1, 0), field_of_view}; }

Image picture_of(const Scene& scene, const FieldView& radiance, const Camera& camera, const RenderOptions& options,
                 const Vector& up = Vector::UnitZ()) {
  const PatchMesh mesh = front_patches(scene);
  const Eigen::VectorXd area = Eigen::Map<const Eigen::VectorXd>(mesh.area.data(), mesh.size());
  Scene of_bands = scene;
  for (Material& material : of_bands.materials)
    material.reflectance = material.exitance = Spectrum::Zero(radiance.cols());
  const Occluder occluder(of_bands);
  return render(mesh, smooth(mesh, radiance, area, occluder), occluder, occluder.optics(), camera, up, options);
}

// A sheet with holes between the camera and a square colors its image, per band by its transmittance. So does its back,
// which has no patches.
TEST(Render, APaneColorsTheLightBehindIt) {
  for (const bool is_turned : {false, true}) {
    Scene scene = quad_scene({upright_square({0, 2, 0}), upright_square({0, 1, 0})});
    Material pane = scene.materials[0];
    pane.reflectance = Spectrum::Zero(3);
    pane.transmittance = Eigen::Array3d(0.8, 0.4, 0.1).transpose();
    pane.index = 1;
    scene.materials.push_back(pane);
    scene.polygons[1].material = 1;
    if (is_turned) std::reverse(scene.polygons[1].corners.begin(), scene.polygons[1].corners.end());
    Field radiance = Field::Zero(2, 3);
    radiance.row(0).setConstant(5);
    const Image image = picture_of(scene, radiance, camera_along_y(10), {.width = 4, .height = 4});
    for (Eigen::Index pixel = 0; pixel < image.pixels.rows(); ++pixel)
      EXPECT_LT((image.pixels.row(pixel) - 5 * pane.transmittance).abs().maxCoeff(), 1e-12) << is_turned;
  }
}

// The area in pixels of a quadrilateral's image under y-axis perspective, by the shoelace formula.
double projected_area(const Quad& quad, double field_of_view, int height) {
  const double pixels_per_unit = 0.5 * height / std::tan(field_of_view * std::numbers::pi / 360);
  double twice_area = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const Point& a = quad[k];
    const Point& b = quad[(k + 1) % 4];
    twice_area += (a.x() * b.z() - b.x() * a.z()) / (a.y() * b.y());
  }
  return 0.5 * std::abs(twice_area) * pixels_per_unit * pixels_per_unit;
}

TEST(Render, ASquareSeenFromTheFrontFillsItsProjectedArea) {
  const Quad square = upright_square({0.1, 2, 0.05});
  const Scene scene = quad_scene({square});
  const RenderOptions options{.width = 160, .height = 120, .rays_per_pixel_edge = 3};
  const Image image = picture_of(scene, Field::Constant(1, 1, 7), camera_along_y(50), options);
  ASSERT_EQ(image.pixels.rows(), 160 * 120);
  const double expected = projected_area(square, 50, 120);
  // A vertical or horizontal edge is resolved in n^2 = 9 steps of a pixel: the error of each of the four is at most
  // half a step.
  const double tolerance = 4 * std::sqrt(expected) * 0.5 / 9;
  EXPECT_NEAR(image.pixels.sum() / 7, expected, tolerance);
  // No pixel is brighter than the square.
  EXPECT_NEAR(image.pixels.maxCoeff(), 7, 1e-12);
}

TEST(Render, ATiltedSquareFillsItsProjectedArea) {
  Quad square = upright_square({0, 0, 0});
  const Eigen::Matrix3d rotation =
      (Eigen::AngleAxisd(0.9, Vector::UnitZ()) * Eigen::AngleAxisd(0.6, Vector::UnitX())).toRotationMatrix();
  for (Point& corner : square) corner = rotation * corner + Point(0.3, 2, -0.2);
  const Scene scene = quad_scene({square});
  const RenderOptions options{.width = 200, .height = 200, .rays_per_pixel_edge = 3};
  const Image image = picture_of(scene, Field::Constant(1, 1, 1), camera_along_y(60), options);
  const double expected = projected_area(square, 60, 200);
  ASSERT_GT(expected, 1500);
  // The outline crosses at most 3/2 * perimeter * n of the n^2 cells per pixel. Each has an average error of half a
  // cell of 1/n^2. Their signs alternate along an edge, so a fifth of the total is a generous limit.
  const double perimeter = 4 * std::sqrt(expected);
  EXPECT_NEAR(image.pixels.sum(), expected, 0.2 * 1.5 * perimeter * 0.5 / 3);
}

TEST(Render, PixelsGoFromTheUpperLeft) {
  // One bright square on the right, a darker one above.
  const Scene scene = quad_scene({upright_square({1.5, 4, 0}), upright_square({0, 4, 1.5})});
  Field radiance(2, 1);
  radiance << 3, 1;
  const RenderOptions options{.width = 90, .height = 90, .rays_per_pixel_edge = 2};
  const Image image = picture_of(scene, radiance, camera_along_y(60), options);
  const auto pixel = [&](int x, int y) { return image.pixels(y * 90 + x, 0); };
  // 1.5 m at a distance of 4 m is 45 * 0.375 / tan(30 deg) = 29 pixels from the center.
  EXPECT_NEAR(pixel(45 + 29, 45), 3, 1e-12);
  EXPECT_NEAR(pixel(45, 45 - 29), 1, 1e-12);
  EXPECT_EQ(pixel(45 - 29, 45), 0);
  EXPECT_EQ(pixel(45, 45 + 29), 0);
}

TEST(Render, SidesWithoutPatchesAreTransparent) {
  // Two back sides stand before the far square. From the other end the nearest front side hides everything.
  Quad reversed = upright_square({0, 1, 0});
  std::swap(reversed[1], reversed[3]);
  Quad second = upright_square({0, 1.5, 0});
  std::swap(second[1], second[3]);
  const Scene scene = quad_scene({reversed, second, upright_square({0, 2, 0})});
  Field radiance(3, 1);
  radiance << 1, 2, 3;
  const RenderOptions options{.width = 21, .height = 21, .rays_per_pixel_edge = 1};
  const Image image = picture_of(scene, radiance, camera_along_y(20), options);
  EXPECT_NEAR(image.pixels(10 * 21 + 10, 0), 3, 1e-12);

  const Camera from_behind{Point(0, 4, 0), Point(0, 0, 0), 20};
  EXPECT_NEAR(picture_of(scene, radiance, from_behind, options).pixels(10 * 21 + 10, 0), 2, 1e-12);
}

// Three walls of a room with different brightness, moved and rotated together with the camera.
TEST(Render, IsInvariantUnderRigidMotion) {
  const std::vector<Quad> room = inner_sides({0, 0, 0}, {4, 3, 2.5});
  const Camera camera{Point(0.5, 0.4, 1.6), Point(3, 2.5, 1), 70};
  Field radiance(6, 3);
  for (int k = 0; k < 6; ++k) radiance.row(k) << k + 1.0, 2.0, 6.0 - k;
  const RenderOptions options{.width = 80, .height = 60, .rays_per_pixel_edge = 2};
  const Image image = picture_of(quad_scene(room), radiance, camera, options);

  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(1.1, Vector(1, 2, -0.5).normalized()).toRotationMatrix();
  const Vector shift(10, -20, 5);
  std::vector<Quad> moved = room;
  for (Quad& quad : moved) {
    for (Point& corner : quad) corner = rotation * corner + shift;
  }
  const Camera moved_camera{rotation * camera.eye + shift, rotation * camera.target + shift,
                            camera.vertical_field_of_view};
  const Image moved_image = picture_of(quad_scene(moved), radiance, moved_camera, options, rotation * Vector::UnitZ());
  // Rays are traced in single precision: only those within about 1e-6 of an edge may change sides.
  int different = 0;
  for (Eigen::Index k = 0; k < image.pixels.rows(); ++k) {
    if ((image.pixels.row(k) - moved_image.pixels.row(k)).abs().maxCoeff() > 1e-9) ++different;
  }
  EXPECT_LE(different, 2);
  EXPECT_GT(image.pixels.minCoeff(), 0.9);  // a closed room has no opening
}

TEST(Render, GivesTheSameBitsForAnyNumberOfThreads) {
  const Scene scene = quad_scene(inner_sides({0, 0, 0}, {4, 3, 2.5}));
  Field radiance(6, 3);
  for (int k = 0; k < 6; ++k) radiance.row(k) << k + 1.0, 2.0, 6.0 - k;
  const Camera camera{Point(0.5, 0.4, 1.6), Point(3, 2.5, 1), 70};
  const RenderOptions options{.width = 100, .height = 70, .rays_per_pixel_edge = 2};
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return picture_of(scene, radiance, camera, options);
  };
  EXPECT_TRUE((with_threads(1).pixels == with_threads(2).pixels).all());
}

TEST(Render, RefusesImpossibleCameras) {
  const Scene scene = quad_scene({upright_square({0, 2, 0})});
  const Field radiance = Field::Constant(1, 1, 1);
  const Point eye(0, 0, 0);
  EXPECT_THROW(picture_of(scene, radiance, {eye, eye, 50}, {}), InputError);
  EXPECT_THROW(picture_of(scene, radiance, {eye, Point(0, 1, 0), 0}, {}), InputError);
  EXPECT_THROW(picture_of(scene, radiance, {eye, Point(0, 1, 0), 180}, {}), InputError);
}

TEST(Render, LooksStraightUp) {
  const Scene scene = quad_scene({{Point(-1, -1, 2), Point(-1, 1, 2), Point(1, 1, 2), Point(1, -1, 2)}});
  const RenderOptions options{.width = 11, .height = 11, .rays_per_pixel_edge = 1};
  const Camera camera{Point(0, 0, 0), Point(0, 0, 1), 30};
  EXPECT_NEAR(picture_of(scene, Field::Constant(1, 1, 1), camera, options).pixels.minCoeff(), 1, 1e-12);
}

TEST(Render, ASphericalLuminaireHasItsExitanceOverPi) {
  const Scene scene = quad_scene({upright_square({0, 9, 0})});
  const Luminaire globe{.name = "globe", .place = "", .position = {0, 3, 0}, .light = SphericalLamp{0.4, rgb(2, 3, 5)}};
  const RenderOptions options{.width = 21, .height = 21, .luminaires = seen_luminaires({globe}, Vector::UnitZ())};
  const Image image = picture_of(scene, Field::Zero(1, 3), camera_along_y(10), options);
  for (Eigen::Index band = 0; band < 3; ++band)
    EXPECT_NEAR(image.pixels(10 * 21 + 10, band), rgb(2, 3, 5)[band] / std::numbers::pi, 1e-12);
}

// An IES luminaire whose intensity depends on both angles and is 0 above 120 degrees from its aim.
Luminaire web_luminaire(OpeningShape shape, const Vector& opening) {
  PhotometricWeb web;
  web.vertical = {0, 60, 120};
  web.horizontal = {0, 90};
  web.candela = {400, 300, 100, 400, 200, 50};
  web.opening = opening;
  web.shape = shape;
  const Vector aim = Vector(0.3, 0.2, -1).normalized();
  return {.name = "panel",
          .place = "",
          .position = {0.1, 0.2, 0.3},
          .aim = aim,
          .zero_plane = aim.unitOrthogonal(),
          .light = WebLight{std::make_shared<const PhotometricWeb>(web), rgb(1, 2, 3) / 179}};
}

// A picture of a luminaire alone from a direction, by parallel rays.
Image parallel_view(const Luminaire& luminaire, const Vector& direction, int edge, double height) {
  const Scene scene = quad_scene({upright_square({0, 90, 0})});
  const Point eye = luminaire.position + 5 * direction;
  const Camera camera{.eye = eye,
                      .target = luminaire.position,
                      .vertical_field_of_view = 50,
                      .projection = Projection::orthographic,
                      .height = height};
  const RenderOptions options{
      .width = edge, .height = edge, .luminaires = seen_luminaires({luminaire}, Vector::UnitZ())};
  return picture_of(scene, Field::Zero(1, 3), camera, options);
}

// I = integral of L over the projected area.
TEST(Render, AnOpeningSendsItsIntensityInEachDirection) {
  using enum OpeningShape;
  const std::vector<std::pair<OpeningShape, Vector>> openings = {{box, {0.6, 1.2, 0}},
                                                                 {box, {0.6, 1.2, 0.3}},
                                                                 {upright_cylinder, {0.5, 0.5, 0}},
                                                                 {ellipsoid, {1, 1, 1}},
                                                                 {upright_cylinder, {0.5, 1, 0.4}},
                                                                 {cylinder_by_length, {0.2, 1.2, 0.3}},
                                                                 {cylinder_by_width, {1.2, 0.2, 0.3}}};
  for (const auto& [shape, opening] : openings) {
    const Luminaire luminaire = web_luminaire(shape, opening);
    const WebLight& light = std::get<WebLight>(luminaire.light);
    for (const Vector& direction : {Vector(0.1, 0.2, -1), Vector(1, 0.3, -0.4), Vector(-0.2, -1, 0.1)}) {
      const Vector towards = direction.normalized();
      const double candelas = candela(*light.web, {luminaire.aim, luminaire.zero_plane}, towards);
      const Image image = parallel_view(luminaire, towards, 200, 2);
      for (Eigen::Index band = 0; band < 3; ++band) {
        const double intensity = image.pixels.col(band).sum() * (2.0 / 200) * (2.0 / 200);
        EXPECT_NEAR(intensity, candelas * light.watts_per_lumen[band], 0.01 * intensity);
      }
    }
  }
}

TEST(Render, AnOpeningIsSeenOnlyWhereItShines) {
  const Luminaire panel = web_luminaire(OpeningShape::box, {0.6, 0.6, 0});
  const Scene scene = quad_scene({upright_square({0, 5, 0})});
  Luminaire turned = panel;
  turned.position = {0, 2, 0};
  turned.zero_plane = Vector::UnitX();
  for (const double away : {1.0, -1.0}) {
    turned.aim = away * Vector::UnitY();
    const RenderOptions options{.width = 21, .height = 21, .luminaires = seen_luminaires({turned}, Vector::UnitZ())};
    const Image image = picture_of(scene, Field::Constant(1, 3, 7), camera_along_y(10), options);
    // 400 cd from 0.36 m^2, less by 1.7 cd per degree from the axis, or the square behind
    EXPECT_NEAR(image.pixels(10 * 21 + 10, 0), away > 0 ? 7 : 400 / 179.0 / 0.36, 0.01);
  }
}

TEST(Render, LuminairesWithoutASizeAreNotSeen) {
  Luminaire lamp = web_luminaire(OpeningShape::box, Vector::Zero());
  const Image of_web = parallel_view(lamp, -Vector::UnitZ(), 21, 1e-3);
  lamp.light = PointLight{rgb(1, 1, 1)};
  const Image of_point = parallel_view(lamp, -Vector::UnitZ(), 21, 1e-3);
  EXPECT_EQ(of_web.pixels.sum() + of_point.pixels.sum(), 0);
}

TEST(Render, CanBeCancelled) {
  const Scene scene = quad_scene({upright_square({0, 2, 0})});
  const Observer stop = [](const Progress& progress) {
    EXPECT_EQ(progress.stage, Stage::render);
    return false;
  };
  const Occluder occluder(scene);
  EXPECT_THROW(render(front_patches(scene), {Field::Constant(4, number_of_bands(scene), 1), CornerWeights::Ones(1, 4)},
                      occluder, occluder.optics(), camera_along_y(50), Vector::UnitZ(), {}, stop),
               Canceled);
}

// A box of 2 x 2 x 2 m, y up, without the side at z = 0, and a block in it. The view is through the opening.
TEST(DefaultCamera, LooksThroughTheOpenSide) {
  std::vector<Quad> quads = inner_sides({0, 0, 0}, {2, 2, 2});
  quads.erase(quads.begin() + 4);
  for (Quad block : inner_sides({0.5, 0, 0.8}, {1, 1, 1.3})) {
    std::swap(block[1], block[3]);  // outward
    quads.push_back(block);
  }
  Scene scene = quad_scene(quads);
  scene.up = Vector::UnitY();
  // With the outer sides of the walls, more is visible from outside, but no view is better.
  KeptSides both = front_sides(scene);
  both.back.assign(scene.polygons.size(), 1);
  for (const KeptSides& sides : {front_sides(scene), both}) {
    const Camera camera = default_camera(scene, sides, Occluder(scene));
    EXPECT_NEAR(camera.eye.x(), 1, 1e-12);
    EXPECT_NEAR(camera.eye.y(), 1, 1e-12);
    EXPECT_LT(camera.eye.z(), -0.8 * 2);
    EXPECT_GT(camera.eye.z(), -1.4 * 2);
    EXPECT_GT((camera.target - camera.eye).normalized().z(), 0.999);
    // The opening fits into the image: half its height at its distance.
    const double half_angle = camera.vertical_field_of_view * std::numbers::pi / 360;
    EXPECT_GT(-camera.eye.z() * std::tan(half_angle), 1);
    EXPECT_LT(-camera.eye.z() * std::tan(half_angle), 1.2);
  }
}

TEST(DefaultCamera, StandsInACornerOfAClosedRoom) {
  const Scene scene = quad_scene(inner_sides({0, 0, 0}, {5, 4, 2.7}));
  const Camera camera = default_camera(scene, front_sides(scene), Occluder(scene));
  EXPECT_TRUE(bounds(scene).contains(camera.eye));
  EXPECT_NEAR(camera.eye.z(), 1.6, 0.2);  // eye height
  // From one end of the diagonal towards the other.
  const Vector from_centre = camera.eye - Point(2.5, 2, camera.eye.z());
  EXPECT_GT(std::abs(from_centre.x()), 0.3 * 5);
  EXPECT_GT(std::abs(from_centre.y()), 0.3 * 4);
  EXPECT_LT((camera.target - camera.eye).dot(from_centre), 0);
}

TEST(DefaultCamera, SeesALonelyFloor) {
  const Scene scene = quad_scene({{Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)}});
  const Camera camera = default_camera(scene, front_sides(scene), Occluder(scene));
  const RenderOptions options{.width = 20, .height = 20, .rays_per_pixel_edge = 1};
  EXPECT_GT(picture_of(scene, Field::Constant(1, 1, 1), camera, options).pixels.sum(), 20);
}

}  // namespace
}  // namespace patchlight::render_test
