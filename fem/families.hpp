#pragma once
// The families of the solid side: elements and material laws.
//
// To add an element: write elements/<name>.hpp after the pattern of elements/tet4.hpp (nodes, geometry_size, measure,
// node_volumes, forces, mean_stress), and add its type to Elements below and to the tables of
// tests/unit/fem_elements.cpp. To add a law: write laws/<name>.hpp after the pattern of laws/linear_elastic.hpp (name,
// check, constructor, stress), and add its type to Laws below and to the same test. Every element works with every law;
// nothing else changes.
#include <string>
#include <tuple>

#include "fem/elements/hex8.hpp"
#include "fem/elements/tet4.hpp"
#include "fem/fem.hpp"
#include "fem/laws/linear_elastic.hpp"

namespace fem {

using Elements = std::tuple<Hex8<false>, Hex8<true>, Tet4>;
using Laws = std::tuple<LinearElastic>;

/// Number of nodes of the named element.
int element_nodes(const std::string& element);

/// Throws base::UserError, opened by `head`, when the law is unknown or its parameters are out of range.
void check_material(const MaterialRegion&, const std::string& head);

}  // namespace fem
