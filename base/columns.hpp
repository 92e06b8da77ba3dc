#pragma once
// A state as named columns of numbers: what one side hands out for a checkpoint and takes back. Saver and Loader have
// the same calls, so that one walk over the members serves both and the two cannot disagree.
#include <cstdint>
#include <cstring>
#include <map>
#include <span>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "base/error.hpp"

namespace base {

using Column =
    std::variant<std::vector<double>, std::vector<float>, std::vector<int>, std::vector<std::int64_t>, std::string>;
using Columns = std::map<std::string, Column>;  // a name may have groups: "grains/place"

/// The column of this name; an empty one where there is none. Throws UserError when it is of another type.
template <class T>
const T& column(const Columns& columns, const std::string& name) {
  static const T none{};
  const auto found = columns.find(name);
  if (found == columns.end()) return none;
  const T* values = std::get_if<T>(&found->second);
  require_user(values != nullptr, "column " + name + " is of another type");
  return *values;
}

/// Rows that are no plain numbers are made of doubles; of floats where their size leaves no other choice.
template <class T>
using Cell =
    std::conditional_t<std::is_arithmetic_v<T>, T, std::conditional_t<sizeof(T) % sizeof(double) == 0, double, float>>;

class Saver {
 public:
  explicit Saver(Columns& to) : to_(to) {}
  static constexpr bool loads = false;

  /// Single numbers of any kind, and structs of doubles; integers up to 2^53.
  template <class... T>
  void numbers(const std::string& name, const T&... values) {
    std::vector<double> all;
    (add(all, values), ...);
    to_[name] = std::move(all);
  }
  template <class T>
  void rows(const std::string& name, const std::vector<T>& values) {
    rows(name, std::span<const T>(values));
  }
  template <class T>
  void rows(const std::string& name, std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(Cell<T>) == 0);
    if (values.empty()) return;
    std::vector<Cell<T>> cells(values.size() * (sizeof(T) / sizeof(Cell<T>)));
    std::memcpy(cells.data(), values.data(), values.size() * sizeof(T));
    to_[name] = std::move(cells);
  }
  void text(const std::string& name, const std::string& value) { to_[name] = value; }

 private:
  template <class T>
  static void add(std::vector<double>& all, const T& value) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      all.push_back(static_cast<double>(value));
    } else {
      static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(double) == 0);
      all.resize(all.size() + sizeof(T) / sizeof(double));
      std::memcpy(all.data() + all.size() - sizeof(T) / sizeof(double), &value, sizeof(T));
    }
  }
  Columns& to_;
};

class Loader {
 public:
  explicit Loader(const Columns& from) : from_(from) {}
  static constexpr bool loads = true;

  template <class... T>
  void numbers(const std::string& name, T&... values) {
    const auto& all = column<std::vector<double>>(from_, name);
    require_user(all.size() == (count<T>() + ...), "column " + name + " has another number of values");
    const double* next = all.data();
    (take(next, values), ...);
  }
  template <class T>
  void rows(const std::string& name, std::vector<T>& values) {
    const auto& cells = column<std::vector<Cell<T>>>(from_, name);
    constexpr std::size_t width = sizeof(T) / sizeof(Cell<T>);
    require_user(cells.size() % width == 0, "column " + name + " has rows of another length");
    values.resize(cells.size() / width);
    if (!values.empty()) std::memcpy(static_cast<void*>(values.data()), cells.data(), values.size() * sizeof(T));
  }
  void text(const std::string& name, std::string& value) { value = column<std::string>(from_, name); }

 private:
  template <class T>
  static constexpr std::size_t count() {
    return std::is_arithmetic_v<T> || std::is_enum_v<T> ? 1 : sizeof(T) / sizeof(double);
  }
  template <class T>
  static void take(const double*& next, T& value) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
      value = static_cast<T>(*next);
    else
      std::memcpy(static_cast<void*>(&value), next, sizeof(T));
    next += count<T>();
  }
  const Columns& from_;
};

}  // namespace base
