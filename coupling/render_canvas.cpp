#include "coupling/render_canvas.hpp"

#include <vtkAutoInit.h>
#include <vtkImageShrink3D.h>
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

vtkSmartPointer<vtkColorTransferFunction> colours_for(Range range) {
  const double largest = std::max(std::abs(range.low), std::abs(range.high));
  const bool both_signs = range.low < -0.15 * largest && range.high > 0.15 * largest;
  if (both_signs) {
    // Cool to warm (Moreland 2009, DOI 10.1007/978-3-642-10520-3_9), the same length on both sides of zero.
    auto map = vtkSmartPointer<vtkColorTransferFunction>::New();
    map->SetColorSpaceToDiverging();
    map->AddRGBPoint(-largest, 0.230, 0.299, 0.754);
    map->AddRGBPoint(0, 0.865, 0.865, 0.865);
    map->AddRGBPoint(largest, 0.706, 0.016, 0.150);
    return map;
  }
  const bool negative = std::abs(range.low) > std::abs(range.high);
  if (negative && range.high > -0.3 * largest) range.high = std::max(range.high, 0.0);
  if (!negative && range.low < 0.3 * largest) range.low = std::min(range.low, 0.0);
  return negative ? sequence(viridis, range.low, range.high) : sequence(viridis, range.high, range.low);
}

vtkSmartPointer<vtkColorTransferFunction> force_colours(double high) { return sequence(yellow_to_red, 0, high); }

Canvas::Canvas() {
  window_->SetOffScreenRendering(1);
  window_->SetMultiSamples(0);
  window_->SetSize(picture_width * oversampling, picture_height * oversampling);
  sheet_->SetBackground(1, 1, 1);
  sheet_->InteractiveOff();
  scene_->SetBackground(1, 1, 1);
  scene_->SetViewport(0.01, 0.01, 0.865, 0.895);
  window_->AddRenderer(sheet_);
  window_->AddRenderer(scene_);
}

void Canvas::write_title(const std::string& title, const std::string& subtitle) {
  sheet_->AddActor2D(text_line(title, 24, true, 0.025, 0.948));
  sheet_->AddActor2D(text_line(subtitle, 18, false, 0.025, 0.908));
}

void Canvas::add_colour_bar(const std::string& title, vtkColorTransferFunction* colours) {
  const double top = bars_ == 0 ? 0.86 : 0.42;
  ++bars_;
  sheet_->AddActor2D(text_line(title, 17, true, 0.873, top + 0.012));
  vtkNew<vtkScalarBarActor> bar;
  bar->SetLookupTable(colours);
  bar->SetUnconstrainedFontSize(true);
  bar->SetNumberOfLabels(6);
  bar->SetMaximumNumberOfColors(256);
  bar->SetLabelFormat("%-#.3g");
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

}  // namespace coupling
