#include "dem/stone.hpp"

#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkCellArrayIterator.h>
#include <vtkExecutive.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSTLReader.h>
#include <vtkSmartPointer.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <numeric>

#include "base/error.hpp"

namespace dem {
namespace {

std::string place(const Vec3& p) {
  std::array<char, 100> text{};
  std::snprintf(text.data(), text.size(), "(%.6g, %.6g, %.6g)", p.x, p.y, p.z);
  return text.data();
}

std::string edge_text(const Stone& stone, const std::pair<int, int>& edge) {
  return "from " + place(stone.corners[static_cast<std::size_t>(edge.first)]) + " to " +
         place(stone.corners[static_cast<std::size_t>(edge.second)]) + " m";
}

/// How many triangles run along each edge in that direction.
std::map<std::pair<int, int>, int> directed_edges(const Stone& stone) {
  std::map<std::pair<int, int>, int> edges;
  for (const auto& t : stone.triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  }
  return edges;
}

/// Corners that no path of triangles leads to from the first triangle; unused corners are left out.
bool in_one_piece(const Stone& stone) {
  std::vector<int> leads_to(stone.corners.size());
  std::iota(leads_to.begin(), leads_to.end(), 0);
  const auto root = [&](int i) {
    while (leads_to[static_cast<std::size_t>(i)] != i) i = leads_to[static_cast<std::size_t>(i)];
    return i;
  };
  for (const auto& t : stone.triangles) {
    for (const int corner : {t[1], t[2]}) leads_to[static_cast<std::size_t>(root(corner))] = root(t[0]);
  }
  return std::all_of(stone.triangles.begin(), stone.triangles.end(),
                     [&](const auto& t) { return root(t[0]) == root(stone.triangles[0][0]); });
}

VolumeMoments moments(const Stone& stone, const Vec3& origin) {
  VolumeMoments m;
  for (const auto& t : stone.triangles) {
    std::array<Vec3, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = stone.corners[static_cast<std::size_t>(t[i])] - origin;
    const double volume = dot(p[0], cross(p[1], p[2])) / 6;
    const Vec3 sum = p[0] + p[1] + p[2];
    m.volume += volume;
    m.first += (volume / 4) * sum;
    for (const Vec3& corner : p) add_product(m.second, volume / 20, corner, corner);
    add_product(m.second, volume / 20, sum, sum);
  }
  return m;
}

Stone read_triangles(const std::filesystem::path& path) {
  const std::string name = path.string();
  base::require_user(std::ifstream(path).good(), name + ": cannot be read; must be an STL file");
  vtkNew<vtkSTLReader> reader;
  std::string trouble;
  vtkNew<vtkCallbackCommand> listener;
  listener->SetClientData(&trouble);
  listener->SetCallback([](vtkObject*, unsigned long, void* text, void* message) {
    *static_cast<std::string*>(text) = message ? static_cast<const char*>(message) : "unknown error";
  });
  for (vtkObject* source : {static_cast<vtkObject*>(reader.Get()), static_cast<vtkObject*>(reader->GetExecutive())}) {
    source->AddObserver(vtkCommand::ErrorEvent, listener);
    source->AddObserver(vtkCommand::WarningEvent, listener);
  }
  reader->SetFileName(name.c_str());
  reader->Update();
  vtkPolyData* surface = reader->GetOutput();
  base::require_user(trouble.empty() && surface->GetNumberOfCells() > 0,
                     name + ": no triangles found; must be an STL file (text or binary)");
  Stone stone;
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i) {
    std::array<double, 3> p{};
    surface->GetPoint(i, p.data());
    stone.corners.push_back({p[0], p[1], p[2]});
  }
  const auto cell = vtk::TakeSmartPointer(surface->GetPolys()->NewIterator());
  for (cell->GoToFirstCell(); !cell->IsDoneWithTraversal(); cell->GoToNextCell()) {
    vtkIdType count = 0;
    const vtkIdType* ids = nullptr;
    cell->GetCurrentCell(count, ids);
    stone.triangles.push_back({static_cast<int>(ids[0]), static_cast<int>(ids[1]), static_cast<int>(ids[2])});
  }
  return stone;
}

}  // namespace

void check_closed(const Stone& stone) {
  const auto edges = directed_edges(stone);
  std::size_t open = 0, doubled = 0;
  std::pair<int, int> first_open, first_doubled;
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    if (count > 1 && ++doubled == 1) first_doubled = edge;
    if (back == edges.end() && count == 1 && ++open == 1) first_open = edge;
  }
  if (doubled > 0) {
    throw base::UserError("the surface bounds no body: " + std::to_string(doubled) +
                          " edges have two triangles that run along them in one direction, the first " +
                          edge_text(stone, first_doubled) +
                          "; give all triangles the same sense and remove walls inside the body");
  }
  if (open > 0) {
    throw base::UserError("the surface is not closed: " + std::to_string(open) +
                          " edges belong to one triangle only, the first " + edge_text(stone, first_open) +
                          "; close the holes and let neighbouring triangles share their corners exactly");
  }
  base::require_user(in_one_piece(stone), "the surface is in several pieces; give one stone per file");
}

Stone read_stl(const std::filesystem::path& path, double metres_per_unit) {
  Stone stone = read_triangles(path);
  for (Vec3& corner : stone.corners) corner *= metres_per_unit;
  try {
    check_closed(stone);
  } catch (const base::UserError& error) {
    throw base::UserError(path.string() + ": " + error.what());
  }
  if (moments(stone, stone.corners[0]).volume < 0) {
    for (auto& triangle : stone.triangles) std::swap(triangle[1], triangle[2]);
  }
  return stone;
}

std::string stl_text(const Stone& stone, const std::string& name) {
  std::string text = "solid " + name + "\n";
  const auto line = [&](const char* words, const Vec3& v) {
    std::array<char, 120> buffer{};
    // + 0.0: no "-0.000000", which would depend on the last bit.
    const auto rounded = [](double x) { return std::round(1e6 * x) / 1e6 + 0.0; };
    std::snprintf(buffer.data(), buffer.size(), "%s %.6f %.6f %.6f\n", words, rounded(v.x), rounded(v.y), rounded(v.z));
    text += buffer.data();
  };
  for (const auto& t : stone.triangles) {
    std::array<Vec3, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = stone.corners[static_cast<std::size_t>(t[i])];
    const Vec3 normal = cross(p[1] - p[0], p[2] - p[0]);
    line("facet normal", (1.0 / std::max(norm(normal), 1e-300)) * normal);
    text += "outer loop\n";
    for (const Vec3& corner : p) line("vertex", corner);
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid " + name + "\n";
}

MassProperties mass_properties(const Stone& stone) {
  const Vec3 origin = stone.corners.front();
  return mass_properties(moments(stone, origin), origin);
}

std::vector<Sphere> corner_spheres(const Stone& stone) {
  std::vector<Sphere> spheres;
  for (const Vec3& corner : stone.corners) spheres.push_back({corner, 0});
  return spheres;
}

}  // namespace dem
