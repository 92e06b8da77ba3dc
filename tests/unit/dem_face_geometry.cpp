// Contacts on element faces (base/face.hpp, dem/kernels/wall_geometry.hpp, dem/kernels/face_geometry.hpp): the nearest
// point, and what the nodes of triangles of three and six and quadrilaterals of four and eight nodes receive.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "dem/kernels/face_geometry.hpp"

using base::Vec3;
using namespace dem::kernels;

namespace {

using Face = std::vector<Vec3>;

struct Place {
  double r, s;
};

Place place_of(int nodes, int a) {
  Place at{};
  if (nodes % 3 == 0)
    coordinates_of(6, a, at.r, at.s);
  else
    coordinates_of(8, a, at.r, at.s);
  return at;
}

/// A face with sides of about 1 m whose nodes have been moved by up to `most` in the plane and `bent` times that out.
Face distorted(int nodes, double most, double bent, std::mt19937& random) {
  std::uniform_real_distribution<double> any(-most, most);
  const double scale = nodes % 3 == 0 ? 1 : 0.5;
  Face face;
  for (int a = 0; a < nodes; ++a) {
    const Place at = place_of(nodes, a);
    face.push_back({scale * at.r + any(random), scale * at.s + any(random), bent * any(random)});
  }
  return face;
}

Vec3 at(const Face& face, Place place) {
  const auto shapes = base::face_shapes(static_cast<int>(face.size()), place.r, place.s);
  Vec3 x;
  for (std::size_t a = 0; a < face.size(); ++a) x += shapes.value[a] * face[a];
  return x;
}

/// Outward normal times the area per unit of r and s.
Vec3 area_at(const Face& face, Place place) {
  const auto shapes = base::face_shapes(static_cast<int>(face.size()), place.r, place.s);
  Vec3 x_r, x_s;
  for (std::size_t a = 0; a < face.size(); ++a) {
    x_r += shapes.along_r[a] * face[a];
    x_s += shapes.along_s[a] * face[a];
  }
  return cross(x_r, x_s);
}

struct Hit {
  Feature feature;
  Vec3 point;
  std::array<double, 8> share{};
};

Hit touch(const Face& face, const Vec3& centre, double reach) {
  const int nodes = static_cast<int>(face.size());
  Hit hit{};
  if (nodes <= 4) {
    const auto contact = closest_on_facet(face.data(), nodes, centre, reach);
    hit = {contact.feature, contact.point};
    std::copy_n(contact.weights, nodes, hit.share.begin());
  } else {
    const double start = nodes == 6 ? 1.0 / 3.0 : 0;
    const auto contact = closest_on_face(face.data(), nodes, centre, reach, start, start);
    const auto shapes = base::face_shapes(nodes, contact.r, contact.s);
    hit = {contact.feature, contact.point};
    std::copy_n(shapes.value, nodes, hit.share.begin());
  }
  return hit;
}

/// Visits n x n cells of the face's coordinates, each with its middle and its share of their area.
template <class Visit>
void each_cell(int nodes, int n, Visit&& visit) {
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double u = (i + 0.5) / n, v = (j + 0.5) / n;
      if (nodes % 3 == 0)
        visit(Place{u, v * (1 - u)}, (1 - u) / (n * n));  // the square collapsed onto the triangle
      else
        visit(Place{2 * u - 1, 2 * v - 1}, 4.0 / (n * n));
    }
}

// Gauss points and weights of five points on [-1, 1], exact for polynomials up to degree 9 (Abramowitz & Stegun 25.4).
constexpr double gauss_at[5] = {-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831, 0.9061798459386640};
constexpr double gauss_share[5] = {0.2369268850561891, 0.4786286704993665, 128.0 / 225.0, 0.4786286704993665,
                                   0.2369268850561891};

/// Visits 5 x 5 Gauss points of the face's coordinates.
template <class Visit>
void each_gauss_point(int nodes, Visit&& visit) {
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) {
      const double u = 0.5 * (1 + gauss_at[i]), v = 0.5 * (1 + gauss_at[j]);
      const double share = 0.25 * gauss_share[i] * gauss_share[j];
      if (nodes % 3 == 0)
        visit(Place{u, v * (1 - u)}, share * (1 - u));
      else
        visit(Place{gauss_at[i], gauss_at[j]}, 4 * share);
    }
}

using Forces = std::array<Vec3, 8>;

/// Nodal forces of the pressure p = p0 + g . x, integrated over the face with its shape functions.
Forces consistent(const Face& face, double p0, const Vec3& g) {
  Forces forces{};
  each_gauss_point(static_cast<int>(face.size()), [&](Place place, double share) {
    const auto shapes = base::face_shapes(static_cast<int>(face.size()), place.r, place.s);
    const Vec3 force = (-share * (p0 + dot(g, at(face, place)))) * area_at(face, place);
    for (std::size_t a = 0; a < face.size(); ++a) forces[a] += shapes.value[a] * force;
  });
  return forces;
}

