#include "coupling/render_canvas.hpp"

#include <vtkBoundingBox.h>
#include <vtkCamera.h>
#include <vtkImageShrink3D.h>
#include <vtkMath.h>
#include <vtkMatrix4x4.h>
#include <vtkPNGWriter.h>
#include <vtkScalarBarActor.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace coupling {
namespace {

constexpr std::array<double, 3> ink{0.13, 0.14, 0.16};

// The part of the sheet between title, colour bars and edges, in view coordinates (-1 … 1).
constexpr double free_centre_x = -0.12, free_centre_y = -0.09, free_half_width = 0.83, free_half_height = 0.86;

void style_text(vtkTextProperty* text, int points, bool bold) {
  text->SetFontFamilyToArial();
  text->SetFontSize(points * oversampling);
  text->SetBold(bold);
  text->SetItalic(false);
  text->SetShadow(false);
  text->SetColor(ink[0], ink[1], ink[2]);
}

vtkNew<vtkTextActor> text_line(const std::string& words, int points, bool bold, double x, double y) {
  vtkNew<vtkTextActor> actor;
  actor->SetInput(words.c_str());
  style_text(actor->GetTextProperty(), points, bold);
  actor->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  actor->SetPosition(x, y);
  return actor;
}

template <std::size_t n>
vtkSmartPointer<vtkColorTransferFunction> sequence(const std::array<std::array<double, 3>, n>& colours, double first,
                                                   double last) {
  auto map = vtkSmartPointer<vtkColorTransferFunction>::New();
  map->SetColorSpaceToLab();
  for (std::size_t i = 0; i < n; ++i) {
    const double x = first + (last - first) * static_cast<double>(i) / (n - 1);
    map->AddRGBPoint(x, colours[i][0], colours[i][1], colours[i][2]);
  }
  return map;
}

// Nine evenly spaced colours of viridis (van der Walt, Smith 2015, matplotlib; CC0).
constexpr std::array<std::array<double, 3>, 9> viridis{{{0.267, 0.005, 0.329},
                                                        {0.279, 0.175, 0.483},
                                                        {0.230, 0.322, 0.546},
                                                        {0.173, 0.449, 0.558},
                                                        {0.128, 0.567, 0.551},
                                                        {0.158, 0.684, 0.502},
                                                        {0.369, 0.789, 0.383},
                                                        {0.678, 0.864, 0.190},
                                                        {0.993, 0.906, 0.144}}};
// Brewer's YlOrRd without its palest steps (colorbrewer2.org; Apache-2.0).
constexpr std::array<std::array<double, 3>, 6> yellow_to_red{{{0.996, 0.851, 0.463},
                                                              {0.996, 0.698, 0.298},
                                                              {0.992, 0.553, 0.235},
                                                              {0.988, 0.306, 0.165},
                                                              {0.890, 0.102, 0.110},
                                                              {0.502, 0.000, 0.149}}};

}  // namespace

void save_window(vtkRenderWindow* window, const std::filesystem::path& png) {
  window->Render();
  vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(window);
  image->ReadFrontBufferOff();
  vtkNew<vtkImageShrink3D> shrink;
  shrink->SetInputConnection(image->GetOutputPort());
  shrink->SetShrinkFactors(oversampling, oversampling, 1);
  shrink->MeanOn();
  vtkNew<vtkPNGWriter> writer;
  writer->SetFileName(png.c_str());
  writer->SetInputConnection(shrink->GetOutputPort());
  writer->Write();
  if (writer->GetErrorCode() != 0 || !std::filesystem::exists(png))
    throw base::MachineError("cannot write " + png.string() + ": is the disk full or read-only?");
}

Range percentile_range(std::vector<double> values, double share) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return {};
  const auto at = [&](double position) {
    const auto index = static_cast<std::ptrdiff_t>(std::lround(position * static_cast<double>(values.size() - 1)));
    std::nth_element(values.begin(), values.begin() + index, values.end());
    return values[static_cast<std::size_t>(index)];
  };
  Range range{at(share), at(1 - share)};
  const double magnitude = std::max({std::abs(range.low), std::abs(range.high), 1e-30});
  if (range.high - range.low < 1e-6 * magnitude) range = {range.low - 0.01 * magnitude, range.high + 0.01 * magnitude};
  return range;
}

double round_step(double width) {
  if (!(width > 0)) return 1;
  const double wanted = width / 6, decade = std::pow(10, std::floor(std::log10(wanted))),
               share = wanted / decade * (1 - 1e-9);
  return decade * (share > 5 ? 10 : (share > 2.5 ? 5 : (share > 2 ? 2.5 : (share > 1 ? 2 : 1))));
}

