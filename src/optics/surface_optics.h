#pragma once

#include "patchlight/scene/scene.h"

#include "light/pane.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace patchlight {

/// The absolute cosine of the angle between a unit normal and a unit direction.
double cosine_between(const Vector& normal, const Vector& direction);

/// Whether a face keeps the light that it reflects as a mirror does, or that light goes on.
enum class Reflections : bool { kept, followed };

/// The shares of light that meets a specular face at an angle.
struct SpecularShares {
  double transmitted = 0;
  double mirrored = 0;
  double held = 1;           ///< to be absorbed or scattered
  double relative_held = 1;  ///< over that of light from all directions alike
};

/// A clear polygon or a mirror as light between patches meets it: one number for all bands, weighted as luminance is.
/// A clear one transmits and reflects the same both ways, the mean of its two sides; each side of a mirror
/// has a reflectance of its own, 0 if it is none. Cosines are those of the angle to its normal, in [0, 1].
class SpecularSurface {
 public:
  /// `polygon` must be an opening, see is_opening(), or have a mirror side, see is_mirror().
  SpecularSurface(const Scene& scene, PolygonIndex polygon, Reflections reflections = Reflections::kept);

  /// The share that goes straight through.
  double transmittance(double cosine) const;

  /// The share that goes on as from a mirror: 0 where reflections are not followed.
  double reflectance(Side side, double cosine) const;

  /// The share that a side keeps of light from all directions alike, weighted as irradiance is.
  double held(Side side) const;

  /// The share that is kept at an angle, over held(): its mean over the hemisphere, weighted as irradiance is, is 1.
  double relative_held(double cosine) const;

  /// All of these.
  SpecularShares shares(Side side, double cosine) const;

  /// The same two fractions of light that meets a side, per band, by the material of this side.
  Spectrum spectral_transmittance(Side side, double cosine) const;
  Spectrum spectral_reflectance(Side side, double cosine) const;

  /// With which probability a ray that follows light is mirrored rather than let through: the reflectance of a pane of
  /// the index of refraction that absorbs nothing, so that it is of the geometry and not of the color; 1 of a side
  /// that is a mirror, 0 where clear ones keep their reflections.
  double mirrored_rays(Side side, double cosine) const;

  /// Whether rays go on from a side.
  bool is_specular(Side side) const { return is_clear() || is_mirror_[static_cast<std::size_t>(side)] != 0; }
  bool is_clear() const { return !parts_.empty(); }

  /// True if it transmits or mirrors the bands differently.
  bool is_coloured() const;

  /// A number for the properties behind mirrored_rays(): 0 of a side from which no ray goes on, 1 of a mirror, the
  /// index of refraction and 1 of a clear one, less than 0 where that keeps its reflections.
  double kind(Side side) const;

  /// The cosine that belongs to a number of [0, 1) if directions are distributed as the light kept of that from all
  /// directions alike.
  double held_cosine(double u) const;

 private:
  struct Part {
    double weight = 0;
    Pane pane;
  };
  void keep_what_panes_hold();
  double kept(double cosine) const;
  double reflected_by_panes(double cosine) const;

  Reflections reflections_;
  double index_ = 0;  // of clear ones, the mean of both sides
  Eigen::Index bands_;
  std::array<std::vector<Pane>, 2> panes_;   // of a clear one, per side and band; empty on an opaque side
  std::array<Spectrum, 2> mirrors_;          // per side; empty where it is no mirror
  std::array<std::uint8_t, 2> is_mirror_{};  // by sides, in some band
  std::vector<Part> parts_;                  // each pane once; none of a mirror
  std::array<double, 2> mirrored_{};         // by the sides of a mirror
  std::vector<double> held_upto_;            // of panes: the part of the kept share at cosines up to k / steps
  std::array<double, 2> held_{1, 1};         // of front and back
};

/// The clear polygons and mirrors of a scene; all others scatter or absorb all light that they meet. Directions are
/// unit vectors, those in which light is seen: a front is met against its normal.
class SurfaceOptics {
 public:
  /// None.
  SurfaceOptics() = default;
  explicit SurfaceOptics(const Scene& scene, Reflections reflections = Reflections::kept);

  bool empty() const { return faces_.empty(); }

  /// True if light goes on from mirrors and clear faces after a reflection.
  bool mirrors() const { return !faces_.empty() && reflections_ == Reflections::followed; }

  /// True if some face transmits or mirrors the bands differently.
  bool is_coloured() const;

  /// The functions of SpecularSurface for a polygon. All others transmit and reflect nothing: 0, and hold all light: 1.
  double transmittance(PolygonIndex polygon, const Vector& direction) const;
  double reflectance(PolygonIndex polygon, const Vector& direction) const;
  SpecularShares shares(PolygonIndex polygon, Side side, double cosine) const;
  double held(PolygonIndex polygon, Side side) const;
  double relative_held(PolygonIndex polygon, const Vector& direction) const;

  /// The fractions of light, per band, that go straight through a polygon and that it mirrors.
  Spectrum spectral_transmittance(PolygonIndex polygon, const Vector& direction) const;
  Spectrum spectral_reflectance(PolygonIndex polygon, const Vector& direction) const;
  Eigen::Index bands() const { return bands_; }

  /// True if light goes straight through a polygon from some side.
  bool is_clear(PolygonIndex polygon) const { return at(polygon) != nullptr && at(polygon)->is_clear(); }

  /// The face of a polygon that is specular; null of all others.
  const SpecularSurface* at(PolygonIndex polygon) const;

  /// The unit normal of a polygon's front; there must be specular ones.
  const Vector& normal(PolygonIndex polygon) const { return normals_[polygon]; }

  /// SpecularSurface::kind() of front and back of each of so many polygons.
  std::vector<std::array<double, 2>> kinds(std::size_t polygons) const;

  /// The direction in which a mirror is seen in another: that after the reflection at a polygon of this scene that is
  /// specular.
  Vector mirrored(PolygonIndex polygon, const Vector& direction) const;

  /// The direction, in a frame whose third axis is the polygon's normal, that belongs to (u, v) of the unit square if
  /// directions are distributed as the polygon keeps light from all directions alike: of all but clear ones
  /// square_to_cosine_hemisphere().
  Vector held_direction(PolygonIndex polygon, double u, double v) const;

 private:
  Side side_met(PolygonIndex polygon, const Vector& direction) const;

  static constexpr std::uint32_t not_specular = ~0U;
  Eigen::Index bands_ = 0;
  Reflections reflections_ = Reflections::kept;
  std::vector<SpecularSurface> faces_;     // each pair of materials once
  std::vector<std::uint32_t> of_polygon_;  // none where no polygon is specular, as normals
  std::vector<Vector> normals_;            // of the fronts
};

}  // namespace patchlight
