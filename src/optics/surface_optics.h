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

/// Whether mirrored light ends at the face, or continues.
enum class Reflections : bool { kept, followed };

/// The fractions of light that meets a specular face at an angle.
struct SpecularShares {
  double transmitted = 0;
  double mirrored = 0;
  double nonspecular = 1;          ///< absorbed or scattered
  double nonspecular_profile = 1;  ///< over its mean over the hemisphere
};

/// A clear face or a mirror for light between patches: one number for all bands, their mean weighted by luminance. A
/// clear face transmits and reflects the same both ways, by the mean of its two sides. Each side of a mirror has its
/// own reflectance, 0 if it is none. Cosines are those of the angle to its normal, in [0, 1]. Means over the hemisphere
/// are weighted by the cosine.
class SpecularSurface {
 public:
  /// `polygon` must be an opening, see is_opening(), or have a mirror side, see is_mirror().
  SpecularSurface(const Scene& scene, PolygonIndex polygon, Reflections reflections = Reflections::kept);

  /// The fraction that passes straight through.
  double transmittance(double cosine) const;

  /// The mirrored fraction: 0 where reflections are not followed.
  double reflectance(Side side, double cosine) const;

  /// The mean over the hemisphere of the fraction that a side absorbs or scatters.
  double nonspecular_fraction(Side side) const;

  /// This fraction at an angle, over nonspecular_fraction(). Its mean over the hemisphere is 1.
  double nonspecular_profile(double cosine) const;

  /// All of these.
  SpecularShares shares(Side side, double cosine) const;

  /// The specular fractions of light that meets a side, per band, by the material of this side.
  Spectrum spectral_transmittance(Side side, double cosine) const;
  Spectrum spectral_reflectance(Side side, double cosine) const;

  /// The probability that a traced ray is mirrored, else it passes. It is the reflectance of a pane of this index of
  /// refraction without absorption, so it follows from the geometry and not from colors. It is 1 on a mirror, and 0 on
  /// a clear face whose reflections are not followed.
  double mirrored_rays(Side side, double cosine) const;

  /// True if rays continue from a side.
  bool is_specular(Side side) const { return is_clear() || is_mirror_[static_cast<std::size_t>(side)] != 0; }
  bool is_clear() const { return !parts_.empty(); }

  /// True if it transmits the bands differently.
  bool transmits_colour() const;

  /// A number for the properties behind mirrored_rays(): 0 of a side from which no ray goes on, 1 of a mirror, the
  /// index of refraction and 1 of a clear one, less than 0 where that keeps its reflections.
  double kind(Side side) const;

  /// Maps a number of [0, 1) to a cosine. Directions are distributed as the nonspecular part of uniform light.
  double sample_nonspecular_cosine(double u) const;

 private:
  struct Part {
    double weight = 0;
    Pane pane;
  };
  void tabulate_nonspecular();
  double kept(double cosine) const;
  PaneShares by_panes(double cosine) const;  // reflections that are kept count as absorbed

  Reflections reflections_;
  double index_ = 0;  // of clear ones, the mean of both sides
  Eigen::Index bands_;
  std::array<std::vector<Pane>, 2> panes_;   // of a clear one, per side and band; empty on an opaque side
  std::array<Spectrum, 2> mirrors_;          // per side; empty where it is no mirror
  std::array<std::uint8_t, 2> is_mirror_{};  // by sides, in some band
  std::vector<Part> parts_;                  // each pane once; none of a mirror
  std::array<double, 2> mirrored_{};         // by the sides of a mirror
  std::vector<double> nonspecular_upto_;     // of panes: the nonspecular share at cosines up to k / steps
  std::array<double, 2> nonspecular_{1, 1};  // of front and back
};

/// The clear polygons and mirrors of a scene. All other polygons scatter or absorb all light. Directions are unit
/// vectors along the line of sight, so that a front is met against its normal.
class SurfaceOptics {
 public:
  /// None.
  SurfaceOptics() = default;
  explicit SurfaceOptics(const Scene& scene, Reflections reflections = Reflections::kept);

  bool empty() const { return faces_.empty(); }

  /// True if light continues from mirrors and clear faces after a reflection.
  bool follows_reflections() const { return !faces_.empty() && reflections_ == Reflections::followed; }

  /// True if some face transmits the bands differently.
  bool transmits_colour() const;

  /// The functions of SpecularSurface for a polygon. For all others the specular fractions are 0 and the nonspecular
  /// ones 1.
  double transmittance(PolygonIndex polygon, const Vector& direction) const;
  double reflectance(PolygonIndex polygon, const Vector& direction) const;
  SpecularShares shares(PolygonIndex polygon, Side side, double cosine) const;
  double nonspecular_fraction(PolygonIndex polygon, Side side) const;
  double nonspecular_profile(PolygonIndex polygon, const Vector& direction) const;

  /// The fractions of light, per band, that go straight through a polygon and that it mirrors.
  Spectrum spectral_transmittance(PolygonIndex polygon, const Vector& direction) const;
  Spectrum spectral_reflectance(PolygonIndex polygon, const Vector& direction) const;
  Eigen::Index bands() const { return bands_; }

  /// True if light goes straight through a polygon from some side.
  bool is_clear(PolygonIndex polygon) const { return at(polygon) != nullptr && at(polygon)->is_clear(); }

  /// The face of a specular polygon; null for all others.
  const SpecularSurface* at(PolygonIndex polygon) const;

  /// The unit normal of a polygon's front; there must be specular ones.
  const Vector& normal(PolygonIndex polygon) const { return normals_[polygon]; }

  /// SpecularSurface::kind() of front and back of each of so many polygons.
  std::vector<std::array<double, 2>> kinds(std::size_t polygons) const;

  /// The line of sight after a reflection at a specular polygon.
  Vector mirrored(PolygonIndex polygon, const Vector& direction) const;

  /// Maps (u, v) of the unit square to a direction in a frame whose third axis is the polygon's normal. Directions are
  /// distributed as the nonspecular part of uniform light; for opaque polygons as the cosine.
  Vector sample_nonspecular_direction(PolygonIndex polygon, double u, double v) const;

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
