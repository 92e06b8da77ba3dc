#include "coupling/render_layers.hpp"

#include <vtkBoundingBox.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellDataToPointData.h>
#include <vtkCleanPolyData.h>
#include <vtkCutter.h>
#include <vtkDataSetSurfaceFilter.h>
#include <vtkDoubleArray.h>
#include <vtkExtractEdges.h>
#include <vtkFeatureEdges.h>
#include <vtkGlyph3DMapper.h>
#include <vtkNew.h>
#include <vtkPlane.h>
#include <vtkPointData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkSphereSource.h>
#include <vtkThreshold.h>
#include <vtkTubeFilter.h>
#include <vtkXMLGenericDataObjectReader.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "base/error.hpp"

namespace coupling {
namespace {

template <class Data>
vtkSmartPointer<Data> read(const std::filesystem::path& file) {
  vtkNew<vtkXMLGenericDataObjectReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  vtkSmartPointer<Data> data = Data::SafeDownCast(reader->GetOutput());
  base::require_user(data != nullptr, file.string() + ": cannot be read; was the run cut off while writing it?");
  return data;
}

/// A body's grid as one part per material region, with its cell data also at its points.
void add_parts(const std::string& body, vtkUnstructuredGrid* grid, std::vector<SolidPart>& parts) {
  vtkDataArray* regions = grid->GetCellData()->GetArray("region");
  std::set<double> names;
  for (vtkIdType cell = 0; regions != nullptr && cell < grid->GetNumberOfCells(); ++cell)
    names.insert(regions->GetTuple1(cell));
  if (names.empty()) names.insert(0);
  for (double name : names) {
    vtkNew<vtkCellDataToPointData> average;
    vtkNew<vtkThreshold> of_region;
    if (regions != nullptr) {
      of_region->SetInputData(grid);
      of_region->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_CELLS, regions->GetName());
      of_region->SetLowerThreshold(name - 0.5);
      of_region->SetUpperThreshold(name + 0.5);
      of_region->SetThresholdFunction(vtkThreshold::THRESHOLD_BETWEEN);
      average->SetInputConnection(of_region->GetOutputPort());
    } else {
      average->SetInputData(grid);
    }
    average->PassCellDataOn();
    average->Update();
    SolidPart part{body, vtkUnstructuredGrid::SafeDownCast(average->GetOutput()), {}};
    part.grid->GetBounds(part.bounds.data());
    parts.push_back(part);
  }
}

double largest_radius(vtkPolyData* grains) { return grains->GetPointData()->GetArray("radius")->GetRange(0)[1]; }

/// The data in front of the eye by this much.
vtkSmartPointer<vtkPolyData> moved(vtkPolyData* data, double x) {
  auto result = vtkSmartPointer<vtkPolyData>::New();
  result->ShallowCopy(data);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(data->GetNumberOfPoints());
  for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i) {
    double p[3];
    data->GetPoint(i, p);
    points->SetPoint(i, p[0] + x, p[1], p[2]);
  }
  result->SetPoints(points);
  return result;
}

void paint(vtkMapper* mapper, vtkActor* actor, vtkColorTransferFunction* colours, const Colour& plain) {
  if (colours != nullptr) {
    mapper->SetLookupTable(colours);
    mapper->SetUseLookupTableScalarRange(true);
    mapper->SetScalarModeToUsePointData();
    mapper->SetColorModeToMapScalars();
    mapper->ScalarVisibilityOn();
  } else {
    mapper->ScalarVisibilityOff();
    actor->GetProperty()->SetColor(plain[0], plain[1], plain[2]);
  }
}

}  // namespace

std::array<double, 6> State::bounds() const {
  vtkBoundingBox box;
  if (has_grains()) {
    box.AddBounds(grains->GetBounds());
    box.Inflate(largest_radius(grains));
  }
  for (const auto& part : solids) box.AddBounds(part.bounds.data());
  std::array<double, 6> bounds{};
  box.GetBounds(bounds.data());
  return bounds;
}

State read_state(const RunDirectory& run, double time) {
  State state;
  state.time = time;
  if (!run.grains.empty()) state.grains = read<vtkPolyData>(nearest_level(run.grains, time).file);
  if (state.has_grains() && state.grains->GetPointData()->GetArray("radius") == nullptr)
    throw base::UserError(nearest_level(run.grains, time).file.string() + ": the grains have no radius");
  if (!run.contacts.empty()) state.contacts = read<vtkPolyData>(nearest_level(run.contacts, time).file);
  for (const auto& body : run.bodies)
    add_parts(body.name, read<vtkUnstructuredGrid>(nearest_level(body.levels, time).file), state.solids);
  std::erase_if(state.solids, [](const SolidPart& part) { return part.grid->GetNumberOfCells() == 0; });
  std::sort(state.solids.begin(), state.solids.end(), [](const SolidPart& a, const SolidPart& b) {
    return a.bounds[4] + a.bounds[5] < b.bounds[4] + b.bounds[5];
  });
  return state;
}

