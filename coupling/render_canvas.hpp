#pragma once
// One picture: a white sheet with a title, a three-dimensional scene and colour bars, saved as PNG. Drawn at twice the
// size and averaged down, which smooths every edge alike.
#include <vtkActor.h>
#include <vtkColorTransferFunction.h>
#include <vtkContextView.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace coupling {

inline constexpr int picture_width = 1600, picture_height = 1000;  // [pixels]
inline constexpr int oversampling = 2;

/// Averages the drawn window down to the picture's size and writes it. Throws base::MachineError when the disk fails.
void save_window(vtkRenderWindow*, const std::filesystem::path& png);

struct Range {
  double low = 0, high = 1;
};

/// The range that holds all but the outermost `share` of the values on either side, so that one outlier does not
/// flatten the picture. Values that are not finite do not count. A range without width is widened a little.
Range percentile_range(std::vector<double> values, double share);

/// A round number: about a sixth of the width.
double round_step(double width);

/// Colours for a range, widened to round numbers: a diverging map about zero where both signs matter, else a sequential
/// one of even lightness (viridis), dark at the end that is farther from zero.
vtkSmartPointer<vtkColorTransferFunction> colours_for(Range);
/// Yellow to dark red from zero: force chains, which have to stand out from the colours above.
vtkSmartPointer<vtkColorTransferFunction> force_colours(double high);

class Canvas {
 public:
  Canvas();
  vtkRenderer* scene() { return scene_; }
  /// Looks at the box from this direction, z up, from as near as lets the box fill the room that title and bars leave.
  void look(const std::array<double, 3>& from, const std::array<double, 6>& bounds, bool perspective);
  void write_title(const std::string& title, const std::string& subtitle);
  /// Adds a bar on the right, from the top down; two fit.
  void add_colour_bar(const std::string& title, vtkColorTransferFunction*);
  void save(const std::filesystem::path& png) { save_window(window_, png); }

 private:
  vtkNew<vtkRenderWindow> window_;
  vtkNew<vtkRenderer> sheet_, scene_;
  int bars_ = 0;
};

}  // namespace coupling
