#pragma once

#include <array>

// The files of a folder of form factors.
namespace patchlight::file_name {

inline constexpr const char* dense = "F.npy";
inline constexpr const char* sparse = "F.mtx";
inline constexpr const char* dense_error = "sampling_error.npy";
inline constexpr const char* sparse_error = "sampling_error.mtx";
inline constexpr const char* half_differences = "half_differences.npy";
inline constexpr const char* area = "area.npy";
inline constexpr const char* exitance = "exitance.npy";
inline constexpr const char* reflectance = "reflectance.npy";
inline constexpr const char* lost_share = "lost_share.npy";
/// How info.json describes the file of lost shares.
inline constexpr const char* about_lost_share =
    "per patch the share of its hemisphere that is open, that shows sides without patches, the covered share of its "
    "area, and that over which other polygons lie; unit 1";
inline constexpr const char* raw_row_sum = "raw_row_sum.npy";
inline constexpr const char* mesh = "mesh.vtp";
inline constexpr const char* scene = "scene.json";
inline constexpr const char* info = "info.json";
inline constexpr const char* by_material = "by_material.csv";
inline constexpr const char* by_object = "by_object.csv";

// Those of rows of rays; each of the first six twice, for both halves of the rays.
inline constexpr std::array<const char*, 6> of_half = {"hit_begin",   "hits",          "hit_weight",
                                                       "entry_begin", "entry_columns", "entries"};
// And, where rays go on from clear faces or mirrors, these as well.
inline constexpr std::array<const char*, 5> of_stops = {"stop_begin", "stop_columns", "stop_factors", "stop_polygons",
                                                        "stop_steps"};
inline constexpr std::array<const char*, 4> of_classes = {"class_rows", "class_columns", "class_numbers",
                                                          "class_factors"};
inline constexpr const char* specular_kinds = "specular_kinds.npy";
inline constexpr const char* hit_distance = "hit_distance.npy";
inline constexpr const char* directed = "directed.npy";
inline constexpr const char* lamps = "lamps.npy";
inline constexpr std::array<const char*, 2> emitter_factors = {"lamp_factors_0.npy", "lamp_factors_1.npy"};
inline constexpr const char* emitter_standard_error = "lamp_standard_error.npy";

/// The value of info.json's key "kind".
inline constexpr const char* kind = "patchlight form factors";

}  // namespace patchlight::file_name
