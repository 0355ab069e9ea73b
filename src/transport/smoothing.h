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

/// A cube of one of the grids over a scene, each with edges twice as long as those of the level below.
struct Cell {
  int level = 0;
  std::uint64_t code = 0;  ///< the bits of its place along x, y and z in turns
  bool operator==(const Cell&) const = default;
};

/// Patches that may be near, with the coordinates of their centroids.
struct NearPatches {
  std::vector<PatchIndex> patches;
  std::array<std::vector<double>, 3> centroids;
};

/// The centroids of all patches along a curve through the scene (Morton 1966) on which those of every cell of every
/// level follow each other. O(n log n) to build.
class PatchCells {
 public:
  /// Cells of one of the levels have edges of `length` metres, more than 0, but for rounding. Refers to the mesh, which
  /// has to outlive it.
  PatchCells(const PatchMesh& mesh, double length);

  std::size_t size() const { return places_.size(); }
  /// The patch at a place of the curve, and its cell of a level.
  PatchIndex patch(std::size_t place) const { return places_[place].patch; }
  Cell cell(std::size_t place, int level) const { return {level, places_[place].code >> (3 * level)}; }
  /// The lowest level whose cells have edges of at least `length`, metres; the highest where none has.
  int level_of(double length) const;

  /// All patches in a cell and in those around: none else is nearer than a cell's edge to what lies in it.
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
  double edge_ = 1;  // of level 0, metres
  std::vector<Place> places_;
};

/// Two independent estimates of an irradiance, smoothed, and the variance left to their mean.
struct SmoothedHalves {
  std::array<Field, 2> halves;
  Field variance;  ///< of the mean of both
};

/// Smooths two independent estimates of the irradiance between patches alike: each patch takes the value at its
/// centroid of the area-weighted linear regression over its neighbours, at most some 32. Neighbours lie within a fifth
/// of the harmonic mean `distance` of what each of the two sees (metres; Ward, Rubinstein and Clear 1988 show that
/// irradiance varies no faster), look the same way within 25 degrees, and lie in about one plane: so nothing is carried
/// across an edge, or a wall that stands on a face. A patch that both halves tell to be far off its neighbours, by more
/// than errors are, keeps its own values: one behind another face may look into another space. Only for light of which
/// no source is small: the shadows of lamps are sharper. The variance takes the scatter of the halves as equal among
/// neighbours. O(size) for patches of even sizes. The same bits for any number of threads.
SmoothedHalves smoothed(const PatchMesh& mesh, std::span<const float> distance, const std::array<Field, 2>& halves);

}  // namespace patchlight
