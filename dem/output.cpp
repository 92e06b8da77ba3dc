#include "dem/output.hpp"

#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkExecutive.h>
#include <vtkFloatArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkTypeInt64Array.h>
#include <vtkXMLPolyDataWriter.h>

#include <algorithm>
#include <cstdio>
#include <numbers>
#include <set>
#include <system_error>

#include "base/error.hpp"

namespace dem {
namespace {

namespace fs = std::filesystem;

/// Adds (l ⊗ f + f ⊗ l) / 2.
void add_dyad(SymmetricStress& sum, const Vec3& l, const Vec3& f) {
  sum[0] += l.x * f.x;
  sum[1] += l.y * f.y;
  sum[2] += l.z * f.z;
  sum[3] += 0.5 * (l.x * f.y + l.y * f.x);
  sum[4] += 0.5 * (l.y * f.z + l.z * f.y);
  sum[5] += 0.5 * (l.x * f.z + l.z * f.x);
}

std::unordered_map<std::int64_t, std::size_t> index_by_id(std::span<const Grain> grains) {
  std::unordered_map<std::int64_t, std::size_t> index;
  index.reserve(grains.size());
  for (std::size_t i = 0; i < grains.size(); ++i) index.emplace(grains[i].id, i);
  return index;
}

/// Of every grain: the grains it touches, and its contacts with walls.
std::vector<int> coordination(std::span<const Grain> grains, std::span<const GrainContact> grain_contacts,
                              std::span<const WallContact> wall_contacts) {
  const auto index = index_by_id(grains);
  std::vector<int> count(grains.size(), 0);
  const auto add = [&](std::int64_t id) {
    if (const auto found = index.find(id); found != index.end()) ++count[found->second];
  };
  std::set<std::pair<std::int64_t, std::int64_t>> neighbours;  // clumps touch at several spheres
  for (const auto& contact : grain_contacts) {
    if (!neighbours.insert(std::minmax(contact.id_i, contact.id_j)).second) continue;
    add(contact.id_i);
    add(contact.id_j);
  }
  for (const auto& contact : wall_contacts) add(contact.id);
  return count;
}

const Clump& shape_of(const Grain& grain, std::span<const Clump> shapes) {
  base::require_internal(grain.shape < static_cast<int>(shapes.size()), "a grain of unknown shape");
  return shapes[static_cast<std::size_t>(grain.shape)];
}

/// Radius [m] of that sphere of a grain that is centred here.
double radius_at(const Grain& grain, const Vec3& centre, std::span<const Clump> shapes) {
  if (grain.shape < 0) return grain.radius;
  const auto spheres = placed_spheres(grain, shapes);
  return std::min_element(
             spheres.begin(), spheres.end(),
             [&](const Sphere& a, const Sphere& b) { return norm2(a.position - centre) < norm2(b.position - centre); })
      ->radius;
}

/// A named array with one tuple of `components` doubles, stored as `Array`'s type, per item.
template <class Array>
vtkNew<Array> named_array(const char* name, int components, std::size_t items) {
  vtkNew<Array> array;
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(static_cast<vtkIdType>(items));
  return array;
}

template <class Array>
void set_vector(Array& array, std::size_t item, const Vec3& value) {
  array->SetTuple3(static_cast<vtkIdType>(item), value.x, value.y, value.z);
}

std::string numbered_file(const char* stem, int number) {
  char name[64];
  std::snprintf(name, sizeof name, "%s/%s_%04d.vtp", stem, stem, number);
  return name;
}

void make_folder(const fs::path& folder) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure) throw base::MachineError("cannot make the folder " + folder.string() + ": " + failure.message());
}

void write_file(const fs::path& file, vtkPolyData* data) {
  vtkNew<vtkXMLPolyDataWriter> writer;
  // An observer of its errors keeps VTK from printing them: the exception below says it in our words.
  vtkNew<vtkCallbackCommand> quiet;
  quiet->SetCallback([](vtkObject*, unsigned long, void*, void*) {});
  writer->AddObserver(vtkCommand::ErrorEvent, quiet);
  writer->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, quiet);
  // A collection that is on the disk may name this file already, of a run that this one goes on from.
  const std::string temporary = file.string() + ".part";
  writer->SetFileName(temporary.c_str());
  writer->SetInputData(data);
  const bool written = writer->Write() != 0 && writer->GetErrorCode() == 0;
  std::error_code failure;
  if (written) fs::rename(temporary, file, failure);
  if (!written || failure)
    throw base::MachineError("cannot write " + file.string() + ": is the disk full or read-only?");
}

}  // namespace