std::vector<double> show(vtkDataSet* data, Shown shown) {
  vtkDataArray* source = data->GetPointData()->GetArray(shown.array);
  if (source == nullptr || shown.component >= source->GetNumberOfComponents()) return {};
  const vtkIdType n = source->GetNumberOfTuples();
  std::vector<double> values(static_cast<std::size_t>(n));
  vtkNew<vtkDoubleArray> scalars;
  scalars->SetName("shown");
  scalars->SetNumberOfTuples(n);
  for (vtkIdType i = 0; i < n; ++i) {
    double value = 0;
    if (shown.component >= 0) {
      value = source->GetComponent(i, shown.component);
    } else {
      for (int c = 0; c < source->GetNumberOfComponents(); ++c) value = std::hypot(value, source->GetComponent(i, c));
    }
    values[static_cast<std::size_t>(i)] = value * shown.factor;
    scalars->SetValue(i, value * shown.factor);
  }
  data->GetPointData()->SetScalars(scalars);
  return values;
}

Actor spheres(vtkPolyData* grains, vtkColorTransferFunction* colours, Colour plain) {
  // Instances of one fine ball. Ray-cast spheres (vtkOpenGLSphereMapper) look no better and, without a graphics card,
  // take minutes for ten thousand grains.
  vtkNew<vtkSphereSource> ball;
  ball->SetRadius(1);
  ball->SetThetaResolution(16);
  ball->SetPhiResolution(12);
  vtkNew<vtkGlyph3DMapper> mapper;
  mapper->SetInputData(grains);
  mapper->SetSourceConnection(ball->GetOutputPort());
  mapper->OrientOff();
  mapper->SetScaleModeToScaleByMagnitude();
  mapper->SetScaleArray("radius");
  auto actor = Actor::New();
  paint(mapper, actor, colours, plain);
  actor->SetMapper(mapper);
  actor->GetProperty()->SetAmbient(0.15);
  actor->GetProperty()->SetDiffuse(0.85);
  actor->GetProperty()->SetSpecular(0.08);
  actor->GetProperty()->SetSpecularPower(15);
  return actor;
}

vtkSmartPointer<vtkPolyData> behind(vtkPolyData* grains, const Section& section) {
  const double back = largest_radius(grains);
  auto result = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  result->GetPointData()->CopyAllocate(grains->GetPointData());
  for (vtkIdType i = 0; i < grains->GetNumberOfPoints(); ++i) {
    double p[3];
    grains->GetPoint(i, p);
    if (p[0] > section.x) continue;
    const vtkIdType copy = points->InsertNextPoint(p[0] - back, p[1], p[2]);
    result->GetPointData()->CopyData(grains->GetPointData(), i, copy);
  }
  result->SetPoints(points);
  return result;
}

vtkSmartPointer<vtkPolyData> discs(vtkPolyData* grains, const Section& section) {
  constexpr int corners = 48;
  vtkDataArray* radius = grains->GetPointData()->GetArray("radius");
  vtkDataArray* scalars = grains->GetPointData()->GetScalars();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> polygons;
  vtkNew<vtkDoubleArray> values;
  values->SetName("shown");
  for (vtkIdType i = 0; i < grains->GetNumberOfPoints(); ++i) {
    double centre[3];
    grains->GetPoint(i, centre);
    const double away = centre[0] - section.x, square = radius->GetTuple1(i) * radius->GetTuple1(i) - away * away;
    if (square <= 0) continue;
    polygons->InsertNextCell(corners);
    for (int corner = 0; corner < corners; ++corner) {
      const double angle = 2 * std::numbers::pi * corner / corners;
      polygons->InsertCellPoint(points->InsertNextPoint(section.x, centre[1] + std::sqrt(square) * std::cos(angle),
                                                        centre[2] + std::sqrt(square) * std::sin(angle)));
      values->InsertNextValue(scalars != nullptr ? scalars->GetTuple1(i) : 0);
    }
  }
  auto result = vtkSmartPointer<vtkPolyData>::New();
  result->SetPoints(points);
  result->SetPolys(polygons);
  result->GetPointData()->SetScalars(values);
  return result;
}

vtkSmartPointer<vtkPolyData> section_of(const SolidPart& part, const Section& section) {
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(section.x, 0, 0);
  plane->SetNormal(1, 0, 0);
  vtkNew<vtkCutter> cut;
  cut->SetInputData(part.grid);
  cut->SetCutFunction(plane);
  cut->GenerateTrianglesOff();
  cut->GenerateCutScalarsOff();
  cut->Update();
  return cut->GetOutput();
}

vtkSmartPointer<vtkPolyData> surface_of(const SolidPart& part) {
  vtkNew<vtkDataSetSurfaceFilter> surface;
  surface->SetInputData(part.grid);
  surface->Update();
  return surface->GetOutput();
}

