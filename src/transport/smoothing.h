#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/geometry.h"
#include "patchlight/mesh/patch_mesh.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// A cube of one of the nested grids over a scene. Each level doubles the edges of the level below.
struct Cell {
  int level = 0;
  std::uint64_t code = 0;  ///< Morton code: the interleaved bits of its x, y and z
  bool operator==(const Cell&) const = default;
};

/// Candidates for near patches, with the coordinates of their centroids.
struct NearPatches {
  std::vector<PatchIndex> patches;
  std::array<std::vector<double>, 3> centroids;
};

/// The centroids of all patches along a space-filling curve (Morton 1966), on which those of every cell of every level
/// are contiguous. O(n log n) to build.
class PatchCells {
 public:
  /// Some level has cells with edges of `length` meters, greater than 0, up to rounding. Keeps a reference to the mesh.
  PatchCells(const PatchMesh& mesh, double length);

  std::size_t size() const { return places_.size(); }
  /// The patch at a place on the curve, and its cell at a level.
  PatchIndex patch(std::size_t place) const { return places_[place].patch; }
  Cell cell(std::size_t place, int level) const { return {level, places_[place].code >> (3 * level)}; }
  /// The lowest level whose cells have edges of at least `length` meters, or the highest level if there is none.
  int level_of(double length) const;

  /// All patches in a cell and its neighbor cells: every other patch is at least one cell edge away from the patches in
  /// the cell.
  NearPatches around(const Cell& home) const;

 private:
  struct Place {
    std::uint64_t code = 0;  // of the cell of level 0
    PatchIndex patch = 0;
    bool operator<(const Place& other) const {
      return code < other.code || (code == other.code && patch < other.patch);
    }
  };

  void add_patches_in(const Cell& cell, NearPatches& near) const;

  const std::vector<Point>& centroids_;
  double edge_ = 1;  // of level 0, meters
  std::vector<Place> places_;
};

/// Two independent, smoothed estimates of an irradiance, and the variance of their mean.
struct SmoothedHalves {
  std::array<Field, 2> halves;
  Field variance;  ///< of the mean of both
};

/// Smooths two independent estimates of the irradiance between patches with the same weights. Each patch gets the value
/// at its centroid of an area-weighted linear regression over its neighbors, at most about 32. Neighbors lie within a
/// fifth of the harmonic mean `distance` in meters that each of the two sees; irradiance varies no faster (Ward,
/// Rubinstein and Clear 1988). They face the same way within 25 degrees and lie in about one plane, so no light crosses
/// an edge or a wall that stands on a face.
///
/// A patch keeps its own values if both halves differ from its neighbors by more than the errors: a patch behind
/// another face may look into another space. Use only for light without small sources, since the shadows of lamps are
/// sharper. The variance assumes equal scatter of the halves among neighbors. O(size) for patches of even sizes. The
/// same bits for any number of threads.
SmoothedHalves smoothed(const PatchMesh& mesh, std::span<const float> distance, const std::array<Field, 2>& halves);

}  // namespace patchlight
