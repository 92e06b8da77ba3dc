#pragma once
// Periodic directions. Whenever the neighbour lists are made, grains that have left through one face are put back in at
// the other, and grains near a face get images: rows behind those of the grains, one period away, that move with their
// grain. A pair across a face reads the row of an image and adds its force to the grain itself, so that contact laws
// and sweeps know nothing of periods, and a scene without them has none of this. A shift is a code from 0 to 26: 13 +
// sx + 3 sy + 9 sz with s = -1, 0, 1 periods; 13 is the grain itself.
#include "dem/core/rows.hpp"
#include "dem/dem.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

constexpr int no_shift = 13;
TRACKBED_HD inline int opposite(int shift) { return 26 - shift; }

struct Periods {
  Vec3 lower, length;  // [m] length 0: not periodic
  double margin = 0;   // [m] how far beyond a face a sphere may lie that meets one within it

  TRACKBED_HD bool any() const { return length.x > 0 || length.y > 0 || length.z > 0; }
  TRACKBED_HD Vec3 vector(int shift) const {
    return {(shift % 3 - 1) * length.x, (shift / 3 % 3 - 1) * length.y, (shift / 9 - 1) * length.z};
  }
  /// False for codes that shift along a direction which is not periodic.
  TRACKBED_HD bool exists(int shift) const {
    return (length.x > 0 || shift % 3 == 1) && (length.y > 0 || shift / 3 % 3 == 1) && (length.z > 0 || shift / 9 == 1);
  }
  TRACKBED_HD bool near_domain(const Vec3& p) const {
    for (int axis = 0; axis < 3; ++axis)
      if (length[axis] > 0 && (p[axis] < lower[axis] - margin || p[axis] > lower[axis] + length[axis] + margin))
        return false;
    return true;
  }
  /// Shift of j that brings it nearest to i; `between`: position of i minus that of j.
  TRACKBED_HD int nearest(const Vec3& between) const {
    int shift = no_shift;
    for (int axis = 0, weight = 1; axis < 3; ++axis, weight *= 3)
      if (length[axis] > 0 && std::fabs(between[axis]) > 0.5 * length[axis])
        shift += between[axis] > 0 ? weight : -weight;
    return shift;
  }
  /// From the nearest image of j to i.
  TRACKBED_HD Vec3 shortest(const Vec3& between) const { return any() ? between - vector(nearest(between)) : between; }
  /// What brings p back between the faces; not finite stays.
  TRACKBED_HD Vec3 return_path(const Vec3& p) const {
    Vec3 path;
    for (int axis = 0; axis < 3; ++axis)
      if (length[axis] > 0) path[axis] = -length[axis] * std::floor((p[axis] - lower[axis]) / length[axis]);
    return path;
  }
};

inline Periods periods_of(const std::array<Period, 3>& along) {
  Periods periods;
  for (int axis = 0; axis < 3; ++axis) {
    periods.lower[axis] = along[axis].lower;
    periods.length[axis] = along[axis].length;
  }
  return periods;
}

/// Where the images of grains are, as kernels see it.
struct ImageRows {
  const int* start = nullptr;  // per grain, and the end: its images, in the order of their codes
  const int* shift = nullptr;  // per image
  int first = 0;               // row of the first image

  /// Row of grain j shifted so. Every pair of the skin list has its image (Periods::margin); -1: none.
  TRACKBED_HD int row(int j, int wanted) const {
    if (wanted == no_shift) return j;
    for (int k = start[j]; k < start[j + 1]; ++k)
      if (shift[k] == wanted) return first + k;
    return -1;
  }
};

struct ReturnGrains {
  Periods periods;
  Place* place;
  TRACKBED_HD void operator()(int g) const { place[g].position += periods.return_path(place[g].position); }
};
struct ReturnBodies {
  Periods periods;
  Place *body, *sphere;
  const int* start;
  TRACKBED_HD void operator()(int b) const {
    const Vec3 path = periods.return_path(body[b].position);
    body[b].position += path;
    for (int s = start[b]; s < start[b + 1]; ++s) sphere[s].position += path;
  }
};

struct CountImages {
  Periods periods;
  const Place* place;
  int* count;
  TRACKBED_HD void operator()(int g) const {
    int images = 0;
    for (int shift = 0; shift < 27; ++shift)
      images +=
          shift != no_shift && periods.exists(shift) && periods.near_domain(place[g].position + periods.vector(shift));
    count[g] = images;
  }
};
struct NameImages {
  Periods periods;
  const Place* place;
  const int* start;
  int *owner, *shift;
  TRACKBED_HD void operator()(int g) const {
    int k = start[g];
    for (int s = 0; s < 27; ++s)
      if (s != no_shift && periods.exists(s) && periods.near_domain(place[g].position + periods.vector(s))) {
        owner[k] = g;
        shift[k++] = s;
      }
  }
};
struct MoveImages {
  Periods periods;
  const int *owner, *shift;
  int first, parts;
  Place* place;
  Quad* motion;
  TRACKBED_HD void operator()(int k) const {
    const int g = owner[k], row = first + k;
    place[row] = {place[g].position + periods.vector(shift[k]), place[g].radius};
    for (int part = 0; part < parts; ++part) motion[parts * row + part] = motion[parts * g + part];
  }
};

struct Images {
  Vector<int> start, owner, shift;
  int first = 0;

  int size() const { return static_cast<int>(owner.size()); }
  /// The grain of a row (host).
  int grain(int row) const { return size() > 0 && row >= first ? owner[row - first] : row; }
  ImageRows rows() const { return {pointer(start), pointer(shift), first}; }
  std::size_t bytes() const { return bytes_of(start) + bytes_of(owner) + bytes_of(shift); }
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
