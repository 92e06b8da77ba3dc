#pragma once
// A value of a scene file and where it was written: the neutral form between the file's syntax and the declarations.
#include <cstdint>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "base/vec3.hpp"

namespace base {

class Value {
 public:
  using List = std::vector<Value>;
  using Table = std::map<std::string, Value>;
  using Data = std::variant<bool, std::int64_t, double, std::string, List, Table>;

  Data data = Table{};
  std::string key;   // full dotted path, "body.sleeper.material.density"
  std::string file;  // as the user named it; "--set" for an override
  int line = 0;      // 0: none

  Value() = default;
  explicit Value(Data d) : data(std::move(d)) {}

  template <class T>
  bool is() const {
    return std::holds_alternative<T>(data);
  }
  bool is_number() const { return is<double>() || is<std::int64_t>(); }

  // ---- access to checked values; a wrong kind or name is our own mistake (base::InternalError)
  double real() const;
  std::int64_t integer() const;
  bool boolean() const;
  const std::string& text() const;
  const List& list() const;
  const Table& table() const;
  List& list();
  Table& table();
  Vec3 vector() const;
  std::vector<double> reals() const;
  std::vector<std::string> texts() const;

  const Value* find(const std::string& name) const;  // of a table; null when absent
  bool has(const std::string& name) const { return find(name) != nullptr; }
  const Value& at(const std::string& name) const;
  Value& at(const std::string& name);
  /// Adds or replaces an entry of a table; it inherits the table's origin.
  Value& set(const std::string& name, Data);
  /// The rows of a list of tables; empty when absent.
  const List& rows(const std::string& name) const;

  std::string origin() const;  // "scene.toml:12" or "--set"
};

/// As it would be written in a scene file; long lists are cut short.
std::string show(const Value&);

/// Throws base::UserError "origin: key = value; rule; remedy".
[[noreturn]] void fail(const Value&, const std::string& rule, const std::string& remedy = "");

}  // namespace base
