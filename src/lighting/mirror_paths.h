#pragma once

#include "patchlight/base/field.h"

#include "lighting/light_paths.h"
#include "lighting/mirror_chains.h"
#include "visibility/flat_polygon.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// All points up to a distance from a centre, metres.
struct Ball {
  Point centre = Point::Zero();
  double radius = 0;
};

/// The least one around the middle of points.
Ball ball_around(std::span<const Point> points);

/// How much light gets from one point to another by way of mirrors: the product of what these reflect and of what
/// LightPaths lets through between them.
class MirrorPaths {
 public:
  MirrorPaths(const Scene& scene, MirrorChains chains);

  const MirrorChains& found() const { return chains_; }
  const std::vector<MirrorChain>& chains() const { return chains_.chains; }

  /// False where no light of a source, by its MirroredSource::id, gets through a chain.
  bool carries(const MirrorChain& chain, std::uint32_t source) const;

  /// Irradiance at a place if the light that is not followed left each mirror diffusely and nothing were in the way.
  Spectrum unfollowed_irradiance(const Point& place, const Vector& normal) const;

  /// Per segment (row), from a receiver to a source, and band (column), by way of the mirrors of a chain: 0 where the
  /// straight line from the receiver's image to the source misses one of them.
  Field transmittance(const MirrorChain& chain, const LightPaths& paths, std::span<const Segment> segments) const;

  /// False where no straight line from the image of what is in a ball to what is in that of a source, or along a unit
  /// direction towards it, meets the last mirror of a chain. Cheap, and true too often.
  bool may_pass(const MirrorChain& chain, const Ball& receiver, const Ball& source) const;
  bool may_pass(const MirrorChain& chain, const Ball& receiver, const Vector& toward_source) const;

  /// What a polygon reflects, PaneSides::specular_reflectance().
  const PaneSides& sides() const { return sides_; }

 private:
  struct Way;
  std::vector<Way> ways(const MirrorChain& chain, std::span<const Segment> segments) const;

  MirrorChains chains_;
  PaneSides sides_;
  Eigen::Index bands_;
  double least_height_;            // metres
  std::vector<FlatPolygon> flat_;  // per polygon; empty where it is no mirror
  std::vector<Ball> balls_;        // around each of these
};

}  // namespace patchlight
