#include "tests/ptx/operations.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <type_traits>

#include "tests/ptx/warp.hpp"

namespace ptx {
namespace {

using Run = void (*)(Warp&, const Instruction&, Lanes);
using std::int16_t, std::int32_t, std::int64_t, std::int8_t, std::uint16_t, std::uint32_t, std::uint64_t, std::uint8_t;
using Wide = unsigned __int128;

/// A value in the low bytes of a register.
template <class T>
T as(std::uint64_t bits) {
  if constexpr (std::is_same_v<T, float>)
    return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
  else if constexpr (std::is_same_v<T, double>)
    return std::bit_cast<double>(bits);
  else if constexpr (std::is_same_v<T, bool>)
    return bits & 1;
  else
    return static_cast<T>(bits);
}
template <class T>
std::uint64_t bits(T value) {
  if constexpr (std::is_same_v<T, float>)
    return std::bit_cast<std::uint32_t>(value);
  else if constexpr (std::is_same_v<T, double>)
    return std::bit_cast<std::uint64_t>(value);
  else
    return static_cast<std::uint64_t>(value);  // signed ones keep their sign in what lies above
}

template <auto f, class R, class... A, std::size_t... k>
void apply_at(Warp& w, const Instruction& i, Lanes lanes, std::index_sequence<k...>) {
  std::uint64_t* to = w.row(i.to[0]);
  const std::uint64_t* from[] = {w.value(i.from[k])...};
  if (lanes == all_lanes) {
#pragma GCC ivdep
    for (int lane = 0; lane < warp_size; ++lane) to[lane] = bits<R>(static_cast<R>(f(as<A>(from[k][lane])...)));
  } else {
    for (; lanes; lanes &= lanes - 1) {
      const int lane = std::countr_zero(lanes);
      to[lane] = bits<R>(static_cast<R>(f(as<A>(from[k][lane])...)));
    }
  }
}
/// to[0] = f(from...), lane by lane.
template <auto f, class R, class... A>
void apply(Warp& w, const Instruction& i, Lanes lanes) {
  apply_at<f, R, A...>(w, i, lanes, std::index_sequence_for<A...>());
}

/// f<T>() of what there is arithmetic for.
template <class F>
auto by_type(std::string_view type, F f) -> Run {
  if (type == "u16" || type == "b16") return f.template operator()<uint16_t>();
  if (type == "s16") return f.template operator()<int16_t>();
  if (type == "u32" || type == "b32") return f.template operator()<uint32_t>();
  if (type == "s32") return f.template operator()<int32_t>();
  if (type == "u64" || type == "b64") return f.template operator()<uint64_t>();
  if (type == "s64") return f.template operator()<int64_t>();
  if (type == "f32") return f.template operator()<float>();
  if (type == "f64") return f.template operator()<double>();
  return nullptr;
}
/// And of bytes, which are only moved and converted.
template <class F>
auto by_any_type(std::string_view type, F f) -> Run {
  if (type == "u8" || type == "b8") return f.template operator()<uint8_t>();
  if (type == "s8") return f.template operator()<int8_t>();
  return by_type(type, f);
}
template <class T>
struct AsUnsigned {
  using Type = T;
};
template <class T>
requires(std::is_integral_v<T>) struct AsUnsigned<T> {
  using Type = std::make_unsigned_t<T>;
};
template <class T>
using Unsigned = typename AsUnsigned<T>::Type;

/// f(T, T, ...) -> T; whole numbers wrap round.
template <auto f, int arguments>
Run wrapping(std::string_view type) {
  return by_type(type, []<class T>() -> Run {
    using U = Unsigned<T>;
    if constexpr (arguments == 1) return apply<f, U, U>;
    if constexpr (arguments == 2) return apply<f, U, U, U>;
    if constexpr (arguments == 3) return apply<f, U, U, U, U>;
  });
}
template <auto f, int arguments>
Run plain(std::string_view type) {
  return by_type(type, []<class T>() -> Run {
    if constexpr (arguments == 1) return apply<f, T, T>;
    if constexpr (arguments == 2) return apply<f, T, T, T>;
    if constexpr (arguments == 3) return apply<f, T, T, T, T>;
  });
}
template <class T>
constexpr bool real = std::is_floating_point_v<T>;

constexpr auto absolute = [](auto a) {
  if constexpr (real<decltype(a)>)
    return std::fabs(a);
  else if constexpr (std::is_signed_v<decltype(a)>)
    return a < 0 ? 0 - a : a;
  else
    return a;
};
constexpr auto smaller = [](auto a, auto b) {
  if constexpr (real<decltype(a)>)
    return std::isnan(a) ? b : std::isnan(b) ? a : a < b || (a == b && std::signbit(a)) ? a : b;
  else
    return a < b ? a : b;
};
constexpr auto larger = [](auto a, auto b) {
  if constexpr (real<decltype(a)>)
    return std::isnan(a) ? b : std::isnan(b) ? a : a > b || (a == b && !std::signbit(a)) ? a : b;
  else
    return a > b ? a : b;
};
template <class T>
constexpr bool overflows(T a, T b) {  // the least number by -1
  return std::is_signed_v<T> && b == static_cast<T>(-1) && a == std::numeric_limits<T>::min();
}
constexpr auto quotient = [](auto a, auto b) {
  using T = decltype(a);
  if constexpr (real<T>)
    return a / b;
  else
    return b == 0 ? std::numeric_limits<T>::max() : overflows(a, b) ? a : static_cast<T>(a / b);
};
constexpr auto remainder_of = [](auto a, auto b) {
  using T = decltype(a);
  if constexpr (real<T>)
    return a;
  else
    return b == 0 ? a : overflows(a, b) ? T{} : static_cast<T>(a % b);
};
constexpr auto fused = [](auto a, auto b, auto c) {
  if constexpr (real<decltype(a)>)
    return std::fma(a, b, c);
  else
    return a * b + c;
};
constexpr auto to_left = [](auto a, uint32_t by) {
  using T = decltype(a);
  return by >= 8 * sizeof(T) ? T(0) : T(a << by);
};
constexpr auto to_right = [](auto a, uint32_t by) {
  using T = decltype(a);
  const uint32_t width = 8 * sizeof(T);
  return by >= width ? T(std::is_signed_v<T> && a < 0 ? -1 : 0) : T(a >> by);
};

/// ---- comparison: to[0] = a ? b, perhaps joined with a predicate
template <class T, auto f>
void compare(Warp& w, const Instruction& i, Lanes lanes) {
  i.count == 3 ? apply<[](T a, T b, bool c) { return f(a, b) && c; }, bool, T, T, bool>(w, i, lanes)
               : apply<f, bool, T, T>(w, i, lanes);
}
template <class T>
Run comparison(std::string_view how) {
  if (how == "eq") return compare<T, [](T a, T b) { return a == b; }>;
  if (how == "ne") return compare<T, [](T a, T b) { return (a < b) | (a > b); }>;  // false where one is no number
  if (how == "lt" || how == "lo") return compare<T, [](T a, T b) { return a < b; }>;
  if (how == "le" || how == "ls") return compare<T, [](T a, T b) { return a <= b; }>;
  if (how == "gt" || how == "hi") return compare<T, [](T a, T b) { return (a > b); }>;
  if (how == "ge" || how == "hs") return compare<T, [](T a, T b) { return a >= b; }>;
  if (how == "equ") return compare<T, [](T a, T b) { return !((a < b) | (a > b)); }>;
  if (how == "neu") return compare<T, [](T a, T b) { return a != b; }>;
  if (how == "ltu") return compare<T, [](T a, T b) { return !(a >= b); }>;
  if (how == "leu") return compare<T, [](T a, T b) { return !(a > b); }>;
  if (how == "gtu") return compare<T, [](T a, T b) { return !(a <= b); }>;
  if (how == "geu") return compare<T, [](T a, T b) { return !(a < b); }>;
  if (how == "num") return compare<T, [](T a, T b) { return a == a && b == b; }>;
  if (how == "nan") return compare<T, [](T a, T b) { return a != a || b != b; }>;
  return nullptr;
}

/// ---- conversion
enum class Round { nearest, zero, down, up };
struct Conversion {
  Round round = Round::zero;
  bool whole = false, saturate = false;  // to a whole number; into the other type's range, of floats [0, 1]
};
template <class To, class From>
To converted(From a, Conversion how) {
  if constexpr (real<From>) {
    if (!real<To> || how.whole)
      a = how.round == Round::nearest ? std::nearbyint(a)
          : how.round == Round::down  ? std::floor(a)
          : how.round == Round::up    ? std::ceil(a)
                                      : std::trunc(a);
    if constexpr (real<To>) {
      const To b = static_cast<To>(a);
      return !how.saturate ? b : (b > 0) ? std::min(b, To(1)) : To(0);
    } else {
      using Limits = std::numeric_limits<To>;
      if (std::isnan(a))
        return sizeof(To) == 8 || sizeof(From) == 8 ? static_cast<To>(1ull << (8 * sizeof(To) - 1)) : To(0);
      if (a <= static_cast<From>(Limits::min())) return Limits::min();
      if (a >= static_cast<From>(Limits::max())) return Limits::max();
      return static_cast<To>(a);
    }
  } else if constexpr (!real<To>) {
    using Limits = std::numeric_limits<To>;
    return static_cast<To>(how.saturate ? std::clamp<__int128>(a, Limits::min(), Limits::max()) : __int128{a});
  } else {
    return static_cast<To>(a);
  }
}
template <class To, class From>
void convert(Warp& w, const Instruction& i, Lanes lanes) {
  std::uint64_t* to = w.row(i.to[0]);
  const std::uint64_t* from = w.value(i.from[0]);
  const Conversion how{static_cast<Round>(i.offset & 3), (i.offset & 4) != 0, (i.offset & 8) != 0};
  for (; lanes; lanes &= lanes - 1) {
    const int lane = std::countr_zero(lanes);
    to[lane] = bits(converted<To>(as<From>(from[lane]), how));
  }
}
Run conversion(const std::vector<std::string>& parts, Instruction& i) {
  Conversion how;
  bool rounds = false;
  for (std::size_t k = 1; k + 2 < parts.size(); ++k) {
    const std::string& part = parts[k];
    if (part == "sat") how.saturate = true;
    if (part[0] != 'r') continue;
    how.round = part[1] == 'n'   ? Round::nearest
                : part[1] == 'z' ? Round::zero
                : part[1] == 'm' ? Round::down
                                 : Round::up;
    how.whole = part.size() == 3;
    rounds = true;
  }
  const std::string &to = parts[parts.size() - 2], &from = parts.back();
  // A float that is not made whole is rounded to the nearest here, as the processor does.
  if (rounds && !how.whole && to[0] == 'f' && how.round != Round::nearest) return nullptr;
  i.offset = static_cast<int>(how.round) | (how.whole ? 4 : 0) | (how.saturate ? 8 : 0);
  return by_any_type(
      from, [&]<class From>() -> Run { return by_any_type(to, []<class To>() -> Run { return convert<To, From>; }); });
}

/// ---- sums with carry: the carry is the last source and the second destination
template <bool add, bool takes>
Run with_carry(std::string_view type) {
  return by_type(type, []<class T>() -> Run {
    if constexpr (!std::is_integral_v<T>)
      return nullptr;
    else
      return [](Warp& w, const Instruction& i, Lanes lanes) {
        using U = Unsigned<T>;
        std::uint64_t *to = w.row(i.to[0]), *carry = w.row(i.to[1]);
        const std::uint64_t *a = w.value(i.from[0]), *b = w.value(i.from[1]);
        for (; lanes; lanes &= lanes - 1) {
          const int lane = std::countr_zero(lanes);
          const Wide x = as<U>(a[lane]), y = as<U>(b[lane]), c = takes ? carry[lane] : 0;
          const Wide result = add ? x + y + c : x - y - c;
          to[lane] = static_cast<U>(result);
          carry[lane] = (result >> (8 * sizeof(U))) & 1;
        }
      };
  });
}
template <bool high, bool takes>
Run multiplied_with_carry(std::string_view type) {
  return by_type(type, []<class T>() -> Run {
    if constexpr (!std::is_integral_v<T> || std::is_signed_v<T>)
      return nullptr;
    else
      return [](Warp& w, const Instruction& i, Lanes lanes) {
        std::uint64_t *to = w.row(i.to[0]), *carry = w.row(i.to[1]);
        const std::uint64_t *a = w.value(i.from[0]), *b = w.value(i.from[1]), *c = w.value(i.from[2]);
        for (; lanes; lanes &= lanes - 1) {
          const int lane = std::countr_zero(lanes);
          const Wide product = static_cast<Wide>(as<T>(a[lane])) * as<T>(b[lane]);
          const Wide result = static_cast<Wide>(static_cast<T>(high ? product >> (8 * sizeof(T)) : product)) +
                              as<T>(c[lane]) + (takes ? carry[lane] : 0);
          to[lane] = static_cast<T>(result);
          carry[lane] = (result >> (8 * sizeof(T))) & 1;
        }
      };
  });
}

/// ---- memory
/// Nearly all that is read and written is global memory where all is well.
std::byte* find(Warp& w, const Instruction& i, std::uint64_t address, int bytes, int lane, memory::Access access) {
  if (i.space <= Space::global && address % bytes == 0)
    if (std::byte* found = memory::written_at(address, bytes); found && !watches_races) return found;
  if (i.space == Space::shared && !watches_races && address % bytes == 0 && address + bytes <= w.block->shared.size())
    return w.block->shared.data() + address;
  return w.find(i.space, address, bytes, lane, access);
}
template <class T>
void load(Warp& w, const Instruction& i, Lanes lanes) {
  const std::uint64_t* address = w.value(i.from[0]);
  if (counts) count_access(w, i, lanes, static_cast<int>(i.count * sizeof(T)), memory::Access::read);
  for (; lanes; lanes &= lanes - 1) {
    const int lane = std::countr_zero(lanes);
    const std::byte* found =
        find(w, i, address[lane] + i.offset, static_cast<int>(i.count * sizeof(T)), lane, memory::Access::read);
    for (int k = 0; k < i.count; ++k) {
      T value;
      std::memcpy(&value, found + k * sizeof(T), sizeof(T));
      w.row(i.to[k])[lane] = bits(value);
    }
  }
}
/// Whether the same is there already: threads that all write one flag do not race.
template <class T>
bool there_already(Warp& w, const Instruction& i, std::uint64_t address, int lane) {
  const std::byte* found = memory::written_at(address, static_cast<int>(i.count * sizeof(T)));
  bool same = found != nullptr;
  for (int k = 0; same && k < i.count; ++k) {
    const T value = as<T>(w.value(i.from[1 + k])[lane]);
    same = std::memcmp(found + k * sizeof(T), &value, sizeof(T)) == 0;
  }
  return same;
}
template <class T>
void store(Warp& w, const Instruction& i, Lanes lanes) {
  const std::uint64_t* address = w.value(i.from[0]);
  if (counts) count_access(w, i, lanes, static_cast<int>(i.count * sizeof(T)), memory::Access::write);
  for (; lanes; lanes &= lanes - 1) {
    const int lane = std::countr_zero(lanes);
    const std::uint64_t to = address[lane] + i.offset;
    if (watches_races && i.space <= Space::global && there_already<T>(w, i, to, lane)) continue;
    std::byte* found = find(w, i, to, static_cast<int>(i.count * sizeof(T)), lane, memory::Access::write);
    for (int k = 0; k < i.count; ++k) {
      const T value = as<T>(w.value(i.from[1 + k])[lane]);
      std::memcpy(found + k * sizeof(T), &value, sizeof(T));
    }
  }
}
template <class T, auto f>
void atomic(Warp& w, const Instruction& i, Lanes lanes) {
  const std::uint64_t *address = w.value(i.from[0]), *b = w.value(i.from[1]);
  for (; lanes; lanes &= lanes - 1) {
    const int lane = std::countr_zero(lanes);
    // It reads first: what was never written is told there.
    w.find(i.space, address[lane] + i.offset, sizeof(T), lane, memory::Access::read, true);
    std::byte* found = w.find(i.space, address[lane] + i.offset, sizeof(T), lane, memory::Access::write, true);
    T old;
    std::memcpy(&old, found, sizeof(T));
    const T now = static_cast<T>(f(old, as<T>(b[lane])));
    std::memcpy(found, &now, sizeof(T));
    w.row(i.to[0])[lane] = bits(old);
  }
}
template <auto f>
Run atomically(std::string_view type) {
  return by_type(type, []<class T>() -> Run {
    if constexpr (std::is_integral_v<T>) return atomic<T, f>;
    return nullptr;
  });
}

/// ---- lanes among each other; `lanes` has all that take part
enum class Shuffle { up, down, bfly, idx };
template <Shuffle how>
void shuffle(Warp& w, const Instruction& i, Lanes lanes) {
  std::uint64_t before[warp_size];
  std::copy_n(w.value(i.from[0]), warp_size, before);
  std::uint64_t by_lane[warp_size], clamp_lane[warp_size];
  std::copy_n(w.value(i.from[1]), warp_size, by_lane);
  std::copy_n(w.value(i.from[2]), warp_size, clamp_lane);
  std::uint64_t* to = w.row(i.to[0]);
  std::uint64_t* in_range = i.to[1] ? w.row(i.to[1]) : nullptr;
  for (Lanes rest = lanes; rest; rest &= rest - 1) {
    const int lane = std::countr_zero(rest);
    const int by = static_cast<int>(by_lane[lane] & 31), clamp = static_cast<int>(clamp_lane[lane] & 31),
              mask = static_cast<int>(clamp_lane[lane] >> 8 & 31);
    const int highest = (lane & mask) | (clamp & ~mask), lowest = lane & mask;
    int from = 0;
    bool inside = false;
    if (how == Shuffle::up) from = lane - by, inside = from >= highest;  // PTX: maxLane is the lowest here
    if (how == Shuffle::down) from = lane + by, inside = from <= highest;
    if (how == Shuffle::bfly) from = lane ^ by, inside = from <= highest;
    if (how == Shuffle::idx) from = lowest | (by & ~mask), inside = from <= highest;
    if (!inside) from = lane;
    if (!(lanes >> from & 1)) throw Hazard("a shuffle reads a lane that takes no part in it" + w.where());
    to[lane] = static_cast<std::uint32_t>(before[from]);
    if (in_range) in_range[lane] = inside;
  }
}
enum class Vote { ballot, any, all };
template <Vote how>
void vote(Warp& w, const Instruction& i, Lanes lanes) {
  const std::uint64_t* says = w.value(i.from[0]);
  Lanes yes = 0;
  for (Lanes rest = lanes; rest; rest &= rest - 1) {
    const int lane = std::countr_zero(rest);
    yes |= static_cast<Lanes>((says[lane] ^ (i.unless ? 1 : 0)) & 1) << lane;
  }
  const std::uint64_t result = how == Vote::ballot ? yes : how == Vote::any ? yes != 0 : yes == lanes;
  for (Lanes rest = lanes; rest; rest &= rest - 1) w.row(i.to[0])[std::countr_zero(rest)] = result;
}
void nothing(Warp&, const Instruction&, Lanes) {}

/// ---- pairs of halves
void pack(Warp& w, const Instruction& i, Lanes lanes) {
  const int width = static_cast<int>(i.offset) / i.count;
  std::uint64_t joined[warp_size] = {};
  for (int k = 0; k < i.count; ++k)
    for (int lane = 0; lane < warp_size; ++lane)
      joined[lane] |= (w.value(i.from[k])[lane] & ((1ull << width) - 1)) << (k * width);
  for (; lanes; lanes &= lanes - 1) {
    const int lane = std::countr_zero(lanes);
    w.row(i.to[0])[lane] = joined[lane];
  }
}
void unpack(Warp& w, const Instruction& i, Lanes lanes) {
  const int width = static_cast<int>(i.offset) / i.count;
  std::uint64_t joined[warp_size];
  std::copy_n(w.value(i.from[0]), warp_size, joined);
  for (; lanes; lanes &= lanes - 1) {
    const int lane = std::countr_zero(lanes);
    for (int k = 0; k < i.count; ++k) w.row(i.to[k])[lane] = joined[lane] >> (k * width) & ((1ull << width) - 1);
  }
}

bool has(const std::vector<std::string>& parts, std::string_view part) {
  return std::find(parts.begin() + 1, parts.end(), part) != parts.end();
}
void take_space(const std::vector<std::string>& parts, Instruction& i) {
  if (has(parts, "global")) i.space = Space::global;
  if (has(parts, "shared")) i.space = Space::shared;
  if (has(parts, "local")) i.space = Space::local;
  if (has(parts, "param")) i.space = Space::param;
  i.ordered = has(parts, "volatile") || has(parts, "relaxed") || has(parts, "acquire") || has(parts, "release");
}

Run multiplication(const std::vector<std::string>& parts) {
  const std::string& type = parts.back();
  const bool add = parts[0] == "mad";
  if (has(parts, "wide")) {
    if (type == "u16")
      return add ? apply<[](uint32_t a, uint32_t b, uint32_t c) { return a * b + c; }, uint32_t, uint16_t, uint16_t,
                         uint32_t>
                 : apply<[](uint32_t a, uint32_t b) { return a * b; }, uint32_t, uint16_t, uint16_t>;
    if (type == "s16")
      return add ? nullptr : apply<[](int32_t a, int32_t b) { return a * b; }, int32_t, int16_t, int16_t>;
    if (type == "u32")
      return add ? apply<[](uint64_t a, uint64_t b, uint64_t c) { return a * b + c; }, uint64_t, uint32_t, uint32_t,
                         uint64_t>
                 : apply<[](uint64_t a, uint64_t b) { return a * b; }, uint64_t, uint32_t, uint32_t>;
    if (type == "s32")
      return add ? apply<[](int64_t a, int64_t b, uint64_t c) { return static_cast<uint64_t>(a * b) + c; }, uint64_t,
                         int32_t, int32_t, uint64_t>
                 : apply<[](int64_t a, int64_t b) { return a * b; }, int64_t, int32_t, int32_t>;
    return nullptr;
  }
  if (has(parts, "hi")) {
    if (add) return nullptr;
    if (type == "u32")
      return apply<[](uint64_t a, uint64_t b) { return ((a * b) >> 32); }, uint32_t, uint32_t, uint32_t>;
    if (type == "s32") return apply<[](int64_t a, int64_t b) { return ((a * b) >> 32); }, int32_t, int32_t, int32_t>;
    if (type == "u64")
      return apply<[](uint64_t a, uint64_t b) { return static_cast<uint64_t>(static_cast<Wide>(a) * b >> 64); },
                   uint64_t, uint64_t, uint64_t>;
    if (type == "s64")
      return apply<[](int64_t a, int64_t b) { return static_cast<int64_t>(static_cast<__int128>(a) * b >> 64); },
                   int64_t, int64_t, int64_t>;
    return nullptr;
  }
  if (add) return wrapping<fused, 3>(type);
  return wrapping<[](auto a, auto b) { return a * b; }, 2>(type);
}

Run arithmetic(const std::vector<std::string>& parts, Instruction& i) {
  const std::string &name = parts[0], &type = parts.back();
  if (name == "add")
    return has(parts, "cc") ? with_carry<true, false>(type) : wrapping<[](auto a, auto b) { return a + b; }, 2>(type);
  if (name == "addc") return with_carry<true, true>(type);
  if (name == "sub")
    return has(parts, "cc") ? with_carry<false, false>(type) : wrapping<[](auto a, auto b) { return a - b; }, 2>(type);
  if (name == "subc") return with_carry<false, true>(type);
  if (name == "mad" && has(parts, "cc"))
    return has(parts, "hi") ? multiplied_with_carry<true, false>(type) : multiplied_with_carry<false, false>(type);
  if (name == "madc")
    return has(parts, "hi") ? multiplied_with_carry<true, true>(type) : multiplied_with_carry<false, true>(type);
  if (name == "mul" || name == "mad") return multiplication(parts);
  if (name == "fma") return plain<fused, 3>(type);
  if (name == "div") return plain<quotient, 2>(type);
  if (name == "rem") return plain<remainder_of, 2>(type);
  if (name == "min") return plain<smaller, 2>(type);
  if (name == "max") return plain<larger, 2>(type);
  if (name == "abs") return plain<absolute, 1>(type);
  if (name == "neg") return wrapping<[](auto a) { return -a; }, 1>(type);
  if (name == "sqrt" && type == "f64") return apply<[](double a) { return std::sqrt(a); }, double, double>;
  if (name == "sqrt" && type == "f32") return apply<[](float a) { return std::sqrt(a); }, float, float>;
  if (name == "rcp" && has(parts, "approx") && type == "f64")  // gives the upper half of the bits
    return apply<[](double a) { return std::bit_cast<double>(std::bit_cast<uint64_t>(1 / a) & ~0xffffffffull); },
                 double, double>;
  if (name == "rcp" && type == "f64") return apply<[](double a) { return 1 / a; }, double, double>;
  if (name == "rcp" && type == "f32") return apply<[](float a) { return 1 / a; }, float, float>;
  if (name == "shl")
    return by_type(type, []<class T>() -> Run {
      if constexpr (std::is_unsigned_v<T>)
        return apply<to_left, T, T, uint32_t>;
      else
        return nullptr;
    });
  if (name == "shr")
    return by_type(type, []<class T>() -> Run {
      if constexpr (std::is_integral_v<T>)
        return apply<to_right, T, T, uint32_t>;
      else
        return nullptr;
    });
  if (name == "and" || name == "or" || name == "xor" || name == "not") {
    const bool truth = type == "pred";
    using U = uint64_t;  // what lies above the type's width does not matter
    if (name == "not")
      return truth ? apply<[](bool a) { return !a; }, bool, bool> : apply<[](U a) { return ~a; }, U, U>;
    if (name == "and") return apply<[](U a, U b) { return a & b; }, U, U, U>;
    if (name == "or") return apply<[](U a, U b) { return a | b; }, U, U, U>;
    return apply<[](U a, U b) { return a ^ b; }, U, U, U>;
  }
  if (name == "popc")
    return type == "b64" ? apply<[](uint64_t a) { return std::popcount(a); }, uint32_t, uint64_t>
                         : apply<[](uint32_t a) { return std::popcount(a); }, uint32_t, uint32_t>;
  if (name == "clz")
    return type == "b64" ? apply<[](uint64_t a) { return std::countl_zero(a); }, uint32_t, uint64_t>
                         : apply<[](uint32_t a) { return std::countl_zero(a); }, uint32_t, uint32_t>;
  if (name == "brev" && type == "b32")
    return apply<[](uint32_t a) {
      uint32_t turned = 0;
      for (int k = 0; k < 32; ++k) turned |= (a >> k & 1) << (31 - k);
      return turned;
    },
                 uint32_t, uint32_t>;
  if (name == "bmsk" && has(parts, "clamp"))
    return apply<[](uint32_t a, uint32_t b) {
      if (a >= 32) return 0u;
      const uint64_t ones = b >= 32 ? 0xffffffffull : (1ull << b) - 1;
      return static_cast<uint32_t>(ones << a);
    },
                 uint32_t, uint32_t, uint32_t>;
  if (name == "selp")
    return apply<[](uint64_t a, uint64_t b, bool c) { return c ? a : b; }, uint64_t, uint64_t, uint64_t, bool>;
  if (name == "mov")
    return type == "pred" ? apply<[](bool a) { return a; }, bool, bool>
                          : apply<[](uint64_t a) { return a; }, uint64_t, uint64_t>;
  if (name == "cvt") return conversion(parts, i);
  if (name == "setp") return by_type(type, [&]<class T>() -> Run { return comparison<T>(parts[1]); });
  return nullptr;
}

Run address_conversion(const std::vector<std::string>& parts) {
  const bool back = has(parts, "to");
  if (has(parts, "global")) return apply<[](uint64_t a) { return a; }, uint64_t, uint64_t>;
  if (back) return apply<[](uint64_t a) { return a & ~(3ull << 60); }, uint64_t, uint64_t>;
  if (has(parts, "shared")) return apply<[](uint64_t a) { return a | shared_window; }, uint64_t, uint64_t>;
  if (has(parts, "local")) return apply<[](uint64_t a) { return a | local_window; }, uint64_t, uint64_t>;
  if (has(parts, "param")) return apply<[](uint64_t a) { return a | param_window; }, uint64_t, uint64_t>;
  return nullptr;
}

}  // namespace

bool choose_operation(const std::vector<std::string>& parts, Instruction& i) {
  const std::string& name = parts[0];
  // Arithmetic is exact or rounded to the nearest, numbers are as they come; what asks for more is not known.
  const bool coarse = name == "rcp" && has(parts, "approx");
  for (const char* more : {"rz", "rm", "rp", "NaN", "sat", "ftz", "approx", "full"})
    if (name != "cvt" && !coarse && has(parts, more)) return false;
  if (name == "ld" || name == "st") {
    take_space(parts, i);
    const bool reads = name == "ld";
    i.run = by_any_type(parts.back(), [reads]<class T>() -> Run { return reads ? Run(load<T>) : Run(store<T>); });
  } else if (name == "atom") {
    take_space(parts, i);
    if (has(parts, "add")) i.run = atomically<[](auto a, auto b) { return a + b; }>(parts.back());
    if (has(parts, "max")) i.run = atomically<[](auto a, auto b) { return (a > b ? a : b); }>(parts.back());
    if (has(parts, "min")) i.run = atomically<[](auto a, auto b) { return a < b ? a : b; }>(parts.back());
  } else if (name == "shfl") {
    i.kind = Kind::together;
    const std::string& how = parts[2];
    i.run = how == "up"     ? shuffle<Shuffle::up>
            : how == "down" ? shuffle<Shuffle::down>
            : how == "bfly" ? shuffle<Shuffle::bfly>
            : how == "idx"  ? shuffle<Shuffle::idx>
                            : nullptr;
  } else if (name == "vote") {
    i.kind = Kind::together;
    i.run = has(parts, "ballot") ? vote<Vote::ballot>
            : has(parts, "any")  ? vote<Vote::any>
            : has(parts, "all")  ? vote<Vote::all>
                                 : nullptr;
  } else if (name == "bar") {
    if (has(parts, "warp"))
      i.kind = Kind::together, i.run = nothing;
    else if (has(parts, "sync") || (has(parts, "red") && has(parts, "or")))
      i.kind = Kind::barrier, i.run = nothing;
  } else if (name == "membar" || name == "fence" || name == "nanosleep") {
    i.run = nothing;
  } else if (name == "cvta") {
    i.run = address_conversion(parts);
  } else if (name == "pack") {
    i.run = pack;
  } else if (name == "unpack") {
    i.run = unpack;
  } else {
    i.run = arithmetic(parts, i);
    i.in_double = name != "mov" && name != "selp" && has(parts, "f64");
  }
  return i.run != nullptr;
}

}  // namespace ptx