/// The same pressure pressed in by spheres of radius 0.05 m that touch the face at a place with its share of the area.
struct Pressing {
  const Face& face;
  double p0;
  Vec3 g;
  Forces forces{};
  void operator()(Place place, double share) {
    const Vec3 area = area_at(face, place), x = at(face, place);
    const Hit hit = touch(face, x + (0.05 / norm(area)) * area, 0.06);
    ASSERT_NE(hit.feature, Feature::none);
    const Vec3 force = (-share * (p0 + dot(g, x))) * area;
    for (std::size_t a = 0; a < face.size(); ++a) forces[a] += hit.share[a] * force;
  }
};

double largest_difference(const Forces& a, const Forces& b) {
  double most = 0;
  for (int k = 0; k < 8; ++k) most = std::max(most, norm(a[k] - b[k]));
  return most;
}

/// Functions of the nodes that are polynomials in Cartesian coordinates, as all functions of area coordinates are (an
/// area coordinate, the area of P with a side over the face's, is linear in x and y): the serendipity monomials of
/// 2 (L_3 - L_1) and 2 (L_0 - L_2), which are r and s of a parallelogram.
class AreaFunctions {
 public:
  explicit AreaFunctions(const Face& face) : face_(face) {
    for (int row = 0; row < 8; ++row) {
      const auto terms = monomials(face[row]);
      for (int k = 0; k < 8; ++k) matrix_[row][k] = terms[k];
      matrix_[row][8 + row] = 1;
    }
    for (int k = 0; k < 8; ++k) {  // Gauss-Jordan with row exchange
      int pivot = k;
      for (int row = k; row < 8; ++row)
        if (std::abs(matrix_[row][k]) > std::abs(matrix_[pivot][k])) pivot = row;
      std::swap(matrix_[k], matrix_[pivot]);
      const double scale = matrix_[k][k];
      for (double& value : matrix_[k]) value /= scale;
      for (int row = 0; row < 8; ++row) {
        const double factor = matrix_[row][k];
        for (int c = 0; c < 16 && row != k; ++c) matrix_[row][c] -= factor * matrix_[k][c];
      }
    }
  }
  std::array<double, 8> at(const Vec3& x) const {
    const auto terms = monomials(x);
    std::array<double, 8> values{};
    for (int a = 0; a < 8; ++a)
      for (int k = 0; k < 8; ++k) values[a] += terms[k] * matrix_[k][8 + a];
    return values;
  }

 private:
  std::array<double, 8> monomials(const Vec3& x) const {
    double area[4], whole = 0;
    for (int a = 0; a < 4; ++a) {
      const Vec3 &from = face_[a], &to = face_[(a + 1) % 4];
      area[a] = cross(to - from, x - from).z;
      whole += cross(from, to).z;
    }
    const double r = 2 * (area[3] - area[1]) / whole, s = 2 * (area[0] - area[2]) / whole;
    return {1, r, s, r * r, r * s, s * s, r * r * s, r * s * s};
  }
  Face face_;
  std::array<std::array<double, 16>, 8> matrix_{};
};

/// Largest difference between those and the face's own functions.
double area_coordinates_miss(const Face& face) {
  const AreaFunctions functions(face);
  double most = 0;
  each_cell(8, 40, [&](Place place, double) {
    const auto own = base::face_shapes(8, place.r, place.s);
    const auto other = functions.at(at(face, place));
    for (int a = 0; a < 8; ++a) most = std::max(most, std::abs(own.value[a] - other[a]));
  });
  return most;
}

Face with_middles(const std::array<Vec3, 4>& corners) {
  Face face(corners.begin(), corners.end());
  for (int a = 0; a < 4; ++a) face.push_back(0.5 * (corners[a] + corners[(a + 1) % 4]));
  return face;
}

constexpr int kinds[4] = {3, 4, 6, 8};

}  // namespace

