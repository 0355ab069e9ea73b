#pragma once

#include <cstdint>

/// Names of the streams of random numbers. A stream starts at hash({seed, place, stream::name}), or at another key that
/// its place of use shows: two purposes with the same key draw independent numbers if their streams differ. Each group
/// below has keys of its own, so that numbers repeat between groups. Within a group equal numbers belong to purposes
/// that no run combines, or to keys of different lengths.
namespace patchlight::stream {

enum Stream : std::uint64_t {
  // Seeds of later computations of one run
  later_meshes = 0x2d5,

  // Form factors by rows of rays, or by pairs
  hemisphere = 0,
  toward_bright_patches = 1,
  lost_rays = 1,      // pairs alone
  ways_at_panes = 2,  // rays alone
  row_estimate = 2,   // pairs alone
  points_on_emitters = 3,

  // Signs of the errors of patches
  signs_of_direct_light = 2,
  signs_of_rows = 0x64726177,
  signs_of_lights = 0x64726178,
  signs_of_row_sums = 0x726f77,

  // Light in mirrors: shared points, and the shift of each receiver. Direct light shifts the points of its
  // sources by their index in place of a stream.
  points_of_mirror_chains = 7,
  shift_at_receiver = 0x73686966,

  // Irradiance at sensors: rays of the hemisphere, and the choice of bright patches
  hemisphere_of_sensor = 0x68656d69,
  choice_of_bright_patch = 0x62726967,

  // A year of daylight
  points_to_sky_divisions = 0x79656172,
  places_in_sun = 0x73756e,

  // Russian roulette along specular paths
  survival_of_path = 0x726f756c,

  // Quarters of patches
  emitters_at_quarters = 1,
  clear_at_quarters = 2,
  points_at_quarters = 3,
  halves_of_quarters = 0x9a7,

  // Pictures and lightmaps
  pixel_sequence = 0x70697873,
  pixel_places = 1,
  gather_without_record = 2,
  lights_of_pixel = 3,
  lights_of_texel = 1,
  gathers_of_texel = 2,
  buried_texels = 3,
  panes_of_gather = 1,
  bounce_directions = 3,
  lights_of_bounce = 4,
  panes_of_bounce = 5,
  next_bounce = 6,
  choice_of_source = 11,
  place_on_source = 12,
  sky_openings = 21,
  sky_hemisphere = 22,
  ambient_occlusion = 31,

  // Planning and spaces
  goal_batch = 0x676f616c,
  enclosure = 0x656e636c,

  // Comparison with paths
  path_starts = 0,
  exposed_points = 1,
  path_order = 4,
  path_luminaire = 5,
  path_vertices = 6,  // and the three after it
  pane_or_reflection = 6,
  vertex_sends_shadow_rays = 10,
  mirror_jitter = 11,
  mirror_order = 12,
  mirror_luminaire = 13,
  mirror_chain = 14,
  path_seeds = 0x70617468,
  next_mirror = 1,
  side_of_next_mirror = 2,
  mirror_tests = 0x74657374,
  compared_left_out = 0x6c656674,
  compared_patches = 0x63686f6f7365,
  repeated_comparison = 0x61676169,
};

}  // namespace patchlight::stream
