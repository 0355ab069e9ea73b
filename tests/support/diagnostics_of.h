#pragma once

#include "patchlight/scene/scene.h"

#include <algorithm>
#include <string>
#include <vector>

namespace patchlight::test {

inline std::ptrdiff_t count_of(const Diagnostics& diagnostics, DiagnosticCode code) {
  return std::count_if(diagnostics.begin(), diagnostics.end(),
                       [code](const Diagnostic& found) { return found.code == code; });
}

inline bool has(const Diagnostics& diagnostics, DiagnosticCode code) { return count_of(diagnostics, code) > 0; }

/// True if one finding of this code has all of these words: names, values, lines and options. No test compares the
/// sentence around them.
inline bool has(const Diagnostics& diagnostics, DiagnosticCode code, const std::vector<std::string>& words) {
  return std::any_of(diagnostics.begin(), diagnostics.end(), [&](const Diagnostic& found) {
    return found.code == code && std::all_of(words.begin(), words.end(), [&](const std::string& word) {
             return found.text.find(word) != std::string::npos;
           });
  });
}

inline std::vector<DiagnosticCode> codes_of(const Diagnostics& diagnostics) {
  std::vector<DiagnosticCode> codes;
  for (const Diagnostic& found : diagnostics) codes.push_back(found.code);
  return codes;
}

/// The diagnostics of a scene that are notes.
inline Diagnostics notes_of(const Scene& scene) { return chosen(scene.diagnostics, is_note); }
inline Diagnostics problems_of(const Scene& scene) {
  return chosen(scene.diagnostics, [](DiagnosticCode code) { return !is_note(code); });
}

}  // namespace patchlight::test
