#pragma once
// Finds the kernel of an element and a law by their places in the tables.
#include <cstddef>
#include <utility>

#include "fem/families.hpp"
#include "fem/kernels.hpp"

namespace fem {

template <int W>
ForceKernel kernel_of(int element, int law) {
  ForceKernel found = nullptr;
  [&]<std::size_t... e>(std::index_sequence<e...>) {
    const auto search_laws = [&]<std::size_t el, std::size_t... l>(std::index_sequence<el>, std::index_sequence<l...>) {
      ((el == static_cast<std::size_t>(element) && l == static_cast<std::size_t>(law)
            ? void(found = &Kernel<std::tuple_element_t<el, Elements>, std::tuple_element_t<l, Laws>, W>::run)
            : void()),
       ...);
    };
    (search_laws(std::index_sequence<e>{}, std::make_index_sequence<std::tuple_size_v<Laws>>{}), ...);
  }
  (std::make_index_sequence<std::tuple_size_v<Elements>>{});
  return found;
}

}  // namespace fem
