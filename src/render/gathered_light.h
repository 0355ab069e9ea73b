#pragma once

#include "patchlight/base/field.h"
#include "patchlight/mesh/patch_mesh.h"

#include "mesh/patch_lookup.h"
#include "render/irradiance_cache.h"
#include "render/light_samples.h"
#include "visibility/occluder.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace patchlight {

/// What a final gather knows of a solved scene. Fields have a row per patch and a column per band.
struct SolvedLight {
  const PatchMesh& mesh;
  const Occluder& occluder;  ///< of all faces
  Lights lights;
  Field exitance;   ///< W/m^2
  Field reflected;  ///< radiosity without exitance, W/m^2; 0 where nothing is reflected twice
  Field reflectance;
  std::vector<PatchIndex> other_side{};  ///< as Scattering has it
  Field transmittance{};
  Eigen::VectorXd luminous_weights;  ///< per band
  const Scene* scene = nullptr;      ///< whose pictures show; none: patches have one reflectance each
};

/// The reflectance at a point of a patch: that of the texel where a picture is on it, else the patch's.
Spectrum reflectance_at(const SolvedLight& light, PatchIndex patch, const Point& point);

/// False where only the solution knows what is scattered: at clear faces and mirrors.
bool is_plain(const SolvedLight& light, PatchIndex patch);

/// The patch on the other side of a sheet.
std::optional<PatchIndex> behind(const SolvedLight& light, PatchIndex patch);

/// A place of a patch.
struct PatchPoint {
  Point point;
  PatchIndex patch = 0;
};

/// How the light from other patches is gathered at a point.
struct HemisphereOptions {
  int rays = 1024;
  int most_bounces = 3;  ///< before the solution is asked all the same
  std::uint32_t seed = 1;
};

/// What patches reflect to points: the irradiance by light that has been reflected at least once, and none that comes
/// straight from lights.
class GatheredLight {
 public:
  /// Keeps a reference, which must outlive it.
  explicit GatheredLight(const SolvedLight& solved);

  /// The record of a point, by rays distributed as the cosine over its hemisphere, stratified, into the solution. Where
  /// a ray meets a patch that is wider than the ray is long, it goes on from there by the same rule, with light
  /// straight from lights. Its radius is a share of the harmonic mean of the rays' lengths, and of the length over
  /// which the irradiance changes by itself, and from `least` to `most` metres. Follows from the seed and the point's
  /// `key` alone.
  IrradianceRecord record_at(const PatchPoint& at, std::uint64_t key, double least, double most,
                             const HemisphereOptions& options) const;

  const PatchLookup& lookup() const { return lookup_; }

  /// Which rays to the sky a place of a patch gets; without any there is no sky.
  SkyAim aim_at(PatchIndex patch) const;

 private:
  struct Stop;
  std::vector<Stop> stops_of(const std::vector<Ray>& rays, std::uint64_t seed) const;
  Field arriving(const std::vector<Stop>& stops, int bounces_left, std::uint32_t seed) const;

  const SolvedLight& solved_;
  PatchLookup lookup_;
};

}  // namespace patchlight
