#pragma once
// Values as a row of bytes and back, between ranks of one program. What is trivially copyable goes as it lies in
// memory; vectors, texts, maps, variants and tuples go element by element; a struct with such members has them tied by
// a Members<> of its own (slab_members.hpp).
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "base/error.hpp"

namespace coupling {

using Bytes = std::vector<std::byte>;

/// tie(): a struct's members as a tuple of references.
template <class T>
struct Members;
template <class T>
concept HasMembers = requires(T& value) {
  Members<std::remove_const_t<T>>::tie(value);
};

class ByteWriter {
 public:
  template <class... T>
  explicit ByteWriter(const T&... values) {
    (put(values), ...);
  }

  template <class T>
  void put(const T& value) {
    if constexpr (HasMembers<const T>)
      put(Members<T>::tie(value));
    else
      put_raw(&value, 1);
  }
  template <class T>
  void put(std::span<const T> values) {
    put(values.size());
    if constexpr (is_raw<T>)
      put_raw(values.data(), values.size());
    else
      for (const T& value : values) put(value);
  }
  template <class T>
  void put(std::span<T> values) {
    put(std::span<const T>(values));
  }
  template <class T>
  void put(const std::vector<T>& values) {
    put(std::span<const T>(values));
  }
  void put(const std::string& text) { put(std::span<const char>(text)); }
  template <class K, class V>
  void put(const std::map<K, V>& values) {
    put(values.size());
    for (const auto& [key, value] : values) {
      put(key);
      put(value);
    }
  }
  template <class... T>
  void put(const std::variant<T...>& value) {
    put(value.index());
    std::visit([&](const auto& held) { put(held); }, value);
  }
  template <class... T>
  void put(const std::tuple<T...>& values) {
    std::apply([&](const auto&... value) { (put(value), ...); }, values);
  }

  void append(const Bytes& others) { bytes_.insert(bytes_.end(), others.begin(), others.end()); }

  const Bytes& bytes() const { return bytes_; }
  Bytes take() { return std::move(bytes_); }

  template <class T>
  static constexpr bool is_raw = std::is_trivially_copyable_v<T> && !HasMembers<T>;

 private:
  template <class T>
  void put_raw(const T* values, std::size_t count) {
    static_assert(is_raw<T> && !std::is_pointer_v<T>, "a struct with members of its own needs Members<>");
    if (count == 0) return;
    const std::size_t before = bytes_.size();
    bytes_.resize(before + count * sizeof(T));
    std::memcpy(bytes_.data() + before, values, count * sizeof(T));
  }
  Bytes bytes_;
};

/// Takes values out in the order in which they were put; of a row that ends too early it makes an InternalError.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : rest_(bytes) {}

  template <class T>
  T get() {
    T value{};
    get(value);
    return value;
  }

  template <class T>
  void get(T& value) {
    if constexpr (HasMembers<T>)
      get(Members<T>::tie(value));
    else
      get_raw(&value, 1);
  }
  template <class T>
  void get(std::vector<T>& values) {
    const auto count = get<std::size_t>();
    if constexpr (ByteWriter::is_raw<T>) {
      base::require_internal(count <= rest_.size() / sizeof(T), "a message between ranks is too short");
      values.resize(count);
      get_raw(values.data(), count);
    } else {
      values.clear();
      for (std::size_t k = 0; k < count; ++k) values.push_back(get<T>());
    }
  }
  void get(std::string& text) {
    const auto letters = get<std::vector<char>>();
    text.assign(letters.begin(), letters.end());
  }
  template <class K, class V>
  void get(std::map<K, V>& values) {
    values.clear();
    for (auto count = get<std::size_t>(); count > 0; --count) {
      const K key = get<K>();
      get(values[key]);
    }
  }
  template <class... T>
  void get(std::variant<T...>& value) {
    get_alternative(value, get<std::size_t>(), std::index_sequence_for<T...>());
  }
  template <class... T>
  void get(std::tuple<T...>& values) {
    std::apply([&](auto&... value) { (get(value), ...); }, values);
  }
  template <class... T>
  void get(std::tuple<T&...> values) {
    std::apply([&](auto&... value) { (get(value), ...); }, values);
  }

  bool empty() const { return rest_.empty(); }

 private:
  template <class T>
  void get_raw(T* values, std::size_t count) {
    static_assert(ByteWriter::is_raw<T> && !std::is_pointer_v<T>, "a struct with members of its own needs Members<>");
    base::require_internal(count * sizeof(T) <= rest_.size(), "a message between ranks is too short");
    if (count == 0) return;
    std::memcpy(static_cast<void*>(values), rest_.data(), count * sizeof(T));
    rest_ = rest_.subspan(count * sizeof(T));
  }
  template <class... T, std::size_t... I>
  void get_alternative(std::variant<T...>& value, std::size_t index, std::index_sequence<I...>) {
    (void)((I == index ? (get(value.template emplace<I>()), true) : false) || ...);
  }
  std::span<const std::byte> rest_;
};

}  // namespace coupling
