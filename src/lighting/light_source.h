#pragma once

#include "patchlight/scene/scene.h"

#include "base/sampling.h"
#include "lighting/lighting.h"
#include "visibility/occluder.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

namespace patchlight {

/// All points up to a distance from a center, meters.
struct Ball {
  Point centre = Point::Zero();
  double radius = 0;
};

/// A ball that encloses the points, around their mean.
Ball ball_around(std::span<const Point> points);

/// A triangle or convex quadrilateral of an emitting polygon.
struct EmitterFace {
  std::array<Point, 4> corners;  ///< counter-clockwise from the emitting side; the last two are equal in a triangle
  Vector normal;                 ///< unit, of the emitting side
  double area = 0;
  PolygonIndex polygon = no_polygon;
  Spectrum exitance;  ///< W/m^2
};

/// The faces of one side of a polygon.
std::vector<EmitterFace> emitter_faces(const Scene& scene, PolygonIndex polygon, Side side);

/// The light that arrives at a point from one point of a source if nothing is in the way.
struct LightSample {
  Point from = Point::Zero();         ///< a point of the source, or one beyond the scene
  PolygonIndex polygon = no_polygon;  ///< of an emitter face
  double irradiance = 0;              ///< times the color: W/m^2; 0: none
  const Spectrum* color = nullptr;    ///< lives as long as the source
};

/// The shadow ray of a sample.
inline Segment segment_to(const LightSample& sample, const SurfacePoint& at) {
  return {at.point, sample.from, at.polygon, sample.polygon};
}

/// Where a source is: in a direction, or in a ball.
struct SourceExtent {
  std::optional<Vector> direction;
  Ball ball;
};

/// A luminaire, the sun, or an emitter face. The mean of its samples over the unit square is the irradiance without
/// occluders. Refers to the luminaire or lighting that it is made from.
class LightSource {
 public:
  /// `up` is the vertical axis, as the flux of some luminaires depends on their tilt.
  LightSource(const Luminaire& luminaire, const Vector& up, std::uint32_t id = 0);
  LightSource(const Lighting& lighting, const Sun& sun, std::uint32_t id);
  LightSource(EmitterFace face, std::uint32_t id);

  /// The same for a source in every LightSampler of one lighting. Faces have that of their polygon.
  std::uint32_t id() const { return id_; }
  const SourceExtent& extent() const { return extent_; }
  /// A unit vector; narrow beams lie around it.
  const Vector& axis() const { return axis_; }
  /// True if light comes from one point or direction.
  bool is_delta() const { return is_delta_; }
  bool is_face() const { return std::holds_alternative<OfFace>(of_); }

  /// The light from one point of the source, for (u, v) of the unit square. Points inside of a sphere get nothing.
  LightSample sample(const SurfacePoint& at, const Eigen::Vector2d& uv) const;

  /// The irradiance without occluders by an emitter face in closed form, relative to its exitance; nothing for other
  /// sources.
  std::optional<double> unoccluded(const SurfacePoint& at) const;

  /// An estimate of the irradiance without occluders, mean of the bands, W/m^2. It is 0 only where no light arrives.
  double possible_irradiance(const SurfacePoint& at) const;

 private:
  struct OfLuminaire {
    const Luminaire* luminaire;
    Vector up;
  };
  struct OfSun {
    const Lighting* lighting;
    const Sun* sun;
  };
  struct OfFace {
    EmitterFace face;
    QuadPoints points;
  };
  LightSample sample_of(const OfLuminaire& source, const SurfacePoint& at, const Eigen::Vector2d& uv) const;
  LightSample sample_of(const OfSun& source, const SurfacePoint& at, const Eigen::Vector2d& uv) const;
  LightSample sample_of(const OfFace& source, const SurfacePoint& at, const Eigen::Vector2d& uv) const;

  std::uint32_t id_;
  bool is_delta_;
  SourceExtent extent_;
  Vector axis_;
  std::variant<OfLuminaire, OfSun, OfFace> of_;
};

/// A source that gets shadow rays, and the factor of their mean.
struct SourceChoice {
  std::uint32_t index = 0;  ///< in LightSampler::sources()
  std::uint32_t rays = 0;
  double factor = 1;
};

/// All sources of a lighting, with some emitter faces. Refers to the lighting.
class LightSampler {
 public:
  // Not explicit: a lighting is a sampler of its luminaires, sun and sky.
  LightSampler(const Lighting& lighting, std::vector<EmitterFace> faces = {});

  const Lighting& lighting() const { return *lighting_; }

  /// Luminaires, the sun if there is one, and faces, in this order.
  std::span<const LightSource> sources() const { return sources_; }

  /// Luminaires and the sun.
  std::span<const LightSource> without_faces() const { return std::span(sources_).first(without_faces_); }

  /// True if some source is a face, or if some is none.
  bool has_any(bool is_face) const { return is_face ? sources_.size() > without_faces_ : without_faces_ > 0; }

  /// Chooses sources for a point by possible_irradiance(): about `rays` shadow rays among those without extent, one
  /// each, and as many among the others, two or more each. The sun always gets one. Up to four of a kind all get rays.
  /// The sum of factor times irradiance, as a mean over u of [0, 1), is that of all sources.
  std::vector<SourceChoice> choose(const SurfacePoint& at, std::uint32_t rays, double u) const;

 private:
  void choose_among(bool are_delta, std::span<const double> weights, std::uint32_t rays, double u,
                    std::vector<SourceChoice>& chosen) const;

  const Lighting* lighting_;
  std::vector<LightSource> sources_;
  std::size_t without_faces_ = 0;
};

}  // namespace patchlight