double volume(const Grain& grain, std::span<const Clump> shapes) {
  const double size = grain.shape < 0 ? grain.radius : grain.radius / shape_of(grain, shapes).reach;
  const double of_unit_size = grain.shape < 0 ? 4.0 / 3.0 * std::numbers::pi : shape_of(grain, shapes).volume;
  return of_unit_size * size * size * size;
}

std::vector<Sphere> placed_spheres(const Grain& grain, std::span<const Clump> shapes) {
  if (grain.shape < 0) return {{grain.position, grain.radius}};
  const Clump& shape = shape_of(grain, shapes);
  const double size = grain.radius / shape.reach;
  std::vector<Sphere> spheres;
  for (const Sphere& s : shape.spheres)
    spheres.push_back({grain.position + to_space(grain.orientation, size * s.position), size * s.radius});
  return spheres;
}

std::vector<SymmetricStress> grain_stress(std::span<const Grain> grains, std::span<const GrainContact> grain_contacts,
                                          std::span<const WallContact> wall_contacts, std::span<const Clump> shapes) {
  const auto index = index_by_id(grains);
  std::vector<SymmetricStress> stress(grains.size(), SymmetricStress{});
  const auto add = [&](std::int64_t id, const auto& lever, const Vec3& force) {
    if (const auto found = index.find(id); found != index.end())
      add_dyad(stress[found->second], lever(grains[found->second]), force);
  };
  for (const auto& contact : grain_contacts) {
    const Vec3 branch = contact.position_j - contact.position_i;
    const double distance = norm(branch);
    if (distance == 0) continue;  // two grains on one spot: no direction, no lever
    const Vec3 direction = branch * (1.0 / distance);
    // From the grain's centre to the middle of the overlap, by the sphere that touches.
    const auto lever = [&](const Grain& grain, const Vec3& centre, double sign) {
      return centre - grain.position + direction * (sign * (radius_at(grain, centre, shapes) - 0.5 * contact.overlap));
    };
    add(
        contact.id_i, [&](const Grain& grain) { return lever(grain, contact.position_i, 1); }, contact.force);
    add(
        contact.id_j, [&](const Grain& grain) { return lever(grain, contact.position_j - contact.period, -1); },
        -contact.force);
  }
  for (const auto& contact : wall_contacts)
    add(
        contact.id, [&](const Grain& grain) { return contact.point - grain.position; }, contact.force);
  for (std::size_t i = 0; i < grains.size(); ++i) {
    const double solid = volume(grains[i], shapes);
    for (double& component : stress[i]) component /= solid;
  }
  return stress;
}

Writer::Writer(fs::path run_directory, std::span<const Grain> reference, std::vector<Clump> shapes,
               const std::array<Period, 3>& periods)
    : run_directory_(std::move(run_directory)),
      shapes_(std::move(shapes)),
      periods_(periods),
      grains_collection_(run_directory_ / "grains.pvd"),
      contacts_collection_(run_directory_ / "contacts.pvd") {
  make_folder(run_directory_ / "grains");
  reference_.reserve(reference.size());
  for (const Grain& grain : reference) reference_.emplace(grain.id, grain.position);
}

void Writer::write(double time, std::span<const Grain> grains, std::span<const GrainContact> grain_contacts,
                   std::span<const WallContact> wall_contacts) {
  struct Point {
    std::size_t grain;
    Sphere sphere;
  };
  std::vector<Point> spheres;
  for (std::size_t g = 0; g < grains.size(); ++g)
    for (const Sphere& sphere : placed_spheres(grains[g], shapes_)) spheres.push_back({g, sphere});
  const std::size_t n = spheres.size();
  const auto stress_values = grain_stress(grains, grain_contacts, wall_contacts, shapes_);
  const auto contact_numbers = coordination(grains, grain_contacts, wall_contacts);

  // Positions and displacements in double: settlements are microns on metres. Pictures need no more than float
  // elsewhere.
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(static_cast<vtkIdType>(n));
  vtkNew<vtkCellArray> vertices;
  auto id = named_array<vtkTypeInt64Array>("id", 1, n);
  auto radius = named_array<vtkDoubleArray>("radius", 1, n);
  auto velocity = named_array<vtkFloatArray>("velocity", 3, n);
  auto angular_velocity = named_array<vtkFloatArray>("angular_velocity", 3, n);
  auto displacement = named_array<vtkDoubleArray>("displacement", 3, n);
  auto contacts = named_array<vtkIntArray>("coordination", 1, n);
  auto stress = named_array<vtkFloatArray>("stress", 6, n);
  auto vertical_stress = named_array<vtkFloatArray>("vertical_stress", 1, n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto& [g, sphere] = spheres[i];
    const Grain& grain = grains[g];
    const auto item = static_cast<vtkIdType>(i);
    points->SetPoint(item, sphere.position.x, sphere.position.y, sphere.position.z);
    vertices->InsertNextCell(1, &item);
    id->SetValue(item, grain.id);
    radius->SetValue(item, sphere.radius);
    set_vector(velocity, i, grain.velocity);
    set_vector(angular_velocity, i, grain.angular_velocity);
    const auto start = reference_.find(grain.id);
    set_vector(displacement, i,
               start == reference_.end() ? Vec3{} : nearest_image(grain.position - start->second, periods_));
    contacts->SetValue(item, contact_numbers[g]);
    stress->SetTuple(item, stress_values[g].data());
    vertical_stress->SetValue(item, static_cast<float>(stress_values[g][2]));
  }

  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetVerts(vertices);
  for (vtkDataArray* array : std::initializer_list<vtkDataArray*>{id, radius, velocity, angular_velocity, displacement,
                                                                  contacts, stress, vertical_stress})
    data->GetPointData()->AddArray(array);
  const std::string file = numbered_file("grains", grain_levels_);
  write_file(run_directory_ / file, data);
  grains_collection_.add(time, file);
  ++grain_levels_;
}

