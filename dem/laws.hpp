#pragma once
// The contact laws and rolling models that a scene can choose, one row each: what the program lists, checks and
// dispatches from.
//
// To add a contact law:
// 1. a header dem/kernels/<name>.hpp with a type that has `history` and `press` as kernels/touch.hpp says. Most laws
//    fill a NormalForce and leave the rest to sheared() (viscoelastic.hpp is the shortest example). Numbers of its own
//    that a contact keeps come before those of sheared(): hysteretic.hpp. New constants go into
//    kernels/pair_parameters.hpp, what the host computes of them into law_parameters.hpp;
// 2. a row in `laws` below;
// 3. its case in with_law_number() below: the number of the row;
// 4. a row in tests/dem_law_rows.hpp: every test that all laws must pass then runs on it.
// A rolling model likewise: kernels/rolling_models.hpp and a row in `rolling_models`.
#include <array>
#include <string_view>
#include <tuple>

#include "dem/kernels/hertz_mindlin.hpp"
#include "dem/kernels/hysteretic.hpp"
#include "dem/kernels/linear.hpp"
#include "dem/kernels/rolling_models.hpp"
#include "dem/kernels/stress_friction.hpp"
#include "dem/kernels/viscoelastic.hpp"
#include "dem/kernels/voigt_slider.hpp"