vtkSmartPointer<vtkColorTransferFunction> colours_for(Range range) {
  const double largest = std::max(std::abs(range.low), std::abs(range.high));
  const bool both_signs = range.low < -0.15 * largest && range.high > 0.15 * largest;
  if (both_signs) {
    // Cool to warm (Moreland 2009, DOI 10.1007/978-3-642-10520-3_9), the same length on both sides of zero.
    const double step = round_step(2 * largest), end = std::ceil(largest / step - 1e-6) * step;
    auto map = vtkSmartPointer<vtkColorTransferFunction>::New();
    map->SetColorSpaceToDiverging();
    map->AddRGBPoint(-end, 0.230, 0.299, 0.754);
    map->AddRGBPoint(0, 0.865, 0.865, 0.865);
    map->AddRGBPoint(end, 0.706, 0.016, 0.150);
    return map;
  }
  const bool negative = std::abs(range.low) > std::abs(range.high);
  // From zero where zero is near; a little of the other sign is shown as zero.
  if (negative && range.high > -0.3 * largest) range.high = 0;
  if (!negative && range.low < 0.3 * largest) range.low = 0;
  const double step = round_step(range.high - range.low);
  range = {std::floor(range.low / step + 1e-6) * step, std::ceil(range.high / step - 1e-6) * step};
  return negative ? sequence(viridis, range.low, range.high) : sequence(viridis, range.high, range.low);
}

vtkSmartPointer<vtkColorTransferFunction> force_colours(double high) {
  const double step = round_step(high);
  return sequence(yellow_to_red, 0, std::ceil(high / step - 1e-6) * step);
}

Canvas::Canvas() {
  window_->SetOffScreenRendering(1);
  window_->SetMultiSamples(0);
  window_->SetSize(picture_width * oversampling, picture_height * oversampling);
  window_->SetNumberOfLayers(2);
  scene_->SetBackground(1, 1, 1);
  sheet_->SetLayer(1);
  window_->AddRenderer(scene_);
  window_->AddRenderer(sheet_);
}

void Canvas::write_title(const std::string& title, const std::string& subtitle) {
  sheet_->AddActor2D(text_line(title, 24, true, 0.025, 0.948));
  sheet_->AddActor2D(text_line(subtitle, 18, false, 0.025, 0.908));
}

void Canvas::add_colour_bar(const std::string& title, vtkColorTransferFunction* colours) {
  const double top = bars_ == 0 ? 0.86 : 0.42;
  ++bars_;
  sheet_->AddActor2D(text_line(title, 17, true, 0.873, top + 0.02));
  vtkNew<vtkScalarBarActor> bar;
  bar->SetLookupTable(colours);
  bar->SetUnconstrainedFontSize(true);
  const double width = colours->GetRange()[1] - colours->GetRange()[0];
  bar->SetNumberOfLabels(1 + static_cast<int>(std::lround(width / round_step(width))));
  bar->SetMaximumNumberOfColors(256);
  bar->SetLabelFormat(" %.3g");
  bar->SetTitle("");
  style_text(bar->GetLabelTextProperty(), 17, false);
  bar->SetTextPositionToSucceedScalarBar();
  bar->SetBarRatio(0.28);
  bar->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  bar->SetPosition(0.873, top - 0.36);
  bar->SetWidth(0.09);
  bar->SetHeight(0.36);
  sheet_->AddActor2D(bar);
}

void Canvas::look(const std::array<double, 3>& from, const std::array<double, 6>& bounds, bool perspective) {
  vtkCamera* camera = scene_->GetActiveCamera();
  camera->SetFocalPoint(0, 0, 0);
  camera->SetPosition(from.data());
  camera->SetViewUp(0, 0, 1);
  camera->SetViewAngle(22);
  camera->SetParallelProjection(!perspective);
  scene_->ResetCamera(bounds.data());
  camera->OrthogonalizeViewUp();
  double up[3], back[3], right[3];
  camera->GetViewUp(up);
  camera->GetViewPlaneNormal(back);
  vtkMath::Cross(up, back, right);
  constexpr double aspect = static_cast<double>(picture_width) / picture_height;
  // A shift changes a perspective a little, so it takes a few rounds.
  for (int round = 0; round < 5; ++round) {
    vtkMatrix4x4* projection = camera->GetCompositeProjectionTransformMatrix(aspect, -1, 1);
    vtkBoundingBox seen;
    for (int corner = 0; corner < 8; ++corner) {
      const double world[4] = {bounds[corner & 1], bounds[2 + ((corner >> 1) & 1)], bounds[4 + (corner >> 2)], 1};
      double view[4];
      projection->MultiplyPoint(world, view);
      seen.AddPoint(view[0] / view[3], view[1] / view[3], 0);
    }
    double centre[3], eye[3], focus[3];
    seen.GetCenter(centre);
    const double zoom = std::min(free_half_width / std::max(seen.GetLength(0) / 2, 1e-12),
                                 free_half_height / std::max(seen.GetLength(1) / 2, 1e-12));
    camera->Zoom(zoom);
    const double half_height =
        perspective ? camera->GetDistance() * std::tan(vtkMath::RadiansFromDegrees(camera->GetViewAngle() / 2))
                    : camera->GetParallelScale();
    camera->GetPosition(eye);
    camera->GetFocalPoint(focus);
    for (int c = 0; c < 3; ++c) {
      const double shift = half_height * ((centre[0] * zoom - free_centre_x) * aspect * right[c] +
                                          (centre[1] * zoom - free_centre_y) * up[c]);
      eye[c] += shift;
      focus[c] += shift;
    }
    camera->SetPosition(eye);
    camera->SetFocalPoint(focus);
  }
  scene_->ResetCameraClippingRange();
}

}  // namespace coupling