void Writer::write_contacts(double time, std::span<const GrainContact> grain_contacts,
                            std::span<const WallContact> wall_contacts) {
  if (contact_levels_ == 0) make_folder(run_directory_ / "contacts");
  const std::size_t n = grain_contacts.size() + wall_contacts.size();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(static_cast<vtkIdType>(2 * n));
  vtkNew<vtkCellArray> lines;
  auto force = named_array<vtkFloatArray>("force", 1, n);
  auto normal_force = named_array<vtkFloatArray>("normal_force", 1, n);
  auto wall = named_array<vtkIntArray>("wall", 1, n);
  vtkIdType segment = 0;
  const auto add = [&](const Vec3& from, const Vec3& to, const Vec3& force_on_first, int wall_number) {
    const vtkIdType ends[2] = {2 * segment, 2 * segment + 1};
    points->SetPoint(ends[0], from.x, from.y, from.z);
    points->SetPoint(ends[1], to.x, to.y, to.z);
    lines->InsertNextCell(2, ends);
    const Vec3 towards_first = from - to;
    const double length = norm(towards_first);
    force->SetValue(segment, static_cast<float>(norm(force_on_first)));
    normal_force->SetValue(segment, length > 0 ? static_cast<float>(dot(force_on_first, towards_first) / length) : 0);
    wall->SetValue(segment, wall_number);
    ++segment;
  };
  for (const auto& contact : grain_contacts) add(contact.position_i, contact.position_j, contact.force, -1);
  for (const auto& contact : wall_contacts) add(contact.grain_position, contact.point, contact.force, contact.wall);

  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetLines(lines);
  for (vtkDataArray* array : std::initializer_list<vtkDataArray*>{force, normal_force, wall})
    data->GetCellData()->AddArray(array);
  const std::string file = numbered_file("contacts", contact_levels_);
  write_file(run_directory_ / file, data);
  contacts_collection_.add(time, file);
  ++contact_levels_;
}

template <class Self, class Walk>
void Writer::walk(Self& self, Walk&& walk) {
  std::vector<std::int64_t> ids;
  std::vector<Vec3> positions;
  std::string grains = self.grains_collection_.entries(), contacts = self.contacts_collection_.entries();
  for (const auto& [id, position] : self.reference_) {
    ids.push_back(id);
    positions.push_back(position);
  }
  walk.rows("reference/id", ids);
  walk.rows("reference/position", positions);
  walk.numbers("levels", self.grain_levels_, self.contact_levels_);
  walk.text("grains", grains);
  walk.text("contacts", contacts);
  if constexpr (std::remove_reference_t<Walk>::loads) {
    base::require_user(ids.size() == positions.size(), "positions at the zero of displacement are missing");
    self.reference_.clear();
    for (std::size_t g = 0; g < ids.size(); ++g) self.reference_.emplace(ids[g], positions[g]);
    self.grains_collection_.go_on_after(grains);
    self.contacts_collection_.go_on_after(contacts);
  }
}

base::Columns Writer::save() const {
  base::Columns columns;
  walk(*this, base::Saver(columns));
  return columns;
}

void Writer::restore(const base::Columns& columns) { walk(*this, base::Loader(columns)); }

}  // namespace dem
