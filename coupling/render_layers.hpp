#pragma once
// What a picture of a state is put together from: grains as spheres or as the exact discs of a section, solids as
// surfaces or as sections, force chains as tubes. Each function makes one VTK actor.
#include <vtkActor.h>
#include <vtkColorTransferFunction.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

#include <array>
#include <string>
#include <vector>

#include "coupling/run_directory.hpp"

namespace coupling {

using Colour = std::array<double, 3>;
using Actor = vtkSmartPointer<vtkActor>;

/// One material region of one body. Stresses, which the files hold per element, are averaged to its nodes here, never
/// across a boundary of materials.
struct SolidPart {
  std::string body;
  vtkSmartPointer<vtkUnstructuredGrid> grid;
  std::array<double, 6> bounds;  // [m] x, x, y, y, z, z
};

/// The state of a run at the level nearest to a time. What the run did not write is null or empty.
struct State {
  double time = 0;  // [s] of the level
  vtkSmartPointer<vtkPolyData> grains, contacts;
  std::vector<SolidPart> solids;  // from the lowest to the highest

  bool has_grains() const { return grains != nullptr && grains->GetNumberOfPoints() > 0; }
  bool has_solids() const { return !solids.empty(); }
  std::array<double, 6> bounds() const;  // [m] of grains (with their radii) and solids
};
/// Throws base::UserError when a file cannot be read.
State read_state(const RunDirectory&, double time);

/// What colours stand for: a component (-1: magnitude) of a point array, times a factor to the unit shown.
struct Shown {
  const char* array;
  int component;
  double factor;
};
/// Attaches the values as the active scalars of the points, and returns them; empty when the array is not there.
std::vector<double> show(vtkDataSet*, Shown);

/// The plane x = const of a section, seen along -x.
struct Section {
  double x = 0;      // [m]
  double depth = 0;  // [m] thickness of the slice before and behind it from which force chains are drawn
  double in_front =
      0;  // [m] towards the eye: moves lines and tubes before what they lie on; harmless without perspective
};

// ---- grains. `colours` null: the plain colour; else the active point scalars.
Actor spheres(vtkPolyData* grains, vtkColorTransferFunction* colours, Colour plain);
/// Grains whose centre is behind the section, moved back by their largest radius so that none sticks out of it.
vtkSmartPointer<vtkPolyData> behind(vtkPolyData* grains, const Section&);
/// Exact circles in which the section cuts the grains.
vtkSmartPointer<vtkPolyData> discs(vtkPolyData* grains, const Section&);

// ---- solids
vtkSmartPointer<vtkPolyData> section_of(const SolidPart&, const Section&);
vtkSmartPointer<vtkPolyData> surface_of(const SolidPart&);
/// Displaced by `scale` × displacement.
SolidPart deformed(const SolidPart&, double scale);

// ---- drawing
Actor faces(vtkPolyData*, vtkColorTransferFunction* colours, Colour plain, bool lit);
/// Edges of all polygons (the mesh), or only of the outline.
Actor edges(vtkPolyData*, bool outline_only, Colour, double opacity, double width, double in_front);
struct TubeScale {
  double strong;  // [N] force of the thickest tube
  double radius;  // [m] of the thickest tube
  double factor;  // from newton to the unit of the colours
};
/// Tubes of contacts near the section: thickness and colour by force, weak contacts left out.
Actor force_chains(vtkPolyData* contacts, const Section&, TubeScale, vtkColorTransferFunction*);

}  // namespace coupling
