#include "dem/measure/heap.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace dem {
namespace {

constexpr double cell_diameters = 2;      // width of a cell, in grain diameters
constexpr int most_rings = 40;            // of a wide heap: wider cells, so that the pairs of points stay few
constexpr int azimuths = 8;               // flanks of a cone
constexpr int lanes_of_a_slope = 4;       // flanks on either side of a crest
constexpr double foot = 0.2, head = 0.8;  // shares of the height between which the line is fitted
constexpr std::size_t fewest_rings = 3;

/// Value below which this share of the list lies.
double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}
double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

/// Mean over the grains of the mean edge of the box around a grain's spheres [m].
double grain_diameter(std::span<const GrainSphere> spheres) {
  double sum = 0;
  std::size_t grains = 0;
  for (std::size_t first = 0, next = 0; first < spheres.size(); first = next) {
    Vec3 lower{HUGE_VAL, HUGE_VAL, HUGE_VAL}, upper = -lower;
    for (next = first; next < spheres.size() && spheres[next].id == spheres[first].id; ++next) {
      for (int axis = 0; axis < 3; ++axis) {
        lower[axis] = std::min(lower[axis], spheres[next].position[axis] - spheres[next].radius);
        upper[axis] = std::max(upper[axis], spheres[next].position[axis] + spheres[next].radius);
      }
    }
    const Vec3 edges = upper - lower;
    sum += (edges.x + edges.y + edges.z) / 3;
    ++grains;
  }
  return sum / static_cast<double>(grains);
}

/// Where a point of the surface lies: distance down the slope, ring of cells, cell of the ring, flank.
struct Cell {
  double distance = 0;  // [m] from the axis or crest
  int ring = 0, number = 0, flank = 0;
};

/// Cuts a heap, seen from above, into cells.
class Plan {
 public:
  Plan(std::span<const GrainSphere> spheres, const HeapView& view) : cone_(view.axis == HeapView::vertical) {
    along_ = view.axis == HeapView::y ? 1 : 0;
    across_ = 1 - along_;
    std::vector<double> a, b;
    for (const GrainSphere& sphere : spheres) {
      a.push_back(sphere.position[along_]);
      b.push_back(sphere.position[across_]);
    }
    centre_[along_] = view.centre ? (*view.centre)[along_] : median(a);
    centre_[across_] = view.centre ? (*view.centre)[across_] : median(b);
    start_ = quantile(a, 0.01);
    const double length = quantile(a, 0.99) - start_;
    width_ = std::max(cell_diameters * grain_diameter(spheres), 0.5 * length / most_rings);
    lane_start_ = quantile(b, 0.01);
    const double lanes_width = quantile(b, 0.99) - lane_start_;
    lanes_ = std::max(lanes_of_a_slope, static_cast<int>(std::lround(lanes_width / width_)));
    lane_width_ = lanes_width / lanes_;
  }

  bool is_cone() const { return cone_; }
  double width() const { return width_; }
  double start() const { return start_; }  // [m] where the grains begin along a slope
  void move_crest(double along) { centre_[along_] = along; }
  /// A cone has one side, a slope two.
  int sides() const { return cone_ ? 1 : 2; }
  int flanks_of_a_side() const { return cone_ ? azimuths : lanes_of_a_slope; }

  Cell cell(const Vec3& point) const {
    const double a = point[along_] - centre_[along_], b = point[across_] - centre_[across_];
    Cell cell;
    cell.distance = cone_ ? std::hypot(a, b) : std::abs(a);
    cell.ring = static_cast<int>(cell.distance / width_);
    if (cone_) {
      const double turn = 0.5 + std::atan2(b, a) / (2 * std::numbers::pi);
      cell.number = std::min(static_cast<int>(turn * cells(cell.ring)), cells(cell.ring) - 1);
    } else {
      cell.number = (a < 0 ? lanes_ : 0) + lane(point[across_]);
    }
    cell.flank = flank_of(cell.ring, cell.number);
    return cell;
  }
  /// Cells of a ring, as many per area in every ring.
  int cells(int ring) const {
    return cone_ ? static_cast<int>(std::lround(2 * std::numbers::pi * (ring + 0.5))) : 2 * lanes_;
  }
  int flank_of(int ring, int number) const {
    if (cone_) return azimuths * (2 * number + 1) / (2 * cells(ring));
    const int side = number / lanes_, lane = number % lanes_;
    return side * lanes_of_a_slope + lanes_of_a_slope * lane / lanes_;
  }

 private:
  int lane(double across) const {
    if (!(lane_width_ > 0)) return 0;
    return static_cast<int>(std::clamp((across - lane_start_) / lane_width_, 0.0, lanes_ - 1.0));
  }
  bool cone_;
  int along_ = 0, across_ = 1;
  Vec3 centre_;
  double width_ = 0;  // [m] of a ring
  int lanes_ = 1;     // of a slope
  double start_ = 0, lane_start_ = 0, lane_width_ = 0;
};

struct SurfacePoint {
  double distance = 0, height = 0;  // [m] from the axis, above the floor
};

