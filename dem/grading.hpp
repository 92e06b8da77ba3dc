#pragma once
// Grain sizes from a sieve curve.
//
// Model: a sieve curve gives the mass share P(d) of grains that pass a sieve of size d, linear between the sieves.
// Grains are spheres of one density, and a sphere passes a sieve of its own diameter. Mass spread evenly over d means
// numbers
//   n(d) dd ~ d^-3 dd  within a class d1 < d < d2,
// so the share u of the class's grains (largest first) lies above 1/d^2 = 1/d2^2 + u (1/d1^2 - 1/d2^2).
// A share P > 0 on the smallest sieve continues the first class's slope down to P = 0, at most to half that sieve.
// Source: EN 13450:2013 category A as printed in Irazabal2017 Table 2.1.
// Validity: the sizes are stratified (one per equal share of a class, at a random place in it), not drawn
// independently, so that a few thousand grains follow the curve; the exact share holds to half a grain at every sieve.
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dem {

/// One point of a sieve curve.
struct Sieve {
  double size = 0;     // [m] opening
  double passing = 0;  // mass share that passes, in [0, 1]
};
/// Rising sizes, passing not falling, the last one 1.
using SieveCurve = std::vector<Sieve>;

/// Random numbers that are the same on every machine and standard library: the engine's output is fixed by the C++
/// standard, the mapping to numbers is ours (std distributions are not fixed).
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  /// In [0, 1), 53 bits.
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  /// In [lower, upper).
  double uniform(double lower, double upper) { return lower + (upper - lower) * uniform(); }
  /// In [0, count).
  std::size_t index(std::size_t count) { return static_cast<std::size_t>(uniform() * static_cast<double>(count)); }

 private:
  std::mt19937_64 engine_;
};

/// Throws base::UserError (without origin) unless the curve is one: two or more sieves, rising, 0 to 1, last 1.
void check_curve(const SieveCurve&);

/// Mean volume [m3] of one grain (mean over numbers).
double mean_grain_volume(const SieveCurve&);

/// Radii [m], in random order, whose volumes add up to `solid_volume` [m3] within half of the smallest grains' volume.
std::vector<double> sample_radii(const SieveCurve&, double solid_volume, std::uint64_t seed);

/// A grain as a sieve sees it.
struct SizedGrain {
  double size = 0;    // [m] smallest square hole that it passes (dimensions.hpp); of a sphere its diameter
  double volume = 0;  // [m3] of its solid
};
/// Sieves the grains: mass share passing each of the sizes (rising or not); 0 without grains. Equal densities.
SieveCurve sieve(std::span<const SizedGrain>, std::span<const double> sizes);
/// The same for spheres.
SieveCurve sieve(std::span<const double> radii, std::span<const double> sizes);

/// Mass share that passes a sieve of this size: the curve itself, linear between its points.
double passing(const SieveCurve&, double size);

/// EN 13450 category A: passing 22.4 mm 0-3 %, 31.5 mm 0-25 %, 40 mm 30-65 %, 50 mm 70-100 %, 63 mm 100 %, and at
/// least 50 % between 31.5 and 50 mm (the row printed "32-50"). `why_not` tells the first limit that is broken.
bool within_en13450_a(const SieveCurve&, std::string* why_not = nullptr);

/// A curve that scenes know by name.
struct NamedGrading {
  std::string_view name, text, source;
  SieveCurve curve;
};
/// To add one: a row here, with its source; `trackbed list gradings` and scenes follow.
const std::vector<NamedGrading>& named_gradings();

}  // namespace dem