SolidPart deformed(const SolidPart& part, double scale) {
  vtkDataArray* displacement = part.grid->GetPointData()->GetArray("displacement");
  if (displacement == nullptr) return part;
  SolidPart result{part.body, vtkSmartPointer<vtkUnstructuredGrid>::New(), {}};
  result.grid->ShallowCopy(part.grid);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(part.grid->GetNumberOfPoints());
  for (vtkIdType i = 0; i < part.grid->GetNumberOfPoints(); ++i) {
    double p[3], u[3];
    part.grid->GetPoint(i, p);
    displacement->GetTuple(i, u);
    points->SetPoint(i, p[0] + scale * u[0], p[1] + scale * u[1], p[2] + scale * u[2]);
  }
  result.grid->SetPoints(points);
  result.grid->GetBounds(result.bounds.data());
  return result;
}

Actor faces(vtkPolyData* data, vtkColorTransferFunction* colours, Colour plain, bool lit) {
  vtkNew<vtkPolyDataMapper> mapper;
  auto actor = Actor::New();
  vtkNew<vtkPolyDataNormals> normals;
  normals->SetInputData(data);
  normals->SetFeatureAngle(30);
  if (lit)
    mapper->SetInputConnection(normals->GetOutputPort());
  else
    mapper->SetInputData(data);
  paint(mapper, actor, colours, plain);
  mapper->InterpolateScalarsBeforeMappingOn();
  actor->SetMapper(mapper);
  actor->GetProperty()->SetLighting(lit);
  actor->GetProperty()->SetAmbient(lit ? (colours != nullptr ? 0.5 : 0.3) : 1);
  actor->GetProperty()->SetDiffuse(lit ? (colours != nullptr ? 0.5 : 0.7) : 0);
  return actor;
}

Actor edges(vtkPolyData* data, bool outline_only, Colour colour, double opacity, double width, double in_front) {
  vtkNew<vtkCleanPolyData> clean;
  clean->SetInputData(data);
  vtkNew<vtkFeatureEdges> outline;
  outline->SetInputConnection(clean->GetOutputPort());
  outline->SetFeatureAngle(30);
  outline->NonManifoldEdgesOff();
  outline->ColoringOff();
  vtkNew<vtkExtractEdges> all;
  all->SetInputConnection(clean->GetOutputPort());
  vtkAlgorithm* source = outline_only ? static_cast<vtkAlgorithm*>(outline) : all;
  source->Update();
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(moved(vtkPolyData::SafeDownCast(source->GetOutputDataObject(0)), in_front));
  mapper->ScalarVisibilityOff();
  auto actor = Actor::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(colour[0], colour[1], colour[2]);
  actor->GetProperty()->SetOpacity(opacity);
  actor->GetProperty()->SetLineWidth(static_cast<float>(width));
  actor->GetProperty()->LightingOff();
  return actor;
}

Actor force_chains(vtkPolyData* contacts, const Section& section, TubeScale scale, vtkColorTransferFunction* colours) {
  vtkDataArray* force = contacts->GetCellData()->GetArray("force");
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> lines;
  vtkNew<vtkDoubleArray> values, radii;
  values->SetName("shown");
  radii->SetName("tube");
  constexpr double weakest = 0.05;  // share of the strongest below which a contact is not drawn
  for (vtkIdType cell = 0; force != nullptr && cell < contacts->GetNumberOfCells(); ++cell) {
    const double share = std::min(force->GetTuple1(cell) / scale.strong, 1.0);
    vtkNew<vtkIdList> ends;
    contacts->GetCellPoints(cell, ends);
    if (!(share > weakest) || ends->GetNumberOfIds() != 2) continue;
    double from[3], to[3];
    contacts->GetPoint(ends->GetId(0), from);
    contacts->GetPoint(ends->GetId(1), to);
    const bool near = std::abs(0.5 * (from[0] + to[0]) - section.x) < section.depth;
    if (!near) continue;
    lines->InsertNextCell(2);
    for (double* end : {from, to}) {
      lines->InsertCellPoint(points->InsertNextPoint(end[0] + section.in_front, end[1], end[2]));
      values->InsertNextValue(force->GetTuple1(cell) * scale.factor);
      radii->InsertNextValue(scale.radius * std::max(share, 0.06));
    }
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetLines(lines);
  data->GetPointData()->AddArray(values);
  data->GetPointData()->SetScalars(radii);
  vtkNew<vtkTubeFilter> tubes;
  tubes->SetInputData(data);
  tubes->SetVaryRadiusToVaryRadiusByAbsoluteScalar();
  tubes->SetNumberOfSides(12);
  tubes->CappingOn();
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(tubes->GetOutputPort());
  mapper->SelectColorArray("shown");
  auto actor = Actor::New();
  paint(mapper, actor, colours, {});
  mapper->SetScalarModeToUsePointFieldData();
  actor->SetMapper(mapper);
  actor->GetProperty()->SetAmbient(0.35);
  actor->GetProperty()->SetDiffuse(0.65);
  return actor;
}

}  // namespace coupling
