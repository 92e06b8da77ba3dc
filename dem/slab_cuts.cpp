#include "dem/slab_cuts.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace dem {

void SlabWork::add(double x, double work) {
  const auto number = static_cast<double>(bins.size());
  const double place = high > low ? std::floor((x - low) / (high - low) * number) : 0;
  bins[static_cast<std::size_t>(std::clamp(place, 0.0, number - 1))] += work;
}

double least_slab(double reach, double skin) { return 4 * reach + 4 * skin; }

std::vector<double> slab_cuts(const SlabWork& work, int parts, double least) {
  if (!(parts * least <= work.high - work.low)) return {};
  const double total = std::accumulate(work.bins.begin(), work.bins.end(), 0.0);
  const double width = (work.high - work.low) / static_cast<double>(work.bins.size());
  std::vector<double> cuts;
  double before = 0;
  std::size_t bin = 0;
  for (int k = 1; k < parts; ++k) {
    const double wanted = total * k / parts;
    while (bin + 1 < work.bins.size() && before + work.bins[bin] < wanted) before += work.bins[bin++];
    const double share = work.bins[bin] > 0 ? std::clamp((wanted - before) / work.bins[bin], 0.0, 1.0) : 0.5;
    cuts.push_back(work.low + (static_cast<double>(bin) + share) * width);
  }
  double end = work.low;
  for (double& cut : cuts) end = cut = std::max(cut, end + least);
  end = work.high;
  for (auto cut = cuts.rbegin(); cut != cuts.rend(); ++cut) end = *cut = std::min(*cut, end - least);
  return cuts;
}

}  // namespace dem
