#pragma once

#include <cstddef>

namespace patchlight {

/// Limits of one model and all files that it names. A small file can ask for a great deal of work: copies of copies,
/// texts that hold texts. Readers of such formats refuse a file that exceeds one of these with an InputError.
namespace reading_limits {

inline constexpr std::size_t polygons = 10'000'000;    ///< copies included; a million take about a gigabyte to solve
inline constexpr std::size_t copies = 1'000'000;       ///< objects visited within instances, with or without faces
inline constexpr std::size_t files = 200'000;          ///< files read, copies included
inline constexpr std::size_t nesting = 64;             ///< objects, tables or files within others: parsers recurse
inline constexpr std::size_t values = 1'000'000;       ///< values of a scene file, which take 700 bytes each
inline constexpr std::size_t key_length = 200;         ///< characters of a key of a scene file, kept with each value
inline constexpr std::size_t variable_length = 4096;   ///< characters of a variable, as of the longest file name
inline constexpr std::size_t text_length = 1'000'000;  ///< characters of a text with its variables

}  // namespace reading_limits

}  // namespace patchlight
