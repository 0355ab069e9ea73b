// Polygons that overlap in one plane, e.g. a rug drawn on a floor, or the floors of two solids.
#include "patchlight/simulate.h"
#include "patchlight/transport/exchange.h"

#include "mesh/mesher.h"
#include "pipeline/form_factors.h"
#include "scene/coverings.h"
#include "support/diagnostics_of.h"
#include "support/scenes.h"
#include "verify/path_tracer.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <string>

namespace patchlight::overlapping_test {
namespace {

using namespace test;

Quad rectangle(double x0, double y0, double x1, double y1) {
  return {Point(x0, y0, 0), Point(x1, y0, 0), Point(x1, y1, 0), Point(x0, y1, 0)};
}

// Mean irradiance of walls and ceiling, polygons 1 to 5.
double mean_of_walls(const Scene& scene) {
  Request request;
  request.mesh.max_edge = 0.2;
  request.mesh.sides = Sides::front;
  const Simulation simulation = simulate(scene, request);
  double flux = 0;
  double area = 0;
  for (PolygonIndex wall = 1; wall < 6; ++wall) {
    const PatchRange range = simulation.mesh.patches_on(wall, Side::front);
    for (PatchIndex i = range.begin; i < range.end; ++i) {
      flux += simulation.mesh.area[i] * simulation.solution.irradiance(i, 0);
      area += simulation.mesh.area[i];
    }
  }
  return flux / area;
}

// Law: the order of faces in one plane does not depend on rounding. All upward directions are free from the rug,
// whether rounding moves its corners below or above the floor.
TEST(Overlapping, RoundingDoesNotDecideWhichFaceIsAbove) {
  const double extent = std::sqrt(4.0 * 4 + 3 * 3);
  for (const double share : {-2e-7, -2e-8, -2e-9, 0.0, 2e-9, 2e-8, 2e-7}) {
    const double z = share * extent;
    Scene scene = with_quad(empty_scene({grey(0.5)}), rectangle(0, 0, 4, 3));
    scene = with_quad(std::move(scene), {Point(1, 1, z), Point(2, 1, z), Point(2, 2, z), Point(1, 2, z)});
    const KeptSides kept = kept_sides(scene, Sides::front);
    const Occluder occluder(scene, Occluder::Blockers::all, find_coverings(scene, kept));
    ASSERT_TRUE(occluder.lies_over(1, 0, Side::front)) << share;
    for (const Vector& way : {Vector(0, 0, 1), Vector(0.9, 0.1, 0.4), Vector(-0.7, 0.7, 0.1)}) {
      const Ray ray{Point(1.5, 1.5, z), way.normalized(), 1};
      EXPECT_FALSE(occluder.first_hits({&ray, 1}).front().has_value()) << share;
      const Segment segment{ray.origin, ray.origin + 2 * ray.direction, 1};
      EXPECT_EQ(occluder.transmittance({&segment, 1}).front(), 1.0F) << share;
    }
  }
}

// Law: a black rug drawn on a floor of reflectance 0.7 equals a rug in a hole of the floor. The edges of the rug cross
// a few percent of the floor's patches, whose exposed fraction has an error of 1/32. This gives 0.5 % of the mean
// irradiance. If the floor under the rug were also lit, the walls would receive 10 % more.
TEST(Overlapping, ARugOnAFloorIsTheSameAsARugInIt) {
  Scene room = furnished_room(0.7);
  room.materials.push_back(grey(0));
  const MaterialIndex black = 2;
  const Scene drawn = with_quad(room, rectangle(0.7, 0.3, 2.9, 2.2), black);
  // The rug replaces the floor, polygon 0, and four pieces around it are added.
  Scene cut = drawn;
  cut.polygons.front() = cut.polygons.back();
  cut.polygons.pop_back();
  for (const Quad& piece :
       {rectangle(0, 0, 4, 0.3), rectangle(0, 2.2, 4, 3), rectangle(0, 0.3, 0.7, 2.2), rectangle(2.9, 0.3, 4, 2.2)}) {
    cut = with_quad(std::move(cut), piece);
  }
  const double expected = mean_of_walls(cut);
  EXPECT_NEAR(mean_of_walls(drawn), expected, 0.005 * expected);
}

// Before closure: if both layers were visible, the ceiling's row sums would be 1 plus the form factor to the rug, about
// 0.2. About 20 of the floor's 100 patches are partly covered. Each has a form factor of at most 1 % with a sampling
// error of at most a fifth, so 0.05 is five standard errors.
TEST(Overlapping, NothingIsSeenTwice) {
  const Scene scene =
      with_quad(cube_room(0.5, 0), {Point(0.2, 0.1, 0), Point(0.9, 0.1, 0), Point(0.9, 0.8, 0), Point(0.2, 0.8, 0)});
  const KeptSides kept = kept_sides(scene, Sides::front);
  const PatchMesh mesh = tessellate(scene, kept, 0.1);
  const Occluder occluder(scene, Occluder::Blockers::inside_hull, find_coverings(scene, kept));
  const Exchange exchange = trace_exchange(mesh, occluder, {});
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (exchange.lost.covered[i] < 1) {
      EXPECT_NEAR(exchange.raw_row_sum[i], 1, 0.05) << i;
    }
  }
  // Floor patches under the rug are excluded.
  double covered = 0;
  for (PatchIndex i = 0; i < mesh.size(); ++i) covered += mesh.area[i] * exchange.lost.covered[i];
  EXPECT_NEAR(covered, 0.7 * 0.7, 0.01);
}

// A lamp in the plane of the ceiling emits, whether it comes before or after the ceiling in the file. Rounding to
// single precision may move it 1e-7 m in front of the ceiling or behind it. All of its light, 10 W/m^2 over 0.25 m^2,
// arrives to within 1e-5: behind the ceiling, the exposed area comes from row sums, by quadrature. A wall receives the
// same in all six cases, up to sampling noise, as the samples depend on the places of patches.
TEST(Overlapping, ALampDrawnOnTheCeilingShines) {
  double first_flux = 0;
  for (const bool lamp_first : {false, true}) {
    for (const double height : {1.0, 1 - 1e-7, 1 + 1e-7}) {
      Scene scene = cube_room(0.5, 0);
      scene.materials.push_back(grey(0, 10));
      const double h = height;
      scene = with_quad(std::move(scene),
                        {Point(0.25, 0.25, h), Point(0.25, 0.75, h), Point(0.75, 0.75, h), Point(0.75, 0.25, h)}, 1);
      if (lamp_first) std::swap(scene.polygons.front(), scene.polygons.back());
      Request request;
      request.mesh.max_edge = 0.125;
      request.mesh.sides = Sides::front;
      const Simulation simulation = simulate(scene, request);
      EXPECT_NEAR(simulation.balance.emitted.sum(), 2.5, 2.5 * 1e-5);
      EXPECT_NEAR(simulation.balance.absorbed.sum(), 2.5, 2.5 * 1e-5);
      const PatchRange wall = simulation.mesh.patches_on(2, Side::front);
      double flux = 0;
      for (PatchIndex i = wall.begin; i < wall.end; ++i) {
        flux += simulation.mesh.area[i] * simulation.solution.irradiance(i, 0);
      }
      if (first_flux == 0) first_flux = flux;
      EXPECT_NEAR(flux, first_flux, 1e-3 * first_flux);
    }
  }
}

// The object on a floor without thickness.
enum class OnFloor { box, lamp_in_box };

constexpr double intensity = 10;  // W/sr

// A floor, polygon 0, with a luminaire above it and one below, and an object on it whose bottom is polygon 2. Without
// the small face far above, polygon 1, the floor's plane would be the center plane of the scene, where no coordinate is
// rounded.
Scene floor_between_luminaires(OnFloor what) {
  Scene scene = with_quad(empty_scene({grey(0.5), grey(0.5, 10)}), rectangle(0, 0, 4, 3));
  for (const double height : {-2.0, 2.0}) {
    Luminaire luminaire;
    luminaire.position = Point(2, 1.5, height);
    luminaire.light = PointLight{Spectrum::Constant(1, intensity)};
    scene.luminaires.push_back(luminaire);
  }
  Quad far_above = rectangle(0.1, 0.2, 0.3, 0.4);
  for (Point& corner : far_above) corner.z() = 31.7;
  scene = with_box(with_quad(std::move(scene), far_above), Point(1, 1, 0), Point(2, 1.8, 0.7), false);
  if (what == OnFloor::lamp_in_box) scene.polygons[2].material = 1;
  return scene;
}

// The solid angle of the floor, seen from 2 m below its middle, is four times that of a quarter with sides a and b at
// distance h: atan(a b / (h sqrt(a^2 + b^2 + h^2))). Only the lower luminaire lights this side.
double flux_from_below() { return intensity * 4 * std::atan(2 * 1.5 / (2 * std::sqrt(2 * 2 + 1.5 * 1.5 + 2 * 2))); }

// Patches on the underside of a polygon in the floor's plane: visible area in m^2, arriving flux in W, and highest
// irradiance.
struct Underside {
  double area = 0;
  double flux = 0;
  double highest = 0;
};

Underside underside_of(const Simulation& simulation, PolygonIndex polygon) {
  Underside found;
  for (PatchIndex i = 0; i < simulation.mesh.size(); ++i) {
    if (simulation.mesh.polygon[i] != polygon || simulation.mesh.normal[i].z() > 0) continue;
    found.area += simulation.problem.area[i];
    found.flux += simulation.problem.area[i] * simulation.solution.irradiance(i, 0);
    found.highest = std::max(found.highest, simulation.solution.irradiance(i, 0));
  }
  return found;
}

// The light of a point is integrated exactly over each patch; this is the relative rounding error.
constexpr double rounding = 1e-9;

Simulation simulated_finely(const Scene& scene) {
  Request request;
  request.mesh.max_edge = 0.25;
  return simulate(scene, request);
}

// Law: an object on a floor without thickness is invisible from below. The box hides none of the floor's underside, and
// the bottom of the box is dark.
TEST(Overlapping, ASolidThatStandsOnASheetIsNotLitFromBeyond) {
  const Simulation simulation = simulated_finely(floor_between_luminaires(OnFloor::box));
  EXPECT_NEAR(underside_of(simulation, 0).flux, flux_from_below(), rounding * flux_from_below());
  EXPECT_EQ(underside_of(simulation, 2).highest, 0);
}

// A recessed lamp is drawn on a ceiling without thickness. Nothing covers its 1 m by 0.8 m, both faces together receive
// the flux on the ceiling alone, and path tracing to the lamp agrees.
TEST(Overlapping, ALampLetIntoASheetIsInSight) {
  const Scene scene = floor_between_luminaires(OnFloor::lamp_in_box);
  const Simulation simulation = simulated_finely(scene);
  const Underside lamp = underside_of(simulation, 2);
  EXPECT_NEAR(underside_of(simulation, 0).flux + lamp.flux, flux_from_below(), rounding * flux_from_below());
  EXPECT_NEAR(lamp.area, 0.8, 1e-9);

  const std::vector<Point> corners = corner_points(scene, 2);
  const PathReceiver receiver{{corners[0], corners[1], corners[2], corners[3]}, 2, Side::front};
  const PathEstimate paths =
      trace_irradiance(scene, kept_sides(scene, Sides::automatic), {&receiver, 1}, {.paths = 4096});
  EXPECT_NEAR(lamp.flux / lamp.area, paths.irradiance(0, 0), 4 * paths.standard_error(0, 0));
}

// With rows of rays that were stored while the lamp was dark, it stays hidden, and a note names it.
TEST(Overlapping, ALampThatWasHiddenWhenRowsWereStoredIsNamed) {
  Request request;
  request.mesh.max_edge = 0.5;
  request.assembly.storage = Storage::rays;
  request.solver.solver = Solver::gmres;
  const RayFormFactors found = find_ray_form_factors(floor_between_luminaires(OnFloor::box), request);
  Steps with;
  with.ray_exchange = [&found](const PatchMesh&) { return found.exchange; };
  with.mesh = [&found] { return found.mesh; };
  const auto is_noted = [&](OnFloor what) {
    return has(simulate(floor_between_luminaires(what), request, {}, with).notes, DiagnosticCode::lost_light);
  };
  EXPECT_TRUE(is_noted(OnFloor::lamp_in_box));
  EXPECT_FALSE(is_noted(OnFloor::box));
}

}  // namespace
}  // namespace patchlight::overlapping_test
