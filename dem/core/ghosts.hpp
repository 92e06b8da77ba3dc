#pragma once
// Spheres of neighbouring parts (dem/company.hpp) that spheres here might touch. They are rows behind those of the own
// spheres: contacts read them like any other, but nothing moves them here; once a step place and motion come from their
// originals. A pair of an own sphere and a ghost is worked out in both parts; its energies count half in each.
#include <cstring>
#include <unordered_map>

#include "dem/core/grains.hpp"
#include "dem/core/queue.hpp"
#include "dem/laws.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

/// A sphere, whichever part it is in: its grain, and its number among the grain's spheres.
struct SphereKey {
  std::int64_t grain = -1, sphere = 0;
  bool operator==(const SphereKey&) const = default;
  bool operator<(const SphereKey& other) const {
    return grain != other.grain ? grain < other.grain : sphere < other.sphere;
  }
};
struct HashKey {
  std::size_t operator()(const SphereKey& key) const {
    return std::hash<std::int64_t>()(key.grain * 1048583 + key.sphere);
  }
};
using RowOfKey = std::unordered_map<SphereKey, int, HashKey>;

/// Rows of trivially copyable values as bytes.
class LetterWriter {
 public:
  explicit LetterWriter(Company::Letter& to) : to_(to) {}
  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::size_t at = to_.size();
    to_.resize(at + sizeof(T));
    std::memcpy(to_.data() + at, &value, sizeof(T));
  }
  template <class T>
  void put_rows(const T* first, std::size_t number) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::size_t at = to_.size();
    to_.resize(at + number * sizeof(T));
    if (number > 0) std::memcpy(to_.data() + at, first, number * sizeof(T));
  }

 private:
  Company::Letter& to_;
};

class LetterReader {
 public:
  explicit LetterReader(const Company::Letter& from) : from_(from) {}
  bool ends() const { return at_ == from_.size(); }
  template <class T>
  T get() {
    T value;
    get_rows(&value, 1);
    return value;
  }
  template <class T>
  void get_rows(T* first, std::size_t number) {
    base::require_internal(at_ + number * sizeof(T) <= from_.size(), "a letter between parts is too short");
    std::memcpy(static_cast<void*>(first), from_.data() + at_, number * sizeof(T));
    at_ += number * sizeof(T);
  }

 private:
  const Company::Letter& from_;
  std::size_t at_ = 0;
};

/// What a contact remembers on its way to another part: of the pair {a, b} in this order, or of sphere a at a facet.
struct ContactMemory {
  SphereKey a, b;
  int kind = 0;  // materials of the pair; facet
  int numbers = 0;
  double history[maximum_numbers] = {};
  double elastic_normal = 0, elastic_shear = 0;  // [J] at a facet
  WallState state;
};

struct Ghosts {
  int first = 0;                    // row of the first ghost
  std::vector<SphereKey> keys;      // of every own row and ghost as they were listed
  std::array<int, 2> count{};       // ghosts from below, from above; in this order behind the own rows
  std::array<double, 2> shift{};    // [m] along x that the ghosts of that side lie away from their originals
  std::array<Vector<int>, 2> sent;  // rows whose ghosts the neighbours have
  // Rows on their way, here and on the host:
  std::array<Vector<double>, 2> leaving, arriving;
  std::array<HostRows<double>, 2> leaving_host, arriving_host;
  std::array<Company::Letter, 2> out, in;
  std::vector<double> cuts;  // [m] between the parts, rising; empty: no grains so far
  /// That hold from the next advance() on; empty: the same. So that it is known between two advances which grains the
  /// next one can bring here.
  std::vector<double> next_cuts;
  double work = 0;            // of this part when its lists were made: spheres and pairs looked at
  double imbalance = 1;       // largest over mean work of all parts
  std::vector<int> material;  // of `keys`
  // Between migration and the lists that follow it:
  RowOfKey left;  // rows that own spheres had which have gone
  std::vector<ContactMemory> brought_pairs, brought_walls;

  int size() const { return count[0] + count[1]; }
  int total() const { return first + size(); }
  double shift_of(int row) const { return row < first ? 0 : shift[row < first + count[0] ? 0 : 1]; }
  std::int64_t grain(int row) const { return keys[static_cast<std::size_t>(row)].grain; }
};

/// Place and motion of one sphere as they are sent: position, velocity, and where grains turn angular velocity.
struct PackRows {
  const int* row;
  const Place* place;
  Rows<const Quad> motion;
  double shift;  // [m] along x
  double* to;
  TRACKBED_HD void operator()(int k) const {
    const int g = row[k], width = 3 + 3 * motion.parts;
    double* at = to + static_cast<long long>(width) * k;
    const auto put = [&](const Vec3& v, double along) {
      at[0] = v.x + along;
      at[1] = v.y;
      at[2] = v.z;
      at += 3;
    };
    put(place[g].position, shift);
    put(motion.translation(g).vector, 0);
    if (motion.parts == 2) put(motion.rotation(g).vector, 0);
  }
};
struct UnpackRows {
  int first;  // row
  Place* place;
  Rows<Quad> motion;
  const double* from;
  TRACKBED_HD void operator()(int k) const {
    const int g = first + k, width = 3 + 3 * motion.parts;
    const double* at = from + static_cast<long long>(width) * k;
    place[g].position = {at[0], at[1], at[2]};
    motion.translation(g).vector = {at[3], at[4], at[5]};
    if (motion.parts == 2) motion.rotation(g).vector = {at[6], at[7], at[8]};
  }
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
