#pragma once
// What grains and contacts are told from: rows on the host, however they have come there (snapshot.hpp).
#include <algorithm>

#include "dem/core/bodies.hpp"
#include "dem/core/contact_pass.hpp"
#include "dem/core/periodic.hpp"
#include "dem/dem.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

/// Spheres, or bodies where there are any.
struct GrainRows {
  std::span<const Place> place;
  std::span<const Quad> state;
  int parts = 2;
  std::span<const int> material, shape;  // shape, orientation: of bodies
  std::span<const kernels::Quaternion> orientation;
  std::span<const std::int64_t> id;

  std::vector<Grain> grains() const {
    const Rows<const Quad> rows{state.data(), parts};
    std::vector<Grain> grains(id.size());
    for (std::size_t k = 0; k < id.size(); ++k) {
      const int g = static_cast<int>(k);
      grains[k] = {.position = place[k].position,
                   .radius = place[k].radius,
                   .velocity = rows.translation(g).vector,
                   .angular_velocity = parts == 1 ? Vec3{} : rows.rotation(g).vector,
                   .material = material[k],
                   .id = id[k]};
      if (shape.empty()) continue;
      grains[k].shape = shape[k];
      grains[k].orientation = orientation[k];
    }
    std::sort(grains.begin(), grains.end(), [](const Grain& a, const Grain& b) { return a.id < b.id; });
    return grains;
  }
};

/// Pairs of spheres. The histories are half a step ahead: taken back, the law gives the force of this instant again.
struct PairRows {
  std::span<const Place> place;
  std::span<const Quad> motion;
  int parts = 2;
  std::span<const int> material, owner, shift;  // owner, shift: of images
  int first_image = 0;
  Periods periods;
  std::vector<kernels::PairParameters> parameters;
  int materials = 1;
  double ahead = 0;  // [s]
  std::span<const int> first, second;
  std::span<const double> history;
  std::span<const float> short_history;  // in the place of `history` where contacts are in single precision
  int stride = 0;

  /// Calls visit(i, j, meeting, parameters, force on i, period) if row i touches `row`; j is met where it lies plus the
  /// period.
  template <class Visit>
  void look(int i, int row, const double* kept, int numbers, const Visit& visit) const {
    Meeting<double> meeting;
    if (!PairGeometry{place.data(), {motion.data(), parts}}.meet(i, row, meeting)) return;
    const int image = owner.empty() ? -1 : row - first_image, j = image < 0 ? row : owner[image];
    double numbers_now[maximum_numbers] = {};
    std::copy_n(kept, numbers, numbers_now);
    const auto& is = parameters[material[i] * materials + material[j]];
    const Vec3 force = AnyLaw::press<false>(is, meeting.touch, kernels::Interval{-ahead, 0}, numbers_now).force;
    visit(i, j, meeting, is, force, image < 0 ? Vec3{} : periods.vector(shift[image]));
  }
  /// The same for every pair of the list.
  template <class Visit>
  void each(const Visit& visit) const {
    double kept[maximum_numbers] = {};
    for (std::size_t c = 0; c < first.size(); ++c) {
      if (short_history.empty())
        std::copy_n(history.begin() + c * stride, stride, kept);
      else
        std::copy_n(short_history.begin() + c * stride, stride, kept);
      look(first[c], second[c], kept, stride, visit);
    }
  }
};

/// Candidates of spheres and facets.
struct NearWallRows {
  std::span<const int> grain, start, candidate;
  std::span<const WallState> state;
  std::span<const Facet> facet;
  std::span<const Place> place;
  std::span<const std::int64_t> id;  // of the grain of every sphere

  std::vector<WallContact> contacts() const {
    std::vector<WallContact> contacts;
    for (std::size_t w = 0; w < grain.size(); ++w)
      for (int c = start[w]; c < start[w + 1]; ++c) {
        const Place& p = place[grain[w]];
        const WallState& s = state[c];
        if (s.overlap > 0)
          contacts.push_back({id[grain[w]], facet[candidate[c]].wall, p.position,
                              p.position - (p.radius - s.overlap) * s.normal, s.force, s.overlap});
      }
    return contacts;
  }
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