namespace dem {

/// What a scene must state for the law, of the materials and of the pair; the rest is empty.
using ParameterNames = std::array<std::string_view, 12>;

/// Law: the type in dem/kernels; its `history` is the number of values that a contact keeps.
template <class Law>
struct LawRow {
  using law = Law;
  static constexpr int history = Law::history;
  std::string_view name, text, source;
  ParameterNames parameters;
};

inline constexpr std::tuple laws{
    LawRow<kernels::HertzMindlin>{"hertz_mindlin",
                                  "Hertz with a dashpot for the restitution, Mindlin no-slip shear, Coulomb friction",
                                  "Irazabal2017 3.12-3.28",
                                  {"young_modulus", "poisson_ratio", "restitution", "friction"}},
    LawRow<kernels::StressFriction>{
        "stress_friction",
        "hertz_mindlin whose friction falls beyond a critical contact stress",
        "Irazabal2017 6.3-6.6",
        {"young_modulus", "poisson_ratio", "restitution", "friction", "critical_stress", "friction_exponent"}},
    LawRow<kernels::Hysteretic>{"hysteretic",
                                "Hertz with damping in proportion to force and speed (modes 0, 1, 2), Coulomb friction",
                                "Talebiahooie2021 eqs. 8-16",
                                {"young_modulus", "poisson_ratio", "restitution", "damping_mode", "friction"}},
    LawRow<kernels::Viscoelastic>{"viscoelastic",
                                  "Hertz of viscoelastic spheres (restitution falls with speed), Coulomb friction",
                                  "Schwager2002 eq. 5, Li2021 eq. 1",
                                  {"young_modulus", "poisson_ratio", "dissipative_coefficient", "friction"}},
    LawRow<kernels::Linear>{"linear",
                            "linear springs with a dashpot for the restitution (1: none), Coulomb friction",
                            "Talebiahooie2021 eqs. 1-7",
                            {"normal_stiffness", "shear_stiffness", "restitution", "friction"}},
    LawRow<kernels::VoigtSlider>{
        "voigt_slider",
        "linear springs beside dashpots, with a frictional slider",
        "Nishiura2017 section 4",
        {"normal_stiffness", "shear_stiffness", "normal_viscosity", "shear_viscosity", "friction"}}};

inline constexpr std::tuple rolling_models{
    LawRow<kernels::NoRolling>{"none", "no rolling resistance", "", {}},
    LawRow<kernels::RollingA>{"type_a",
                              "constant moment against the turning of the pair",
                              "Irazabal2017 5.1, Ai et al. 2011",
                              {"rolling_friction"}},
    LawRow<kernels::RollingC>{"type_c",
                              "elastic-plastic spring and dashpot in the rolling angle",
                              "Ai et al. 2011",
                              {"rolling_friction", "rolling_damping"}},
    LawRow<kernels::BoundedRolling>{"brof",
                                    "braking of each grain, bounded by what stops it within a step",
                                    "Irazabal2017 5.4-5.6",
                                    {"rolling_friction"}}};

/// hertz_mindlin where nothing rubs: its contacts keep nothing.
constexpr int smooth_law = -1;
/// Order of rolling_models.
enum Rolling : int { no_rolling, rolling_a, rolling_c, rolling_brof };

/// Numbers that a contact keeps: the law's, with the ledger one more, then the rolling model's likewise.
struct HistoryLayout {
  int law = 0, total = 0;  // where the rolling model's begin; all
  unsigned flips = 0;      // see PairParameters
};
constexpr HistoryLayout history_layout(int law_history, bool ledger, int rolling) {
  HistoryLayout n;
  n.law = law_history + (ledger ? 1 : 0);
  n.total = n.law + (rolling == rolling_c ? kernels::RollingC::history + (ledger ? 1 : 0) : 0);
  if (law_history >= 4) n.flips |= 7u << (law_history - 4);  // shear force
  if (rolling == rolling_c) n.flips |= 7u << n.law;          // rolling moment
  return n;
}

/// Calls visit(row) for every row of a table.
template <class Table, class Visit>
constexpr void for_each_law(const Table& table, Visit&& visit) {
  std::apply([&](const auto&... row) { (visit(row), ...); }, table);
}

/// Calls visit(row) for the row with this name; false when there is none.
template <class Table, class Visit>
constexpr bool with_law(const Table& table, std::string_view name, Visit&& visit) {
  return std::apply([&](const auto&... row) { return ((row.name == name && (visit(row), true)) || ...); }, table);
}

/// Row of this name, or -1.
template <class Table>
constexpr int row_number(const Table& table, std::string_view name) {
  int number = 0, found = -1;
  for_each_law(table, [&](const auto& row) {
    if (row.name == name) found = number;
    ++number;
  });
  return found;
}

/// Calls use(Law{}) with the law of this number.
template <class Use>
TRACKBED_HD decltype(auto) with_law_number(int number, Use&& use) {
  switch (number) {
    case smooth_law:
      return use(kernels::HertzSmooth{});
    case 1:
      return use(kernels::StressFriction{});
    case 2:
      return use(kernels::Hysteretic{});
    case 3:
      return use(kernels::Viscoelastic{});
    case 4:
      return use(kernels::Linear{});
    case 5:
      return use(kernels::VoigtSlider{});
    default:
      return use(kernels::HertzMindlin{});
  }
}

/// Numbers that the law of this number keeps. (Functors, not lambdas: nvcc must compile them for the device.)
struct HistoryOf {
  template <class Law>
  TRACKBED_HD int operator()(Law) const {
    return Law::history;
  }
};
TRACKBED_HD inline int law_history(int number) { return with_law_number(number, HistoryOf{}); }

/// One function of device code: all laws inlined into every kernel take the compiler a quarter of an hour.
#if defined(__CUDACC__)
#define TRACKBED_ONE_FUNCTION __noinline__
#else
#define TRACKBED_ONE_FUNCTION
#endif
template <bool Ledger, class Real>
struct PressWith {
  const kernels::PairParameters& pair;
  const kernels::Touch<Real>& touch;
  const kernels::Interval& time;
  Real* numbers;
  template <class Law>
  TRACKBED_ONE_FUNCTION TRACKBED_HD kernels::Reaction<Real> operator()(Law) const {
    return Law::template press<Ledger>(pair, touch, time, numbers);
  }
};

/// The law is looked up for every contact: where laws are mixed, and where speed does not matter.
struct AnyLaw {
  static constexpr int history = 5;  // the most that one of them has

  template <bool Ledger, class Real>
  TRACKBED_HD static kernels::Reaction<Real> press(const kernels::PairParameters& pair,
                                                   const kernels::Touch<Real>& touch, const kernels::Interval& time,
                                                   Real* numbers) {
    return with_law_number(pair.law, PressWith<Ledger, Real>{pair, touch, time, numbers});
  }
};

/// The most that a law and a rolling model keep.
constexpr int maximum_numbers = AnyLaw::history + 1 + kernels::RollingC::history + 1;

/// k_t [N/m] of a contact after press(): the last of the law's numbers.
template <class Real>
TRACKBED_HD Real shear_stiffness_of(const kernels::PairParameters& pair, const Real* numbers) {
  const int history = law_history(pair.law);
  return history > 0 ? numbers[history - 1] : Real{};
}

}  // namespace dem