// N_a(x_b) = delta_ab, sum 1, sum N_a x_a of the reference nodes is the place itself, derivatives by central
// differences (whose error for cubic functions is h^2/6 times the third derivative, at most 2).
TEST(FaceGeometry, ShapeFunctions) {
  for (const int nodes : kinds) {
    for (int b = 0; b < nodes; ++b) {
      const Place node = place_of(nodes, b);
      const auto shapes = base::face_shapes(nodes, node.r, node.s);
      for (int a = 0; a < nodes; ++a) EXPECT_EQ(shapes.value[a], a == b ? 1 : 0) << nodes << ' ' << a << ' ' << b;
    }
    each_cell(nodes, 5, [&](Place place, double) {
      const double h = 1e-4;
      const auto shapes = base::face_shapes(nodes, place.r, place.s);
      const auto right = base::face_shapes(nodes, place.r + h, place.s),
                 up = base::face_shapes(nodes, place.r, place.s + h);
      const auto left = base::face_shapes(nodes, place.r - h, place.s),
                 down = base::face_shapes(nodes, place.r, place.s - h);
      double sum = 0, r = 0, s = 0;
      for (int a = 0; a < nodes; ++a) {
        const Place node = place_of(nodes, a);
        sum += shapes.value[a];
        r += shapes.value[a] * node.r;
        s += shapes.value[a] * node.s;
        EXPECT_NEAR(shapes.along_r[a], (right.value[a] - left.value[a]) / (2 * h), h * h);
        EXPECT_NEAR(shapes.along_s[a], (up.value[a] - down.value[a]) / (2 * h), h * h);
      }
      EXPECT_NEAR(sum, 1, 1e-14);
      EXPECT_NEAR(r, place.r, 1e-14);
      EXPECT_NEAR(s, place.s, 1e-14);
    });
  }
}

// Every kind of face, distorted and bent, touched from anywhere: the shares sum up to 1, the contact point is where
// they say it is, so that force and moment arrive whole and a rigid motion of the nodes is that of the point. On the
// plane parts of a bent face the moment would miss by the force times the distance to the face, 1e-2 here.
TEST(FaceGeometry, ForceMomentAndRigidMotion) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  int inside = 0, on_sides = 0;
  for (const int nodes : kinds)
    for (int sample = 0; sample < 2000; ++sample) {
      const Face face = distorted(nodes, 0.08, 1, random);
      const Hit hit = touch(face, {0.8 * any(random), 0.8 * any(random), 0.3 * any(random)}, 10);
      ASSERT_NE(hit.feature, Feature::none);
      ++(hit.feature == Feature::facet ? inside : on_sides);
      const Vec3 force{any(random), any(random), any(random)}, spin{any(random), any(random), any(random)};
      const Vec3 speed{any(random), any(random), any(random)};
      Vec3 total, moment, velocity;
      for (int a = 0; a < nodes; ++a) {
        total += hit.share[a] * force;
        moment += cross(face[a], hit.share[a] * force);
        velocity += hit.share[a] * (speed + cross(spin, face[a]));
      }
      EXPECT_LT(norm(total - force), 1e-13);
      EXPECT_LT(norm(moment - cross(hit.point, force)), 1e-13);
      EXPECT_LT(norm(velocity - speed - cross(spin, hit.point)), 1e-13);
    }
  EXPECT_GT(inside, 1000);
  EXPECT_GT(on_sides, 1000);
}

// No point of a fine grid is nearer than the one found, which lies on the face.
TEST(FaceGeometry, NearestPointAgainstGridSearch) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1, 1);
  for (const int nodes : {6, 8})
    for (int sample = 0; sample < 300; ++sample) {
      const Face face = distorted(nodes, 0.08, 0.5, random);
      const Vec3 centre{0.9 * any(random), 0.9 * any(random), 0.5 * any(random)};
      const Hit hit = touch(face, centre, 10);
      double nearest = 1e300;
      each_cell(nodes, 40, [&](Place place, double) { nearest = std::min(nearest, norm(centre - at(face, place))); });
      EXPECT_LT(norm(centre - hit.point), nearest + 1e-12) << nodes << ' ' << sample;
    }
}

// The two faces of a bent side find the same point to the last bit, whichever way they walk it.
TEST(FaceGeometry, CommonSide) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> any(-0.1, 0.1);
  const auto shaken = [&](Vec3 x) { return x + Vec3{any(random), any(random), any(random)}; };
  for (int sample = 0; sample < 200; ++sample) {
    const Vec3 a = shaken({0, 0, 0}), b = shaken({1, 0, 0}), middle = shaken({0.5, 0, 0});
    const Face below{shaken({0, -1, -1}),  shaken({1, -1, -1}),   b,      a,
                     shaken({.5, -1, -1}), shaken({1, -.5, -.5}), middle, shaken({0, -.5, -.5})};
    const Face above{a, b, shaken({0.5, 1, -1}), middle, shaken({.75, .5, -.5}), shaken({.25, .5, -.5})};
    const Vec3 centre{0.5 + 4 * any(random), 0, 0.5};
    const Hit one = touch(below, centre, 10), other = touch(above, centre, 10);
    if (one.feature != Feature::edge || other.feature != Feature::edge) continue;
    EXPECT_EQ(norm(one.point - other.point), 0);
  }
}

