#include "coupling/render_scene.hpp"

#include <fmt/format.h>
#include <vtkBillboardTextActor3D.h>
#include <vtkCellData.h>
#include <vtkLight.h>
#include <vtkLineSource.h>
#include <vtkPointData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderStepsPass.h>
#include <vtkSSAOPass.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "coupling/render_canvas.hpp"
#include "coupling/render_layers.hpp"

namespace coupling {
namespace {

namespace fs = std::filesystem;

constexpr Colour dark{0.15, 0.16, 0.18};
constexpr Colour pale{0.80, 0.80, 0.79}, disc_grey{0.93, 0.93, 0.92};
constexpr double outliers = 0.02;  // share of values on either side that a colour range leaves out

/// Earth for what lies deep, concrete for what lies on top.
Colour ground_colour(std::size_t part, std::size_t parts) {
  constexpr Colour concrete{0.76, 0.76, 0.74}, deep{0.56, 0.46, 0.36}, upper{0.77, 0.67, 0.51};
  if (part + 1 == parts) return concrete;
  const double share = parts > 2 ? static_cast<double>(part) / static_cast<double>(parts - 2) : 0;
  Colour mix;
  for (std::size_t c = 0; c < 3; ++c) mix[c] = deep[c] + share * (upper[c] - deep[c]);
  return mix;
}

std::string subtitle(const RunDirectory& run, const State& state, const Moment& moment, const std::string& more) {
  std::string text = fmt::format("t = {:.4g} s", state.time);
  if (!moment.text.empty()) text += "   |   " + moment.text;
  if (!more.empty()) text += "   |   " + more;
  if (run.grains.empty() && run.bodies.empty()) text += "   |   nothing written";
  return text;
}

void add(Canvas& canvas, const Actor& actor) { canvas.scene()->AddActor(actor); }

/// A line of a round length with its length written on it, in the plane of the section, below the picture's left end.
void add_length_bar(Canvas& canvas, const std::array<double, 6>& bounds, double x) {
  const double width = bounds[3] - bounds[2], height = bounds[5] - bounds[4];
  const double decade = std::pow(10, std::floor(std::log10(0.25 * width)));
  const double share = 0.25 * width / decade;
  const double length = decade * (share >= 5 ? 5 : (share >= 2 ? 2 : 1));
  const double y = bounds[2], z = bounds[4] - 0.05 * height;
  vtkNew<vtkLineSource> line;
  line->SetPoint1(x, y, z);
  line->SetPoint2(x, y + length, z);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(line->GetOutputPort());
  auto bar = Actor::New();
  bar->SetMapper(mapper);
  bar->GetProperty()->SetColor(dark[0], dark[1], dark[2]);
  bar->GetProperty()->SetLineWidth(4 * oversampling);
  bar->GetProperty()->LightingOff();
  add(canvas, bar);
  vtkNew<vtkBillboardTextActor3D> text;
  text->SetInput(fmt::format("{:g} m", length).c_str());
  text->SetPosition(x, y + length + 0.015 * width, z);
  text->GetTextProperty()->SetFontSize(17 * oversampling);
  text->GetTextProperty()->SetColor(dark[0], dark[1], dark[2]);
  text->GetTextProperty()->SetVerticalJustificationToCentered();
  canvas.scene()->AddActor(text);
}

/// Sunlight from above on the side of the camera, and a weak one from the other side.
void add_lights(Canvas& canvas) {
  canvas.scene()->AutomaticLightCreationOff();
  const auto light = [&](double x, double y, double z, double strength) {
    vtkNew<vtkLight> lamp;
    lamp->SetLightTypeToCameraLight();
    lamp->SetPosition(x, y, z);
    lamp->SetFocalPoint(0, 0, 0);
    lamp->SetIntensity(strength);
    canvas.scene()->AddLight(lamp);
  };
  light(-0.4, 0.7, 1, 0.95);
  light(0.9, 0.1, 0.5, 0.6);
}

/// Shading of hollows, which lets the eye tell one grain from the next.
void shade_hollows(Canvas& canvas, double radius) {
  vtkNew<vtkRenderStepsPass> steps;
  vtkNew<vtkSSAOPass> shading;
  shading->SetDelegatePass(steps);
  shading->SetRadius(radius);
  shading->SetBias(0.02 * radius);
  shading->SetKernelSize(24);
  shading->BlurOn();
  canvas.scene()->SetPass(shading);
}

/// What the grains of the overall view are coloured by: size where it differs, else speed.
struct GrainColours {
  std::string title;
  vtkSmartPointer<vtkColorTransferFunction> map;
};
GrainColours colour_grains(vtkPolyData* grains) {
  const auto sizes = show(grains, {"radius", 0, 2e3});
  const Range range = percentile_range(sizes, 0);
  if (range.high > 1.05 * range.low) return {"grain size [mm]", colours_for(range)};
  const auto speeds = show(grains, {"velocity", -1, 1});
  if (!speeds.empty()) return {"speed [m/s]", colours_for(percentile_range(speeds, outliers))};
  show(grains, {"radius", 0, 2e3});
  return {"grain size [mm]", colours_for(range)};
}

/// A clump is written sphere by sphere.
std::size_t number_of_grains(vtkPolyData* grains) {
  vtkDataArray* id = grains->GetPointData()->GetArray("id");
  std::set<double> different;
  for (vtkIdType i = 0; id && i < id->GetNumberOfTuples(); ++i) different.insert(id->GetTuple1(i));
  return id ? different.size() : static_cast<std::size_t>(grains->GetNumberOfPoints());
}

void draw_view(const RunDirectory& run, State state, const Moment& moment, const fs::path& png) {
  Canvas canvas;
  std::string more;
  if (state.has_grains()) {
    const auto colours = colour_grains(state.grains);
    add(canvas, spheres(state.grains, colours.map, pale));
    canvas.add_colour_bar(colours.title, colours.map);
    more = fmt::format("{} grains", number_of_grains(state.grains));
    shade_hollows(canvas, 2 * state.grains->GetPointData()->GetArray("radius")->GetRange(0)[1]);
    for (std::size_t i = 0; i < state.solids.size(); ++i) {
      const auto surface = surface_of(state.solids[i]);
      add(canvas, faces(surface, nullptr, ground_colour(i, state.solids.size()), true));
      add(canvas, edges(surface, true, dark, 0.8, 1.2 * oversampling, 0));
    }
  } else {
    // Solids alone: what they do is small, so it is drawn enlarged to a twelfth of the picture.
    double largest = 0;
    std::vector<double> all;
    for (auto& part : state.solids)
      for (double value : show(part.grid, {"displacement", -1, 1})) {
        largest = std::max(largest, value);
        all.push_back(value);
      }
    const auto box = state.bounds();
    const double size = std::max({box[1] - box[0], box[3] - box[2], box[5] - box[4]});
    const double wanted = largest > 0 ? size / 12 / largest : 1;
    const double decade = std::pow(10, std::floor(std::log10(wanted)));
    const double scale = wanted < 1 ? 1 : decade * (wanted >= 5 * decade ? 5 : (wanted >= 2 * decade ? 2 : 1));
    const auto unit = readable_unit("m", largest);
    for (double& value : all) value *= unit.factor;
    const auto colours = colours_for(percentile_range(all, 0));
    for (auto& part : state.solids) {
      show(part.grid, {"displacement", -1, unit.factor});
      const SolidPart bent = deformed(part, scale);
      const auto surface = surface_of(bent);
      const bool coloured = surface->GetPointData()->GetScalars() != nullptr;
      add(canvas, faces(surface, coloured ? colours.Get() : nullptr, pale, true));
      add(canvas, edges(surface, false, dark, 0.35, 1.0 * oversampling, 0));
      add(canvas, edges(surface_of(part), true, dark, 0.5, 1.5 * oversampling, 0));
    }
    if (largest > 0) canvas.add_colour_bar("displacement [" + unit.name + "]", colours);
    more = fmt::format("displacement drawn × {:g}", scale);
  }
  add_lights(canvas);
  const auto bounds = state.bounds();
  const bool long_along_x = bounds[1] - bounds[0] > bounds[3] - bounds[2];
  canvas.look(long_along_x ? std::array{0.4, -1.0, 0.42} : std::array{1.0, 0.42, 0.48}, bounds, true);
  canvas.write_title(run.title, subtitle(run, state, moment, more));
  canvas.save(png);
}

Section middle_section(const State& state) {
  const auto bounds = state.bounds();
  const double radius = state.grains->GetPointData()->GetArray("radius")->GetRange(0)[1];
  const double length = bounds[1] - bounds[0];
  // A little off the middle: a plane that runs exactly through element faces has no clean section.
  return {0.5 * (bounds[0] + bounds[1]) + 1.3e-3 * length, radius, 2 * radius};
}

/// Which part of a state a cut shows in colours, and how.
struct CutPicture {
  std::string title, bar;
  Shown solids;
  std::optional<Shown> grains;  // absent: grains plain, force chains over them
};

void draw_cut(const RunDirectory& run, State state, const Moment& moment, const CutPicture& picture,
              const fs::path& png) {
  Canvas canvas;
  const Section section = middle_section(state);
  std::vector<double> values;
  std::vector<vtkSmartPointer<vtkPolyData>> solids;
  for (const auto& part : state.solids) {
    solids.push_back(section_of(part, section));
    const auto shown = show(solids.back(), picture.solids);
    values.insert(values.end(), shown.begin(), shown.end());
  }
  bool colour_grains = false;
  if (picture.grains) {
    const auto shown = show(state.grains, *picture.grains);
    values.insert(values.end(), shown.begin(), shown.end());
    colour_grains = !shown.empty();
  }
  const auto colours = colours_for(percentile_range(values, outliers));
  for (const auto& solid : solids) {
    const bool coloured = solid->GetPointData()->GetScalars() != nullptr;
    add(canvas, faces(solid, coloured ? colours.Get() : nullptr, pale, false));
    add(canvas, edges(solid, false, dark, 0.18, 0.8 * oversampling, 0.1 * section.in_front));
    add(canvas, edges(solid, true, dark, 1, 2.0 * oversampling, 0.2 * section.in_front));
  }
  if (!values.empty()) canvas.add_colour_bar(picture.bar, colours);

  add(canvas, spheres(behind(state.grains, section), nullptr, pale));
  const auto circles = discs(state.grains, section);
  add(canvas, faces(circles, colour_grains ? colours.Get() : nullptr, disc_grey, false));
  add(canvas, edges(circles, true, dark, 0.75, 1.0 * oversampling, 0.05 * section.in_front));

  if (!picture.grains && state.contacts != nullptr && state.contacts->GetCellData()->GetArray("force") != nullptr) {
    std::vector<double> forces;
    for (vtkIdType i = 0; i < state.contacts->GetNumberOfCells(); ++i)
      forces.push_back(state.contacts->GetCellData()->GetArray("force")->GetTuple1(i));
    const double strong = percentile_range(forces, 0.005).high;
    if (strong > 0) {
      const auto unit = readable_unit("N", strong);
      const auto colours_of_force = force_colours(strong * unit.factor);
      add(canvas, force_chains(state.contacts, section, {strong, 0.38 * section.depth, unit.factor}, colours_of_force));
      canvas.add_colour_bar("contact force [" + unit.name + "]", colours_of_force);
    }
  }
  auto bounds = state.bounds();
  add_length_bar(canvas, bounds, section.x);
  add_lights(canvas);
  bounds[4] -= 0.08 * (bounds[5] - bounds[4]);  // room for the bar
  canvas.look({1, 0, 0}, bounds, false);
  canvas.write_title(run.title + ": " + picture.title,
                     subtitle(run, state, moment, fmt::format("section at x = {:.2f} m", section.x)));
  canvas.save(png);
}

}  // namespace

std::vector<fs::path> render_scene(const RunDirectory& run, const Moment& moment, const fs::path& pictures) {
  if (run.grains.empty() && run.bodies.empty()) return {};
  const State state = read_state(run, moment.time);
  if (!state.has_grains() && !state.has_solids()) return {};
  std::vector<fs::path> files{pictures / "view.png"};
  draw_view(run, state, moment, files.back());
  constexpr vtkIdType fewest_for_a_section = 100;
  if (!state.has_grains() || state.grains->GetNumberOfPoints() < fewest_for_a_section) return files;
  files.push_back(pictures / "cut_stress.png");
  draw_cut(run, state, moment, {"vertical stress", "vertical stress [kPa]", {"stress", 2, 1e-3}, std::nullopt},
           files.back());
  files.push_back(pictures / "cut_displacement.png");
  draw_cut(run, state, moment,
           {"vertical displacement", "displacement [mm]", {"displacement", 2, 1e3}, Shown{"displacement", 2, 1e3}},
           files.back());
  return files;
}

}  // namespace coupling
