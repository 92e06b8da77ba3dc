#include "dem/sphere_union.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace dem {
namespace {
using std::numbers::pi;

constexpr double coincident = 1e-12;  // directions and cosines nearer than this are one

/// Part of a unit sphere inside another sphere: n . axis > cosine.
struct Cap {
  Vec3 axis;
  double cosine;
};

/// Arc of the circle around a cap, phi from `from` to `to` (> from).
struct Arc {
  double from, to;
};

/// Integrals over what is left of one unit sphere; `contracted` is int n_a n_b (c . n).
struct ExposedMoments {
  double area = 0;
  Vec3 first{};
  SymmetricTensor second, contracted;
};

double dot(const SymmetricTensor& t, const Vec3& v, int row) {
  if (row == 0) return t.xx * v.x + t.xy * v.y + t.xz * v.z;
  if (row == 1) return t.xy * v.x + t.yy * v.y + t.yz * v.z;
  return t.xz * v.x + t.yz * v.y + t.zz * v.z;
}

/// The circle around a cap: n = c axis + s (u cos phi + v sin phi).
struct Circle {
  explicit Circle(const Cap& cap)
      : axis(cap.axis), c(cap.cosine), s(std::sqrt(std::max(0.0, 1 - cap.cosine * cap.cosine))) {
    const Vec3 least = std::fabs(axis.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    u = cross(axis, least);
    u *= 1.0 / norm(u);
    v = cross(axis, u);
  }
  Vec3 axis, u, v;
  double c, s;
};

/// What the other caps leave of a circle.
std::vector<Arc> exposed_arcs(const Circle& circle, std::size_t own, const std::vector<Cap>& caps) {
  std::vector<Arc> hidden;
  for (std::size_t k = 0; k < caps.size(); ++k) {
    if (k == own) continue;
    const double level = caps[k].cosine - circle.c * base::dot(caps[k].axis, circle.axis);
    const double a = base::dot(caps[k].axis, circle.u), b = base::dot(caps[k].axis, circle.v);
    const double amplitude = circle.s * std::hypot(a, b);
    if (level < -amplitude + coincident) return {};
    if (level >= amplitude) continue;
    const double middle = std::atan2(b, a), half = std::acos(std::clamp(level / amplitude, -1.0, 1.0));
    double from = middle - half, to = middle + half;
    if (from < -pi) {
      hidden.push_back({from + 2 * pi, pi});
      from = -pi;
    }
    if (to > pi) {
      hidden.push_back({-pi, to - 2 * pi});
      to = pi;
    }
    hidden.push_back({from, to});
  }
  std::sort(hidden.begin(), hidden.end(), [](const Arc& a, const Arc& b) { return a.from < b.from; });
  std::vector<Arc> exposed;
  double reached = -pi;
  for (const Arc& arc : hidden) {
    if (arc.from > reached) exposed.push_back({reached, arc.from});
    reached = std::max(reached, arc.to);
  }
  if (reached < pi) exposed.push_back({reached, pi});
  return exposed;
}

/// Primitive of |q_a - c| / 2 / (A - B cos psi), which rises by pi every turn.
double half_angle_primitive(double psi, double kappa) {
  const double turns = std::round(psi / (2 * pi)), rest = psi - 2 * pi * turns;
  return pi * turns + std::atan2(kappa * std::sin(0.5 * rest), std::cos(0.5 * rest));
}

/// Share of an arc in the area of W, with respect to the pole q.
double area_of(const Circle& circle, const Arc& arc, const Vec3& q) {
  const double q_a = base::dot(q, circle.axis), q_u = base::dot(q, circle.u), q_v = base::dot(q, circle.v);
  const double gap = std::fabs(q_a - circle.c);
  const double kappa = (1 - circle.c * q_a + circle.s * std::hypot(q_u, q_v)) / gap;
  const double phase = std::atan2(q_v, q_u);
  const double rise = half_angle_primitive(arc.to - phase, kappa) - half_angle_primitive(arc.from - phase, kappa);
  return circle.c * (arc.to - arc.from) + (q_a > circle.c ? 2 : -2) * rise;
}

/// The pole farthest from all circles out of points spread over the sphere (golden spiral).
Vec3 best_pole(const std::vector<Cap>& caps) {
  constexpr int count = 64;
  Vec3 best{0, 0, 1};
  double best_gap = -1;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, phi = i * pi * (3 - std::sqrt(5.0)), s = std::sqrt(1 - z * z);
    const Vec3 q{s * std::cos(phi), s * std::sin(phi), z};
    double gap = 2;
    for (const Cap& cap : caps) gap = std::min(gap, std::fabs(base::dot(q, cap.axis) - cap.cosine));
    if (gap > best_gap) best = q;
    best_gap = std::max(gap, best_gap);
  }
  return best;
}

/// Gauss-Legendre, 8 points: pieces of pi/4 of a trigonometric polynomial of degree 3 to 1e-17.
constexpr std::array<double, 4> gauss_point{0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                            0.9602898564975363};
constexpr std::array<double, 4> gauss_weight{0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                             0.1012285362903763};

ExposedMoments exposed_moments(const std::vector<Cap>& caps, const Vec3& centre) {
  const Vec3 pole = best_pole(caps);
  bool pole_exposed = true;
  for (const Cap& cap : caps) pole_exposed = pole_exposed && base::dot(pole, cap.axis) <= cap.cosine;
  ExposedMoments m;
  m.area = pole_exposed ? 4 * pi : 0;
  SymmetricTensor n_nu, n_n_nu;  // oint n nu ds, oint n n (centre . nu) ds
  for (std::size_t k = 0; k < caps.size(); ++k) {
    const Circle circle(caps[k]);
    if (circle.s < coincident) continue;
    for (const Arc& arc : exposed_arcs(circle, k, caps)) {
      m.area += area_of(circle, arc, pole);
      const int pieces = static_cast<int>(std::ceil((arc.to - arc.from) / (pi / 4)));
      const double half = 0.5 * (arc.to - arc.from) / pieces;
      for (int i = 0; i < 8 * pieces; ++i) {
        const double sign = i % 8 < 4 ? -1 : 1;
        const double phi = arc.from + half * (2 * (i / 8) + 1 + sign * gauss_point[i % 4]);
        const double weight = half * gauss_weight[i % 4] * circle.s;
        const Vec3 outward = std::cos(phi) * circle.u + std::sin(phi) * circle.v;
        const Vec3 n = circle.c * circle.axis + circle.s * outward;
        const Vec3 nu = circle.s * circle.axis - circle.c * outward;
        m.first -= (0.5 * weight) * nu;
        add_product(n_nu, weight, n, nu);
        add_product(n_n_nu, weight * base::dot(centre, nu), n, n);
      }
    }
  }
  add(m.second, m.area / 3, {1, 1, 1, 0, 0, 0});
  add(m.second, -1.0 / 3.0, n_nu);
  add_product(m.contracted, 0.5, centre, m.first);
  add(m.contracted, -1.0 / 4.0, n_n_nu);
  return m;
}

/// Caps that the others cut from sphere i; false when it lies inside another (of equal spheres the first stays).
bool find_caps(std::span<const Sphere> spheres, std::size_t i, std::vector<Cap>& caps) {
  caps.clear();
  for (std::size_t j = 0; j < spheres.size(); ++j) {
    if (j == i) continue;
    const Vec3 way = spheres[j].position - spheres[i].position;
    const double distance = norm(way), own = spheres[i].radius, other = spheres[j].radius;
    if (distance >= own + other) continue;
    const bool equal = distance <= coincident * own && std::fabs(own - other) <= coincident * own;
    if (equal ? j < i : distance <= other - own) return false;
    if (equal || distance <= own - other) continue;
    const Cap cap{(1.0 / distance) * way, (distance * distance + own * own - other * other) / (2 * distance * own)};
    const bool known = std::any_of(caps.begin(), caps.end(), [&](const Cap& c) {
      return norm(c.axis - cap.axis) < coincident && std::fabs(c.cosine - cap.cosine) < coincident;
    });
    if (!known) caps.push_back(cap);
  }
  return true;
}

}  // namespace

MassProperties union_properties(std::span<const Sphere> spheres) {
  Vec3 origin;
  for (const Sphere& sphere : spheres) origin += (1.0 / static_cast<double>(spheres.size())) * sphere.position;
  VolumeMoments total;
  std::vector<Cap> caps;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    if (!find_caps(spheres, i, caps)) continue;
    const double r = spheres[i].radius;
    const Vec3 c = spheres[i].position - origin;
    const ExposedMoments m = exposed_moments(caps, c);
    const double flux = base::dot(c, m.first) + r * m.area;  // int (x . n) over the exposed part / r^2
    Vec3 turned;                                             // int n (x . n) / r^2
    for (int a = 0; a < 3; ++a) turned[a] = dot(m.second, c, a) + r * m.first[a];
    total.volume += r * r / 3 * flux;
    total.first += (r * r / 4) * (flux * c + r * turned);
    add_product(total.second, r * r / 5 * flux, c, c);
    add_product(total.second, 2 * r * r * r / 5, c, turned);
    add(total.second, r * r * r * r / 5, m.contracted);
    add(total.second, r * r * r * r * r / 5, m.second);
  }
  return mass_properties(total, origin);
}

}  // namespace dem
