#pragma once
// The families of the solid side: elements and material laws.
//
// To add an element: write elements/<name>.hpp after the pattern of elements/tet4.hpp (sizes, measure, node_volumes,
// weight, Field, Forces), and add its type to Elements below and to the tables of tests/unit/fem_elements.cpp. To add a
// law: write laws/<name>.hpp after the pattern of laws/linear_elastic.hpp (traits, serves, check, constructor, stress,
// stored), and add its type to Laws below and to tests/unit/fem_laws.cpp. Every element works with every law; nothing
// else changes. Rows of Laws may share a name: the one that serves the region's parameters is taken.
#include <string>
#include <tuple>

#include "fem/elements/hex20.hpp"
#include "fem/elements/hex8.hpp"
#include "fem/elements/hex8_incompatible.hpp"
#include "fem/elements/hex8_one_point.hpp"
#include "fem/elements/tet10.hpp"
#include "fem/elements/tet4.hpp"
#include "fem/fem.hpp"
#include "fem/laws/drucker_prager.hpp"
#include "fem/laws/kelvin_voigt.hpp"
#include "fem/laws/left_cauchy_green.hpp"
#include "fem/laws/linear_elastic.hpp"

namespace fem {

using Elements = std::tuple<Hex8<false>, Hex8<true>, Hex8Incompatible, Hex8OnePoint, Hex20, Hex20Reduced, Tet4, Tet10>;
using Laws = std::tuple<LinearElastic, KelvinVoigt, LeftCauchyGreen, DruckerPrager<false>, DruckerPrager<true>>;

/// Number of nodes of the named element.
int element_nodes(const std::string& element);

/// Smallest volume [m3] that a point of the named element at these places stands for; <= 0: inside out there.
double smallest_point_volume(const std::string& element, const double (*places)[3]);

/// Whether the law of the material remembers (plastic strain).
bool keeps_history(const MaterialRegion&);

/// Throws base::UserError, opened by `head`, when the law is unknown or its parameters are out of range.
void check_material(const MaterialRegion&, const std::string& head);

}  // namespace fem
