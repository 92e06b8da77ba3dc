// What the parts of a scene share: names, boxes, planes, mesh parameters.
#include <fmt/format.h>

#include <fstream>
#include <regex>
#include <sstream>

#include "base/text.hpp"
#include "coupling/scene_parts.hpp"

namespace coupling {

using base::fail;
using base::Value;

std::vector<std::string> names_of(const Value::List& rows) {
  std::vector<std::string> names;
  for (const auto& row : rows) names.push_back(row.at("name").text());
  return names;
}

void require_unique(const Value::List& rows, const std::string& noun) {
  std::map<std::string, const Value*> first;
  for (const auto& row : rows) {
    const Value& name = row.at("name");
    const auto [known, added] = first.emplace(name.text(), &name);
    // Their results would fall on the grains' and the run's own.
    for (const char* taken : {"grains", "contacts", "pictures", "time", "stage"})
      if (name.text() == taken)
        fail(name, fmt::format("is a name that results use themselves; no {} may have it", noun), "take another name");
    if (!added) fail(name, fmt::format("a {} of this name stands at {}", noun, known->second->origin()), "rename one");
  }
}

void require_known(const Value& text, const std::vector<std::string>& known, const std::string& noun,
                   const std::string& plural) {
  for (const auto& name : known) {
    if (name == text.text()) return;
  }
  fail(text, fmt::format("no such {}", noun), base::suggest(text.text(), known, plural));
}

Box read_box(const Value& value) {
  const Box box{value.at("lower").vector(), value.at("upper").vector()};
  for (int axis = 0; axis < 3; ++axis) {
    if (!(box.upper[axis] > box.lower[axis])) {
      fail(value, fmt::format("has no thickness along {}: {} .. {} m", "xyz"[axis], box.lower[axis], box.upper[axis]),
           "make upper larger than lower along every axis");
    }
  }
  return box;
}

dem::Plane read_plane(const Value& value) {
  const Vec3 normal = value.at("normal").vector();
  const double length = base::norm(normal);
  if (!(length > 0)) fail(value.at("normal"), "must not be zero", "give the direction that the plane faces");
  return {value.at("point").vector(), normal * (1.0 / length)};
}

std::map<std::string, double> read_numbers(const Value& value) {
  std::map<std::string, double> numbers;
  for (const auto& [name, number] : value.table()) numbers[name] = number.real();
  return numbers;
}

void require_mesh_parameters(const Value& table) {
  const Value& mesh = table.at("mesh");
  const Value& parameters = table.at("mesh_parameters");
  if (parameters.table().empty()) return;
  const auto& [first_name, first] = *parameters.table().begin();
  if (std::filesystem::path(mesh.text()).extension() != ".geo") {
    fail(first, "only a .geo file has parameters", "remove mesh_parameters");
  }
  std::ifstream in(mesh.text());
  std::stringstream text;
  text << in.rdbuf();
  const std::string geometry = text.str();
  // Parameters are what DefineConstant[...] holds: name = {value, ...} or name = value.
  std::vector<std::string> known;
  static const std::regex block(R"(DefineConstant\s*\[([^\]]*)\])"), entry(R"((\w+)\s*=\s*[\{0-9.\-])");
  for (std::sregex_iterator b(geometry.begin(), geometry.end(), block), end; b != end; ++b) {
    const std::string inside = (*b)[1].str();
    for (std::sregex_iterator e(inside.begin(), inside.end(), entry); e != end; ++e) known.push_back((*e)[1].str());
  }
  for (const auto& [name, value] : parameters.table()) {
    bool found = false;
    for (const auto& candidate : known) found = found || candidate == name;
    if (!found) fail(value, "no such parameter in " + mesh.text(), base::suggest(name, known, "parameters"));
  }
}

}  // namespace coupling
