#pragma once

#include <stdexcept>
#include <string>

namespace patchlight {

/// The user's input cannot be used. `where` names the file and line or the field of the request ("room.obj:12",
/// "mesh.max_edge"); the message names the value found, the value expected and the remedy.
class InputError : public std::runtime_error {
 public:
  InputError(const std::string& where, const std::string& message) : std::runtime_error(where + ": " + message) {}
};

/// A result cannot be written. `where` names the file.
class OutputError : public std::runtime_error {
 public:
  OutputError(const std::string& where, const std::string& message) : std::runtime_error(where + ": " + message) {}
};

/// The work would need more memory than it may use.
class MemoryError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The observer asked to stop before there was a result.
class Canceled : public std::runtime_error {
 public:
  Canceled() : std::runtime_error("canceled") {}
};

}  // namespace patchlight
