#include "fem/output.hpp"

#include <fmt/format.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "base/pvd.hpp"
#include "fem/communication.hpp"
#include "fem/families.hpp"

namespace fem {
namespace {

vtkSmartPointer<vtkDoubleArray> array(const char* name, int components, vtkIdType tuples) {
  auto result = vtkSmartPointer<vtkDoubleArray>::New();
  result->SetName(name);
  result->SetNumberOfComponents(components);
  result->SetNumberOfTuples(tuples);
  return result;
}

vtkSmartPointer<vtkDoubleArray> stress_array(const char* name, vtkIdType tuples) {
  constexpr const char* components[6] = {"xx", "yy", "zz", "xy", "yz", "xz"};
  auto result = array(name, 6, tuples);
  for (int c = 0; c < 6; ++c) result->SetComponentName(c, components[c]);
  return result;
}

using Grid = vtkSmartPointer<vtkUnstructuredGrid>;

/// VTK's cells and the order in which they take gmsh's nodes.
struct CellKind {
  int nodes, type;
  std::array<int, 20> order;
};
constexpr CellKind cell_kinds[] = {
    {4, VTK_TETRA, {0, 1, 2, 3}},
    {8, VTK_HEXAHEDRON, {0, 1, 2, 3, 4, 5, 6, 7}},
    {10, VTK_QUADRATIC_TETRA, {0, 1, 2, 3, 4, 5, 6, 7, 9, 8}},
    {20, VTK_QUADRATIC_HEXAHEDRON, {0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15}}};

}  // namespace

struct Output::Impl {
  const Setup& setup;
  const std::vector<Mesh>& meshes;
  const Layout& layout;
  const Assembly& assembly;
  std::vector<std::vector<int>> elements;  // per body: in the order in which stresses are gathered; first rank
  std::map<std::string, std::pair<base::Pvd, int>> collections;  // per file: and its number of pictures
  std::map<std::string, std::pair<std::string, int>> earlier;    // per body: what a checkpoint says of it

  void start() {
    for (int b = 0; b < static_cast<int>(meshes.size()); ++b)
      elements.push_back(gathered<int>(layout.comm, assembly.elements_of(b), MPI_INT));
  }

  /// The body's cells; made for every picture, since between pictures they would be half of what a model needs.
  Grid grid_of(int b) const {
    const Mesh& mesh = meshes[b];
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (const auto& node : mesh.nodes) points->InsertNextPoint(node.x, node.y, node.z);
    auto grid = Grid::New();
    grid->SetPoints(points);
    grid->Allocate(mesh.element_count());
    vtkNew<vtkIntArray> region;
    region->SetName("region");
    for (int e = 0; e < mesh.element_count(); ++e) {
      const CellKind& kind = *std::ranges::find(cell_kinds, mesh.element_nodes, &CellKind::nodes);
      vtkIdType nodes[20];
      for (int a = 0; a < kind.nodes; ++a) nodes[a] = mesh.element(e)[kind.order[a]];
      grid->InsertNextCell(kind.type, kind.nodes, nodes);
      region->InsertNextValue(mesh.regions[e]);
    }
    grid->GetCellData()->AddArray(region);
    return grid;
  }

  void set_points(Grid& grid, int b, const char* name, const std::vector<double>& values) const {
    const auto nodes = static_cast<vtkIdType>(meshes[b].nodes.size());
    auto data = array(name, 3, nodes);
    for (vtkIdType i = 0; i < nodes; ++i) {
      data->SetTuple(i, values.data() + 3 * static_cast<std::size_t>(layout.petsc_of_global[layout.first_node[b] + i]));
    }
    grid->GetPointData()->AddArray(data);
  }

