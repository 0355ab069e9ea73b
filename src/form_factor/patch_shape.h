#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/mesh/patch_mesh.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// Unoccluded exchange area A_1 F_12 in m^2 of two planar convex polygons, which may touch, cross each other's plane,
/// or share an edge. Each faces the side from which its corners run counter-clockwise. The part behind the other's
/// plane is clipped first. Relative error: below 1e-6 for touching polygons of aspect up to 10, far less for separate
/// ones, below 1e-4 for those that cross each other's plane. Symmetric in its arguments up to these errors. Schröder
/// and Hanrahan 1993 give the closed form. This function evaluates Stokes' double contour integral (Sparrow 1963), the
/// inner integral exactly and the outer one by graded Gauss-Legendre quadrature;
/// docs/theory/unoccluded-form-factors.md.
double contour_exchange_area(std::span<const Point> first, std::span<const Point> second);

/// Points and weights that integrate over a patch; the weights in m^2 sum to its area.
template <int capacity>
struct Quadrature {
  std::array<double, capacity> x, y, z, weight;
  int count = 0;
};

/// The geometry of one patch for form factors.
struct PatchShape {
  PatchCorners corners;
  Point centroid;
  Vector normal;
  double area = 0;       ///< m^2
  double radius = 0;     ///< of the circle around the centroid that holds the corners, m
  Quadrature<4> coarse;  ///< exact for polynomials of degree 2 (triangle) or 3 (parallelogram)
  Quadrature<9> fine;    ///< of degree 4 or 5
};

/// The shape of one patch.
PatchShape patch_shape(const PatchMesh& mesh, PatchIndex patch);

/// The shape of a triangle or a planar convex quadrilateral, counter-clockwise from its front.
PatchShape patch_shape(const PatchCorners& corners);

/// The shapes of all patches.
std::vector<PatchShape> patch_shapes(const PatchMesh& mesh);

/// The relative orientation of two patches.
enum class Orientation {
  averted,    ///< at least one lies wholly behind the other, or both in one plane: the form factor is 0
  facing,     ///< each lies wholly before the other
  straddling  ///< facing in part: one crosses the other's plane
};

/// The relative orientation of two patches. Symmetric in its arguments.
Orientation orientation(const PatchShape& first, const PatchShape& second);

/// Patches closer than this many diameters of the larger one are near.
inline constexpr double near_diameters = 2;

/// Patches farther apart than this many diameters of the larger one use the quadrature of the lowest order.
inline constexpr double far_diameters = 4;

/// Heights below this share of the two radii count as zero: coplanar patches do not see each other.
inline constexpr double height_tolerance = 1e-7;

/// True for near patches: the geometry term varies too much for quadrature or area sampling.
bool is_near(const PatchShape& first, const PatchShape& second);

/// True for patches closer than one diameter of the larger one: even the visible part is sampled by solid angle.
bool is_adjacent(const PatchShape& first, const PatchShape& second);

/// The quadrature between patches more than far_diameters apart.
enum class FarRule { coarse, fine };

/// Unoccluded exchange area A_i F_ij in m^2 of two patches that are not averted: the contour integral for near patches,
/// product quadrature for others. Relative error below 3e-3, and 1e-3 where no cosine is below 0.1; a few per cent
/// where one patch barely rises over the other's plane, so that the form factor is below 1e-9.
double unoccluded_exchange_area(const PatchShape& first, const PatchShape& second, FarRule far = FarRule::coarse);

/// A key per patch that chooses its random points. It depends on the patch's position and orientation in a frame fixed
/// to the scene, by the scene's centroid, size and principal axes. So results do not change when the model is moved,
/// scaled or turned, or when its faces are reordered. If the model has a symmetry, the frame is ambiguous: turning it
/// may then change the keys, and the results within their statistical error.
std::vector<std::uint32_t> patch_keys(const PatchMesh& mesh);

}  // namespace patchlight
