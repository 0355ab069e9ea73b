#pragma once

#include "visibility/occluder.h"

#include <memory>

namespace patchlight {

/// What the rays of a run need, made once: which polygons lie over which, and an occluder for each set of blockers.
/// That between patches is made at once, the others when they are first asked for. Of the scene only the polygons and
/// what they let through count; it must outlive the object. Safe to use from several threads.
class Tracing {
 public:
  explicit Tracing(const Scene& scene, Coverings coverings = {},
                   Occluder::Blockers between_patches = Occluder::Blockers::inside_hull,
                   Reflections reflections = Reflections::kept);
  ~Tracing();

  const Coverings& coverings() const { return coverings_; }

  /// Whether light goes on that mirrors and clear faces reflect.
  Reflections reflections() const { return reflections_; }

  /// True when there are mirrors or clear faces.
  bool has_specular_faces() const { return has_specular_faces_; }

  /// For rays between points of patches.
  const Occluder& between_patches() const { return *between_patches_; }

  /// For points that may lie anywhere: every polygon blocks.
  const Occluder& all_faces() const;

  /// Every polygon that lets no light through blocks, and the others count as not there.
  std::shared_ptr<const Occluder> opaque_faces() const;

  /// Every clear polygon blocks, and the others count as not there. Null where there are none.
  std::shared_ptr<const Occluder> clear_faces() const;

 private:
  struct Later;

  const Scene& scene_;
  Coverings coverings_;
  Occluder::Blockers kind_;
  bool has_openings_;
  bool has_specular_faces_;
  Reflections reflections_;
  std::shared_ptr<const Occluder> between_patches_;
  std::unique_ptr<Later> later_;
};

}  // namespace patchlight
