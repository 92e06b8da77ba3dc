#include "coupling/render_curves.hpp"

#include <fmt/format.h>
#include <vtkAxis.h>
#include <vtkChartLegend.h>
#include <vtkChartXY.h>
#include <vtkContextActor.h>
#include <vtkContextScene.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPen.h>
#include <vtkPlot.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkStringArray.h>
#include <vtkTable.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "coupling/render_canvas.hpp"

namespace coupling {
namespace {

namespace fs = std::filesystem;

// Paul Tol's bright scheme (personal.sron.nl/~pault), told apart by the colour-blind too.
constexpr std::array<std::array<unsigned char, 3>, 7> line_colours{
    {{68, 119, 170}, {238, 102, 119}, {34, 136, 51}, {204, 187, 68}, {102, 204, 238}, {170, 51, 119}, {120, 120, 120}}};

bool starts_with_energy(const HistoryColumn& column) { return column.name.rfind("energy", 0) == 0; }
bool is_energy_error(const HistoryColumn& column) {
  return starts_with_energy(column) &&
         (column.name.find("error") != std::string::npos || column.name.find("residual") != std::string::npos);
}

double largest_magnitude(const HistoryColumn& column) {
  double largest = 0;
  for (double value : column.values)
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  return largest;
}

std::string quantity(const std::string& unit) {
  if (unit == "N") return "load";
  if (unit == "m") return "displacement";
  if (unit == "m/s") return "velocity";
  if (unit == "m/s2" || unit == "m/s^2") return "acceleration";
  if (unit == "Pa") return "stress";
  if (unit == "J") return "energy";
  return unit.empty() || unit == "-" || unit == "1" ? "probes" : unit;
}

/// What the legend calls a column.
std::string label(const HistoryColumn& column) {
  constexpr std::size_t prefix = std::string_view("energy_").size();
  return spaced(starts_with_energy(column) && column.name.size() > prefix ? column.name.substr(prefix) : column.name);
}

void style(vtkTextProperty* text, int points, bool bold) {
  text->SetFontFamilyToArial();
  text->SetFontSize(points * oversampling);
  text->SetBold(bold);
  text->SetColor(0.13, 0.14, 0.16);
}

vtkNew<vtkTable> table_of(const HistoryTable& history, const Chart& chart, const ShownUnit& time_unit) {
  const std::size_t rows = history.time().size();
  // More points than pixels only cost time; every n-th is kept, and never fewer than two per pixel.
  const std::size_t stride = std::max<std::size_t>(1, rows / (4 * picture_width));
  const auto add = [&](vtkTable* table, const std::string& name, const std::vector<double>& values, double factor) {
    vtkNew<vtkDoubleArray> array;
    array->SetName(name.c_str());
    for (std::size_t row = 0; row < rows; row += stride) array->InsertNextValue(values[row] * factor);
    table->AddColumn(array);
  };
  vtkNew<vtkTable> table;
  add(table, "time", history.time(), time_unit.factor);
  for (const auto* column : chart.columns) add(table, label(*column), column->values, chart.unit.factor);
  return table;
}

/// Round numbers of our own: VTK chooses too many for a sheet that is drawn larger than it is shown.
void set_ticks(vtkAxis* axis, double low, double high, int count) {
  vtkNew<vtkDoubleArray> positions;
  vtkNew<vtkStringArray> labels;
  for (double tick : round_ticks(low, high, count)) {
    positions->InsertNextValue(tick);
    labels->InsertNextValue(fmt::format("{:.6g}", tick));
  }
  axis->SetBehavior(vtkAxis::FIXED);
  axis->SetRange(low, high);
  axis->SetCustomTickPositions(positions, labels);
}

Range range_of(const Chart& chart) {
  Range range{0, 0};
  for (const auto* column : chart.columns)
    for (double value : column->values)
      if (std::isfinite(value))
        range = {std::min(range.low, value * chart.unit.factor), std::max(range.high, value * chart.unit.factor)};
  const double margin = 0.05 * (range.high - range.low);
  // Room above the lines for the legend.
  const double legend = chart.columns.size() > 1 ? 0.065 * static_cast<double>(chart.columns.size()) : 0;
  return {range.low < 0 ? range.low - margin : 0, range.high + margin + legend * (range.high - range.low)};
}

vtkNew<vtkChartXY> draw(const HistoryTable& history, const Chart& chart) {
  const double start = history.time().front(), end = history.time().back();
  const ShownUnit time_unit = end - start < 1 ? ShownUnit{1e3, "ms"} : ShownUnit{1, "s"};
  vtkNew<vtkChartXY> drawn;
  drawn->SetTitle(chart.unit.name.empty() ? chart.title : chart.title + " [" + chart.unit.name + "]");
  style(drawn->GetTitleProperties(), 18, true);
  for (int which : {vtkAxis::BOTTOM, vtkAxis::LEFT}) {
    vtkAxis* axis = drawn->GetAxis(which);
    axis->SetTitle(which == vtkAxis::BOTTOM ? "time [" + time_unit.name + "]" : "");
    style(axis->GetTitleProperties(), 15, false);
    style(axis->GetLabelProperties(), 15, false);
    axis->GetPen()->SetWidth(1.0F * oversampling);
    axis->GetGridPen()->SetWidth(0.6F * oversampling);
    axis->GetGridPen()->SetColor(222, 222, 222);
    axis->SetTickLength(4.0F * oversampling);
    axis->SetLabelOffset(7.0F * oversampling);
  }
  set_ticks(drawn->GetAxis(vtkAxis::BOTTOM), start * time_unit.factor, end * time_unit.factor, 8);
  const Range range = range_of(chart);
  set_ticks(drawn->GetAxis(vtkAxis::LEFT), range.low, range.high, 8);
  const auto table = table_of(history, chart, time_unit);
  for (std::size_t i = 0; i < chart.columns.size(); ++i) {
    vtkPlot* line = drawn->AddPlot(vtkChart::LINE);
    line->SetInputData(table, 0, static_cast<vtkIdType>(i + 1));
    const auto& colour = line_colours[i % line_colours.size()];
    line->SetColor(colour[0], colour[1], colour[2], 255);
    line->SetWidth(2.0F * oversampling);
    if (i >= line_colours.size()) line->GetPen()->SetLineType(vtkPen::DASH_LINE);
  }
  drawn->SetShowLegend(chart.columns.size() > 1);
  drawn->GetLegend()->SetLabelSize(14 * oversampling);
  drawn->GetLegend()->SetSymbolWidth(22 * oversampling);
  drawn->GetLegend()->SetPadding(4 * oversampling);
  drawn->GetLegend()->GetPen()->SetLineType(vtkPen::NO_PEN);
  drawn->GetLegend()->SetInline(true);
  drawn->GetLegend()->SetHorizontalAlignment(vtkChartLegend::RIGHT);
  drawn->GetLegend()->SetVerticalAlignment(vtkChartLegend::TOP);
  return drawn;
}

}  // namespace

std::vector<double> round_ticks(double low, double high, int count) {
  if (!(high > low) || count < 1) return {};
  const double wanted = (high - low) / count, decade = std::pow(10, std::floor(std::log10(wanted)));
  const double share = wanted / decade;
  const double step = decade * (share > 5 ? 10 : (share > 2 ? 5 : (share > 1 ? 2 : 1)));
  std::vector<double> ticks;
  for (double number = std::ceil(low / step - 1e-9) + 0.0; number * step <= high + 1e-9 * step; ++number)
    ticks.push_back(number * step);
  return ticks;
}

std::vector<Chart> charts_of(const HistoryTable& history) {
  std::vector<Chart> charts;
  const auto add = [&](const std::string& title, const std::string& unit, auto&& belongs) {
    Chart chart{title, {}, {}};
    double largest = 0;
    for (std::size_t i = 1; i < history.columns.size(); ++i) {
      const auto& column = history.columns[i];
      if (column.name == "stage" || !belongs(column) || largest_magnitude(column) == 0) continue;
      chart.columns.push_back(&column);
      largest = std::max(largest, largest_magnitude(column));
    }
    if (chart.columns.empty()) return;
    // Lines that the eye cannot tell from zero would only fill the legend.
    std::erase_if(chart.columns, [&](const auto* column) { return largest_magnitude(*column) < 0.005 * largest; });
    chart.unit = readable_unit(unit, largest);
    if (chart.columns.size() == 1) chart.title = spaced(chart.columns.front()->name);
    charts.push_back(chart);
  };
  const auto of_unit = [](const std::string& unit) {
    return [unit](const HistoryColumn& column) { return column.unit == unit && !starts_with_energy(column); };
  };
  add(quantity("N"), "N", of_unit("N"));
  add(quantity("m"), "m", of_unit("m"));
  add("energy ledger", "J", [](const HistoryColumn& column) {
    return starts_with_energy(column) && column.unit == "J" && !is_energy_error(column);
  });
  add("energy residual", "J",
      [](const HistoryColumn& column) { return is_energy_error(column) && column.unit == "J"; });
  add("energy error", "share",
      [](const HistoryColumn& column) { return is_energy_error(column) && column.unit != "J"; });
  std::vector<std::string> units{"N", "m"};
  const auto add_unit = [&](const std::string& unit) {
    if (std::find(units.begin(), units.end(), unit) != units.end()) return;
    units.push_back(unit);
    add(quantity(unit), unit, of_unit(unit));
  };
  add_unit("m/s2");
  add_unit("Pa");
  for (std::size_t i = 1; i < history.columns.size(); ++i)
    if (!starts_with_energy(history.columns[i])) add_unit(history.columns[i].unit);
  constexpr std::size_t most = 6;
  if (charts.size() > most) charts.resize(most);
  return charts;
}

std::vector<fs::path> render_curves(const RunDirectory& run, const fs::path& pictures) {
  if (run.history.empty() || run.history.time().size() < 2) return {};
  const auto charts = charts_of(run.history);
  if (charts.empty()) return {};
  const int columns = charts.size() > 4 ? 3 : (charts.size() > 1 ? 2 : 1);
  const int rows = (static_cast<int>(charts.size()) + columns - 1) / columns;
  const float width = static_cast<float>(picture_width * oversampling) / static_cast<float>(columns);
  const float height = static_cast<float>(picture_height * oversampling) / static_cast<float>(rows);
  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(1);
  window->SetMultiSamples(0);
  window->SetSize(picture_width * oversampling, picture_height * oversampling);
  vtkNew<vtkRenderer> sheet;
  sheet->SetBackground(1, 1, 1);
  window->AddRenderer(sheet);
  vtkNew<vtkContextActor> drawing;
  drawing->GetScene()->SetRenderer(sheet);
  sheet->AddActor(drawing);
  for (std::size_t i = 0; i < charts.size(); ++i) {
    const auto drawn = draw(run.history, charts[i]);
    const int column = static_cast<int>(i) % columns, row = static_cast<int>(i) / columns;
    drawn->SetAutoSize(false);
    constexpr float border = 18.0F * oversampling;
    drawn->SetSize(vtkRectf(static_cast<float>(column) * width + border,
                            static_cast<float>(rows - 1 - row) * height + border, width - 2 * border,
                            height - 2 * border));
    drawing->GetScene()->AddItem(drawn);
  }
  const fs::path file = pictures / "curves.png";
  save_window(window, file);
  return {file};
}

}  // namespace coupling