  /// `plastic` is empty where no law of the body knows plastic strain.
  void set_cells(Grid& grid, int b, const std::vector<double>& stresses, const std::vector<double>& plastic) const {
    auto stress = stress_array("stress", meshes[b].element_count()),
         mises = array("von_mises", 1, meshes[b].element_count()),
         principals = array("principal_stress", 3, meshes[b].element_count());
    for (std::size_t i = 0; i < elements[b].size(); ++i) {
      stress->SetTuple(elements[b][i], stresses.data() + 6 * i);
      std::array<double, 6> values;
      std::copy_n(stresses.data() + 6 * i, 6, values.begin());
      mises->SetValue(elements[b][i], von_mises(values));
      const auto values_principal = principal(values);
      principals->SetTuple(elements[b][i], values_principal.data());
    }
    grid->GetCellData()->AddArray(stress);
    grid->GetCellData()->AddArray(mises);
    grid->GetCellData()->AddArray(principals);
    if (plastic.empty()) return;
    auto strain = array("plastic_strain", 1, meshes[b].element_count());
    for (std::size_t i = 0; i < elements[b].size(); ++i) strain->SetValue(elements[b][i], plastic[i]);
    grid->GetCellData()->AddArray(strain);
  }

  /// Stress at nodes: the mean of the elements around each, in the order of the mesh (VTK's filter sums in any).
  void smooth(Grid& grid, int b) const {
    const Mesh& mesh = meshes[b];
    vtkDataArray* of_elements = grid->GetCellData()->GetArray("stress");
    const auto nodes = static_cast<vtkIdType>(mesh.nodes.size());
    std::vector<std::array<double, 6>> means(mesh.nodes.size(), std::array<double, 6>{});
    std::vector<int> counts(mesh.nodes.size(), 0);
    for (int e = 0; e < mesh.element_count(); ++e) {
      double values_of[6];
      of_elements->GetTuple(e, values_of);
      for (int a = 0; a < mesh.element_nodes; ++a) {
        const int node = mesh.element(e)[a];
        ++counts[node];
        for (int i = 0; i < 6; ++i) means[node][i] += values_of[i];
      }
    }
    auto stress = stress_array("nodal_stress", nodes), mises = array("nodal_von_mises", 1, nodes),
         principals = array("nodal_principal_stress", 3, nodes);
    for (vtkIdType i = 0; i < nodes; ++i) {
      auto& values = means[i];
      for (double& value : values) value /= std::max(1, counts[i]);
      stress->SetTuple(i, values.data());
      mises->SetValue(i, von_mises(values));
      principals->SetTuple(i, principal(values).data());
    }
    for (const auto& data : {stress, mises, principals}) grid->GetPointData()->AddArray(data);
  }

  /// A picture's file, its line in the collection, and what the collection's file holds then.
  struct Place {
    std::filesystem::path file;
    base::Pvd collection;
    std::string collection_text;
  };

  /// The next number in the body's collection.
  Place next_place(int b, const std::string& directory, double time) {
    const std::string& name = setup.bodies[b].name;
    const auto collection_file = std::filesystem::path(directory) / (name + ".pvd");
    const auto [known_file, fresh] = collections.try_emplace(collection_file.string(), base::Pvd(collection_file), 0);
    auto& [collection, count] = known_file->second;
    if (const auto known = earlier.find(name); fresh && known != earlier.end()) {
      collection.go_on_after(known->second.first);
      count = known->second.second;
    }
    const std::string file = fmt::format("{0}/{0}_{1:04d}.vtu", name, count++);
    std::string text = collection.enter(time, file);
    return {std::filesystem::path(directory) / file, base::Pvd(collection_file), std::move(text)};
  }

  void write_file(const Grid& grid, const Place& place) const {
    std::error_code failure;
    std::filesystem::create_directories(place.file.parent_path(), failure);
    // A collection that is on the disk may name this file already, of a run that this one goes on from.
    const auto temporary = place.file.string() + ".part";
    vtkNew<vtkXMLUnstructuredGridWriter> writer;
    writer->SetFileName(temporary.c_str());
    writer->SetInputData(grid);
    const bool written = !failure && writer->Write() == 1 && writer->GetErrorCode() == 0;
    if (written) std::filesystem::rename(temporary, place.file, failure);
    if (!written || failure)
      throw base::MachineError("cannot write " + place.file.string() + ": is the disk full or read-only?");
    place.collection.write(place.collection_text);
  }