// The bound by which plane parts are looked for farther than the sphere reaches.
TEST(FaceGeometry, PlanePartsAreAsNearAsTheySay) {
  constexpr int triangles[4][4] = {{0, 3, 5, -1}, {1, 4, 3, -1}, {2, 5, 4, -1}, {3, 4, 5, -1}};
  constexpr int quadrilaterals[5][4] = {{0, 4, 7, -1}, {1, 5, 4, -1}, {2, 6, 5, -1}, {3, 7, 6, -1}, {4, 5, 6, 7}};
  std::mt19937 random(5);
  double tightest = 1;
  for (const int nodes : {6, 8})
    for (int sample = 0; sample < 200; ++sample) {
      const Face face = distorted(nodes, 0.1, 1, random);
      const double bound = departure(face.data(), nodes);
      for (int k = 0; k < nodes / 2 + 1; ++k) {
        const int* part = nodes == 6 ? triangles[k] : quadrilaterals[k];
        const int corners = part[3] < 0 ? 3 : 4;
        each_cell(corners, 8, [&](Place place, double) {
          const auto shapes = base::face_shapes(corners, place.r, place.s);
          Vec3 x;
          Place on{0, 0};
          for (int c = 0; c < corners; ++c) {
            const Place node = place_of(nodes, part[c]);
            x += shapes.value[c] * face[part[c]];
            on.r += shapes.value[c] * node.r;
            on.s += shapes.value[c] * node.s;
          }
          const double gap = norm(at(face, on) - x);
          EXPECT_LE(gap, bound + 1e-15);
          tightest = std::min(tightest, 1 - gap / bound);
        });
      }
    }
  EXPECT_LT(tightest, 0.5);  // no idle bound
}

// A pressure linear in space on distorted, bent faces. Spheres at the 5 x 5 Gauss points, each with the force of its
// share, must give the consistent nodal forces to rounding: the integrand is a polynomial (degree 7 in r and in s for
// eight nodes), so both are exact, and what is left is the error of the point found: 1e-12 of the largest force. Any
// other functions than the face's own give per cents. Spheres in equal cells give them with the error of the midpoint
// rule, of second order: four times less at twice as many (5 per cent for the terms of fourth order).
TEST(FaceGeometry, LinearPressure) {
  std::mt19937 random(17);
  const double p0 = 2;
  const Vec3 g{1.5, -0.7, 0.4};
  for (const int nodes : kinds)
    for (int sample = 0; sample < 20; ++sample) {
      const Face face = distorted(nodes, 0.06, nodes == 3 ? 1 : 0.3, random);
      const Forces exact = consistent(face, p0, g);
      Vec3 sum, pressed;
      Pressing at_points{face, p0, g}, coarse{face, p0, g}, fine{face, p0, g};
      each_gauss_point(nodes, at_points);
      each_cell(nodes, 12, coarse);
      each_cell(nodes, 24, fine);
      double largest = 0;
      for (int a = 0; a < nodes; ++a) largest = std::max(largest, norm(exact[a]));
      EXPECT_LT(largest_difference(at_points.forces, exact), 1e-12 * largest) << nodes;
      const double error = largest_difference(coarse.forces, exact);
      EXPECT_LT(error, 0.02 * largest);
      EXPECT_NEAR(error / largest_difference(fine.forces, exact), 4, 0.2) << nodes;
    }
}

// Values linear in space at the nodes are linear at every contact point, on every face.
TEST(FaceGeometry, LinearFieldsPassExactly) {
  std::mt19937 random(23);
  const Vec3 g{0.3, -1.1, 0.8};
  for (const int nodes : kinds)
    for (int sample = 0; sample < 20; ++sample) {
      const Face face = distorted(nodes, 0.08, 1, random);
      each_cell(nodes, 4, [&](Place place, double) {
        const Hit hit = touch(face, at(face, place) + Vec3{0, 0, 0.05}, 1);
        double value = 0;
        for (int a = 0; a < nodes; ++a) value += hit.share[a] * (1 + dot(g, face[a]));
        EXPECT_NEAR(value, 1 + dot(g, hit.point), 1e-14);
      });
    }
}

// Why not area coordinates: on a parallelogram they give the face's own functions, on a distorted face others.
// Measured: largest error of a share 0.62 on the trapezoid, 0.11 with the bowed side.
TEST(FaceGeometry, AreaCoordinatesOnlySuitParallelograms) {
  const Face parallelogram = with_middles({Vec3{0, 0, 0}, {2, 0.2, 0}, {2.5, 1.4, 0}, {0.5, 1.2, 0}});
  const Face trapezoid = with_middles({Vec3{-1, -1, 0}, {1, -1, 0}, {0.5, 1, 0}, {-0.5, 1, 0}});
  Face bowed = with_middles({Vec3{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}});
  bowed[4].y -= 0.2;  // a tenth of the side
  EXPECT_LT(area_coordinates_miss(parallelogram), 1e-12);
  EXPECT_GT(area_coordinates_miss(trapezoid), 0.1);
  EXPECT_GT(area_coordinates_miss(bowed), 0.1);
}