/// The highest top of every cell, ring by ring.
class Surface {
 public:
  Surface(std::span<const GrainSphere> spheres, const Plan& plan, double floor) : plan_(plan) {
    for (const GrainSphere& sphere : spheres) {
      const Cell cell = plan.cell(sphere.position);
      while (static_cast<int>(rings_.size()) <= std::min(cell.ring, 4 * most_rings)) {
        rings_.emplace_back(static_cast<std::size_t>(plan.cells(static_cast<int>(rings_.size()))));
      }
      if (cell.ring >= static_cast<int>(rings_.size())) continue;  // far out: what rolled away
      SurfacePoint& point = rings_[static_cast<std::size_t>(cell.ring)][static_cast<std::size_t>(cell.number)];
      const double height = sphere.position.z + sphere.radius - floor;
      if (height > point.height) point = {cell.distance, height};
    }
  }
  std::size_t rings() const { return rings_.size(); }
  /// Points of a ring in these flanks; a cell without a grain is as high as the floor.
  std::vector<SurfacePoint> points(std::size_t ring, int first_flank, int flanks) const {
    std::vector<SurfacePoint> found;
    const auto& cells = rings_[ring];
    for (std::size_t number = 0; number < cells.size(); ++number) {
      const int flank = plan_.flank_of(static_cast<int>(ring), static_cast<int>(number));
      if (flank >= first_flank && flank < first_flank + flanks) found.push_back(cells[number]);
    }
    return found;
  }
  /// Median height of every ring on one side.
  std::vector<double> profile(int side) const;

 private:
  const Plan& plan_;
  std::vector<std::vector<SurfacePoint>> rings_;
};

double median_height(const std::vector<SurfacePoint>& points) {
  std::vector<double> heights;
  for (const SurfacePoint& point : points) heights.push_back(point.height);
  return median(std::move(heights));
}

std::vector<double> Surface::profile(int side) const {
  std::vector<double> heights;
  const int flanks = plan_.flanks_of_a_side();
  for (std::size_t ring = 0; ring < rings(); ++ring)
    heights.push_back(median_height(points(ring, side * flanks, flanks)));
  return heights;
}

/// Where a slope is highest along its axis [m]: the middle of three neighbouring bins.
double crest(std::span<const GrainSphere> spheres, Plan plan, double floor) {
  plan.move_crest(plan.start() - plan.width());
  const auto heights = Surface(spheres, plan, floor).profile(0);
  const auto height = [&](std::size_t bin) { return bin < heights.size() ? heights[bin] : 0; };
  std::size_t highest = 0;
  for (std::size_t bin = 0; bin < heights.size(); ++bin) {
    const auto three = [&](std::size_t b) { return height(b - 1) + height(b) + height(b + 1); };
    if (three(bin) > three(highest)) highest = bin;
  }
  return plan.start() + (static_cast<double>(highest) - 0.5) * plan.width();
}

/// Median of the slopes between all pairs of points, each weighing as much as the points are apart.
double median_slope(const std::vector<SurfacePoint>& points) {
  struct Pair {
    double slope, weight;
  };
  std::vector<Pair> pairs;
  double total = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double apart = points[i].distance - points[j].distance;
      if (apart == 0) continue;
      pairs.push_back({(points[i].height - points[j].height) / apart, std::abs(apart)});
      total += std::abs(apart);
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.slope < b.slope; });
  double weight = 0;
  for (const Pair& pair : pairs) {
    weight += pair.weight;
    if (weight >= 0.5 * total) return pair.slope;
  }
  return 0;
}

/// The points of a flank between foot and head; empty when they span too few rings.
std::vector<SurfacePoint> slope_points(const Surface& surface, int flank, double height) {
  std::vector<SurfacePoint> found;
  std::size_t rings = 0;
  for (std::size_t ring = 0; ring < surface.rings(); ++ring) {
    const auto points = surface.points(ring, flank, 1);
    if (points.empty()) continue;  // close to the axis of a cone, not every flank has a cell
    const double level = median_height(points);
    if (level < foot * height) break;
    if (level > head * height) continue;
    ++rings;
    for (const SurfacePoint& point : points) {
      if (point.height > 0) found.push_back(point);
    }
  }
  return rings < fewest_rings ? std::vector<SurfacePoint>{} : found;
}

}  // namespace

HeapAngle heap_angle(std::span<const GrainSphere> spheres, const HeapView& view) {
  HeapAngle result;
  if (spheres.empty()) return result;
  std::vector<double> bottoms;
  for (const GrainSphere& sphere : spheres) bottoms.push_back(sphere.position.z - sphere.radius);
  const double floor = view.floor.value_or(quantile(std::move(bottoms), 0.01));
  Plan plan(spheres, view);
  if (!plan.is_cone() && !view.centre) plan.move_crest(crest(spheres, plan, floor));
  const Surface surface(spheres, plan, floor);
  for (int side = 0; side < plan.sides(); ++side) {
    for (const double height : surface.profile(side)) result.height = std::max(result.height, height);
  }
  std::vector<double> angles;
  for (int flank = 0; flank < plan.sides() * plan.flanks_of_a_side(); ++flank) {
    const auto points = slope_points(surface, flank, result.height);
    if (!points.empty()) angles.push_back(-std::atan(median_slope(points)));
  }
  result.flanks = static_cast<int>(angles.size());
  for (const double angle : angles) result.angle += angle / result.flanks;
  if (result.flanks < 2) return result;
  for (const double angle : angles) result.scatter += (angle - result.angle) * (angle - result.angle);
  result.scatter = std::sqrt(result.scatter / (result.flanks - 1));
  return result;
}

}  // namespace dem
