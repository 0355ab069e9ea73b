#pragma once

#include "patchlight/light/material.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

// Values as bytes, in their memory layout, for another process of this program on this machine. Numbers, enumerations,
// texts, paths, Eigen arrays and shared textures are values. So are arrays, vectors and optionals of values, and
// structs whose members members_of() ties, a function in the namespace of the struct.
namespace patchlight {

/// A type, or the same type as a constant: members_of() has one overload for both.
template <class Value, class Type>
concept Is = std::is_same_v<std::remove_const_t<Value>, Type>;

inline auto members_of(Is<Texture> auto& texture) { return std::tie(texture.width, texture.height, texture.texels); }

/// Numbers, enumerations and arrays of them: their bytes are copied.
template <class Value>
inline constexpr bool is_sent_whole = std::is_arithmetic_v<Value> || std::is_enum_v<Value>;
template <class Value, std::size_t n>
inline constexpr bool is_sent_whole<std::array<Value, n>> = is_sent_whole<Value>;

using TexturePointer = std::shared_ptr<const Texture>;

/// Writes values. Textures that several values share are written once.
class MessageWriter {
 public:
  template <class... Values>
  void operator()(const Values&... values) {
    (add(values), ...);
  }
  std::string bytes() && { return std::move(bytes_); }

 private:
  template <class Number>
  void add_plain(const Number* values, std::size_t count) {
    bytes_.append(reinterpret_cast<const char*>(values), count * sizeof(Number));
  }

  template <class Value>
  void add(const Value& value) {
    if constexpr (is_sent_whole<Value>) {
      add_plain(&value, 1);
    } else if constexpr (std::is_same_v<Value, std::filesystem::path>) {
      add(value.string());
    } else if constexpr (std::is_same_v<Value, TexturePointer>) {
      const auto place = std::find(textures_.begin(), textures_.end(), value);
      add(static_cast<std::size_t>(place - textures_.begin()));
      if (place != textures_.end()) return;
      textures_.push_back(value);
      add(*value);
    } else if constexpr (requires { value.reshaped(); }) {
      if constexpr (Value::SizeAtCompileTime == Eigen::Dynamic) (*this)(value.rows(), value.cols());
      add_plain(value.data(), static_cast<std::size_t>(value.size()));
    } else if constexpr (requires { value.has_value(); }) {
      add(value.has_value());
      if (value) add(*value);
    } else if constexpr (requires { value.begin(); }) {
      if constexpr (requires { value.capacity(); }) add(value.size());
      if constexpr (is_sent_whole<typename Value::value_type>) return add_plain(value.data(), value.size());
      for (const auto& item : value) add(item);
    } else {
      std::apply(*this, members_of(value));
    }
  }

  std::string bytes_;
  std::vector<TexturePointer> textures_;
};

/// Reads values in the order in which they were written. \throws std::runtime_error past the end.
class MessageReader {
 public:
  explicit MessageReader(std::string_view bytes) : bytes_(bytes) {}

  template <class... Values>
  void operator()(Values&... values) {
    (take(values), ...);
  }

 private:
  static void require(bool condition) {
    if (!condition) throw std::runtime_error("a message ends early");
  }

  template <class Number>
  void take_plain(Number* values, std::size_t count) {
    require(count <= bytes_.size() / sizeof(Number));
    if (count > 0) std::memcpy(values, bytes_.data(), count * sizeof(Number));
    bytes_.remove_prefix(count * sizeof(Number));
  }

  template <class Value>
  Value next() {
    Value value;
    take(value);
    return value;
  }

  template <class Matrix>
  void resize(Matrix& matrix) {
    const auto rows = next<Eigen::Index>(), columns = next<Eigen::Index>();
    const auto most = static_cast<Eigen::Index>(bytes_.size() / sizeof(matrix(0)));
    require(rows >= 0 && columns >= 0 && (columns == 0 || rows <= most / columns));
    require(Matrix::ColsAtCompileTime == Eigen::Dynamic || columns == Matrix::ColsAtCompileTime);
    matrix.resize(rows, columns);
  }

  TexturePointer texture() {
    const auto place = next<std::size_t>();
    require(place <= textures_.size());
    if (place < textures_.size()) return textures_[place];
    textures_.push_back(std::make_shared<const Texture>(next<Texture>()));
    const Texture& read = *textures_.back();
    if (read.texels.empty() || read.texels.size() != std::uint64_t{read.width} * read.height)
      throw std::runtime_error("the size of a picture is wrong");
    return textures_.back();
  }

  template <class Value>
  void take(Value& value) {
    if constexpr (is_sent_whole<Value>) {
      take_plain(&value, 1);
    } else if constexpr (std::is_same_v<Value, std::filesystem::path>) {
      value = next<std::string>();
    } else if constexpr (std::is_same_v<Value, TexturePointer>) {
      value = texture();
    } else if constexpr (requires { value.reshaped(); }) {
      if constexpr (Value::SizeAtCompileTime == Eigen::Dynamic) resize(value);
      take_plain(value.data(), static_cast<std::size_t>(value.size()));
    } else if constexpr (requires { value.has_value(); }) {
      if (next<bool>()) take(value.emplace());
    } else if constexpr (requires { value.begin(); }) {
      if constexpr (requires { value.capacity(); }) {
        const auto count = next<std::size_t>();
        require(count <= bytes_.size());  // each item has at least one byte
        value.resize(count);
      }
      if constexpr (is_sent_whole<typename Value::value_type>) return take_plain(value.data(), value.size());
      for (auto& item : value) take(item);
    } else {
      std::apply(*this, members_of(value));
    }
  }

  std::string_view bytes_;
  std::vector<TexturePointer> textures_;
};

/// The bytes of a value.
std::string message_of(const auto& value) {
  MessageWriter out;
  out(value);
  return std::move(out).bytes();
}

/// The value with these bytes. \throws std::runtime_error for damaged ones.
template <class Value>
Value value_in(std::string_view bytes) {
  Value value;
  MessageReader in(bytes);
  in(value);
  return value;
}

}  // namespace patchlight
