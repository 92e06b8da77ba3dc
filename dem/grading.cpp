#include "dem/grading.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "base/error.hpp"

namespace dem {
namespace {

double sphere_volume(double diameter) { return std::numbers::pi / 6.0 * diameter * diameter * diameter; }

/// Grains of diameters in [lower, upper] that carry this share of the mass.
struct SizeClass {
  double lower, upper;  // [m]
  double share;         // of the mass
  /// Diameter above which the share u of the class's grains lies.
  double diameter(double u) const {
    const double largest = 1.0 / (upper * upper);
    const double smallest = 1.0 / (lower * lower);
    return 1.0 / std::sqrt(largest + u * (smallest - largest));
  }
  /// Mean volume over the class's grains: (d2 - d1) / integral of d^-3.
  double mean_volume() const {
    if (upper - lower < 1e-9 * upper) return sphere_volume(upper);
    const double count = 0.5 * (1.0 / (lower * lower) - 1.0 / (upper * upper));
    return std::numbers::pi / 6.0 * (upper - lower) / count;
  }
};

/// Where the curve reaches zero below its first sieve [m].
double smallest_diameter(const SieveCurve& curve) {
  const double size = curve.front().size;
  const double fines = curve.front().passing;
  if (fines <= 0 || curve.size() < 2) return size;
  const double slope = (curve[1].passing - fines) / (curve[1].size - size);
  return slope > 0 ? std::max(0.5 * size, size - fines / slope) : 0.5 * size;
}

/// Classes with a share, largest first.
std::vector<SizeClass> classes(const SieveCurve& curve) {
  check_curve(curve);
  std::vector<SizeClass> result;
  const double fines = curve.front().passing;
  if (fines > 0) result.push_back({smallest_diameter(curve), curve.front().size, fines});
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const double share = curve[i].passing - curve[i - 1].passing;
    if (share > 0) result.push_back({curve[i - 1].size, curve[i].size, share});
  }
  std::reverse(result.begin(), result.end());
  return result;
}

}  // namespace

void check_curve(const SieveCurve& curve) {
  base::require_user(curve.size() >= 2, "a grading needs two sieves or more");
  for (std::size_t i = 0; i < curve.size(); ++i) {
    base::require_user(curve[i].size > 0, "a grading's sieve sizes must be > 0");
    base::require_user(curve[i].passing >= 0 && curve[i].passing <= 1, "a grading's passing must be in [0, 1]");
    if (i == 0) continue;
    base::require_user(curve[i].size > curve[i - 1].size, "a grading's sieve sizes must rise");
    base::require_user(curve[i].passing >= curve[i - 1].passing, "a grading's passing must not fall");
  }
  base::require_user(curve.back().passing == 1, "everything must pass a grading's last sieve (passing 1)");
}

double mean_grain_volume(const SieveCurve& curve) {
  double grains_per_volume = 0;
  for (const SizeClass& size_class : classes(curve)) grains_per_volume += size_class.share / size_class.mean_volume();
  return 1.0 / grains_per_volume;
}

std::vector<double> sample_radii(const SieveCurve& curve, double solid_volume, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> radii;
  double wanted = 0, have = 0;  // [m3] from the largest class down, so that a rounded class is made good by the next
  for (const SizeClass& size_class : classes(curve)) {
    wanted += size_class.share * solid_volume;
    const double count = std::max(0.0, std::round((wanted - have) / size_class.mean_volume()));
    for (double i = 0; i < count; ++i) {
      const double diameter = size_class.diameter((i + random.uniform()) / count);
      radii.push_back(0.5 * diameter);
      have += sphere_volume(diameter);
    }
  }
  for (std::size_t i = radii.size(); i > 1; --i) std::swap(radii[i - 1], radii[random.index(i)]);
  return radii;
}

SieveCurve sieve(std::span<const SizedGrain> grains, std::span<const double> sizes) {
  SieveCurve curve;
  double total = 0;
  for (const SizedGrain& grain : grains) total += grain.volume;
  for (const double size : sizes) {
    double passed = 0;
    for (const SizedGrain& grain : grains) passed += grain.size <= size ? grain.volume : 0;
    curve.push_back({size, total > 0 ? passed / total : 0});
  }
  return curve;
}

SieveCurve sieve(std::span<const double> radii, std::span<const double> sizes) {
  std::vector<SizedGrain> grains;
  for (const double radius : radii) grains.push_back({2 * radius, sphere_volume(2 * radius)});
  return sieve(grains, sizes);
}

double passing(const SieveCurve& curve, double size) {
  if (curve.empty()) return 0;
  if (size < curve.front().size) {
    const double lower = smallest_diameter(curve);
    return lower < size ? curve.front().passing * (size - lower) / (curve.front().size - lower) : 0;
  }
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const Sieve &from = curve[i - 1], &to = curve[i];
    if (size <= to.size) return from.passing + (to.passing - from.passing) * (size - from.size) / (to.size - from.size);
  }
  return curve.back().passing;
}

bool within_en13450_a(const SieveCurve& curve, std::string* why_not) {
  struct Limit {
    double size, lower, upper;  // [m], mass shares
  };
  constexpr std::array<Limit, 5> limits{
      {{0.0224, 0, 0.03}, {0.0315, 0, 0.25}, {0.040, 0.30, 0.65}, {0.050, 0.70, 1}, {0.063, 1, 1}}};
  constexpr double rounding = 1e-9;
  const auto refuse = [why_not](const char* format, double a, double b, double c, double d) {
    std::array<char, 200> text{};
    std::snprintf(text.data(), text.size(), format, a, b, c, d);
    if (why_not != nullptr) *why_not = text.data();
    return false;
  };
  for (const Limit& limit : limits) {
    const double share = passing(curve, limit.size);
    if (share < limit.lower - rounding || share > limit.upper + rounding) {
      return refuse("passing %.4g mm is %.3g %%; EN 13450 category A asks for %.3g to %.3g %%", 1e3 * limit.size,
                    100 * share, 100 * limit.lower, 100 * limit.upper);
    }
  }
  const double middle = passing(curve, 0.050) - passing(curve, 0.0315);
  if (middle < 0.5 - rounding) {
    return refuse("between %.4g and %.4g mm lie %.3g %%; EN 13450 category A asks for at least %.3g %%", 31.5, 50,
                  100 * middle, 50);
  }
  return true;
}

const std::vector<NamedGrading>& named_gradings() {
  constexpr std::string_view source = "EN 13450:2013 category A, as printed in Irazabal2017 Table 2.1";
  static const std::vector<NamedGrading> rows{
      {"en13450_a",
       "railway ballast 31.5/50, category A: the middle of its limits",
       source,
       {{0.0224, 0.015}, {0.0315, 0.125}, {0.040, 0.475}, {0.050, 0.85}, {0.063, 1}}},
      {"en13450_a_fine",
       "the finest that category A allows: its upper limits",
       source,
       {{0.0224, 0.03}, {0.0315, 0.25}, {0.040, 0.65}, {0.050, 1}}},
      {"en13450_a_coarse",
       "the coarsest that category A allows: its lower limits",
       source,
       {{0.0315, 0}, {0.040, 0.30}, {0.050, 0.70}, {0.063, 1}}}};
  return rows;
}

}  // namespace dem