  /// What a picture needs of the instant; on the first rank.
  struct Values {
    std::vector<double> displacement, velocity, acceleration, reactions;
    std::vector<std::vector<double>> stresses, plastic;  // by body
  };

  void write_body(int b, const Values& values, const Place& place) const {
    Grid grid = grid_of(b);
    set_points(grid, b, "displacement", values.displacement);
    set_points(grid, b, "velocity", values.velocity);
    if (!values.acceleration.empty()) set_points(grid, b, "acceleration", values.acceleration);
    if (!values.reactions.empty()) set_points(grid, b, "reaction", values.reactions);
    set_cells(grid, b, values.stresses[b], values.plastic[b]);
    smooth(grid, b);
    write_file(grid, place);
  }
};

Output::Output(const Setup& setup, const std::vector<Mesh>& meshes, const Layout& layout, const Assembly& assembly)
    : impl_(std::make_unique<Impl>(Impl{setup, meshes, layout, assembly, {}, {}, {}})) {}

Output::~Output() = default;

void Output::save(base::Columns& columns) const {
  for (const auto& [file, pictures] : impl_->collections) {
    const std::string head = "pictures/" + std::filesystem::path(file).stem().string();
    columns[head + "/entries"] = pictures.first.entries();
    columns[head + "/count"] = std::vector<int>{pictures.second};
  }
}

void Output::restore(const base::Columns& columns) {
  for (const auto& body : impl_->setup.bodies) {
    const std::string head = "pictures/" + body.name;
    const auto& count = base::column<std::vector<int>>(columns, head + "/count");
    if (count.size() != 1) continue;
    impl_->earlier[body.name] = {base::column<std::string>(columns, head + "/entries"), count[0]};
  }
}

void Output::write(const std::string& directory, const Frame& frame) {
  const auto file = picture(directory, frame);
  on_first_rank(impl_->layout.comm, [&] { file(); });
}

std::function<void()> Output::picture(const std::string& directory, const Frame& frame) {
  Impl& impl = *impl_;
  const MPI_Comm comm = impl.layout.comm;
  if (impl.elements.empty()) impl.start();
  const auto values = std::make_shared<Impl::Values>();
  const auto of_field = [&](const NodalField& field) {
    return gathered<double>(comm, {field.data(), static_cast<std::size_t>(field.owned_size())}, MPI_DOUBLE);
  };
  values->displacement = gathered<double>(comm, frame.displacement, MPI_DOUBLE);
  values->velocity = of_field(frame.velocity);
  if (frame.acceleration) values->acceleration = of_field(*frame.acceleration);
  if (frame.reactions) values->reactions = gathered<double>(comm, *frame.reactions, MPI_DOUBLE);
  const int bodies = static_cast<int>(impl.meshes.size());
  for (int b = 0; b < bodies; ++b) {
    const auto own = impl.assembly.stresses(b, frame.strained, &frame.velocity);
    values->stresses.push_back(
        gathered<double>(comm, {own.empty() ? nullptr : own.front().data(), 6 * own.size()}, MPI_DOUBLE));
    values->plastic.emplace_back();
    if (std::ranges::any_of(impl.setup.bodies[b].materials, keeps_history))
      values->plastic.back() = gathered<double>(comm, impl.assembly.plastic_strains(b), MPI_DOUBLE);
  }
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  if (rank > 0) return {};
  std::vector<Impl::Place> places;
  for (int b = 0; b < bodies; ++b) places.push_back(impl.next_place(b, directory, frame.time));
  return [&impl, values, places = std::move(places)] {
    for (std::size_t b = 0; b < places.size(); ++b) impl.write_body(static_cast<int>(b), *values, places[b]);
  };
}

}  // namespace fem
