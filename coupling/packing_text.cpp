// What `trackbed check` says about a packing.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "coupling/packing.hpp"

namespace coupling {
namespace {

std::string box_text(const Box& box) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g}) .. ({:.4g}, {:.4g}, {:.4g}) m", box.lower.x, box.lower.y, box.lower.z,
                     box.upper.x, box.upper.y, box.upper.z);
}

std::string layer_text(const PackingLayer& layer) {
  std::string text = "poured";
  if (const auto& growth = layer.growth)
    text = fmt::format("grown from {:g} of the size, then pressed by {:g} times gravity", growth->start,
                       growth->gravity_factor);
  if (const auto& shake = layer.vibration)
    text +=
        fmt::format(", shaken {:g} mm at {:g} Hz for {:g} s", 1e3 * shake->amplitude, shake->frequency, shake->time);
  return text + (layer.plate ? ", levelled by a plate" : ", struck off");
}

}  // namespace

std::string packing_text(const Packing& packing) {
  std::string text = fmt::format("packing: porosity {:g} asked, ", packing.target_porosity);
  text += packing.tolerance ? fmt::format("refused when farther away than {:g}", *packing.tolerance)
                            : std::string("the one reached is reported");
  text += packing.tries > 1 ? fmt::format(", {} tries\n", packing.tries) : "\n";
  for (std::size_t i = 0; i < packing.layers.size(); ++i)
    text += fmt::format("  layer {}: {}\n", i + 1, layer_text(packing.layers[i]));
  for (const LooseRegion& region : packing.loosened) {
    text += fmt::format("  loosened: {}", box_text(region.box));
    if (region.friction) text += fmt::format(", packed with a friction of {:g}", *region.friction);
    if (region.share > 0) text += fmt::format(", {:g} % of its grains taken out", 100 * region.share);
    text += '\n';
  }
  for (const ErodedRegion& region : packing.eroded)
    text += fmt::format("  eroded: {}{}\n", box_text(region.box), region.above ? ", above a plane" : "");
  return text;
}

}  // namespace coupling
