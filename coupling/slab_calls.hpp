#pragma once
// The calls of a dem::Simulation that go to all parts: one row each. Arguments and results follow from the signature,
// so that who asks (slab_simulation.hpp) and who does it (slab_server.hpp) cannot disagree.
#include <functional>
#include <span>
#include <tuple>

#include "coupling/bytes.hpp"
#include "coupling/slab_members.hpp"
#include "dem/dem.hpp"

namespace coupling {

/// What the grains have passed to a mesh in one advance(): to the nodes that got something, and on the grains' side.
struct MeshImpulse {
  std::vector<int> node;
  std::vector<dem::Vec3> impulse;  // [N s]
  dem::Vec3 on_grains;             // [N s]
};
template <>
struct Members<MeshImpulse> {
  static auto tie(auto& value) {
    auto& [node, impulse, on_grains] = value;
    return std::tie(node, impulse, on_grains);
  }
};

/// dem::Simulation::advance, and what it has done to these meshes of so many nodes: one answer in each window.
inline std::vector<MeshImpulse> advance_over(dem::Simulation& part, int n, double dt, std::span<const int> meshes,
                                             std::span<const int> nodes) {
  part.advance(n, dt);
  std::vector<MeshImpulse> impulses(meshes.size());
  std::vector<dem::Vec3> whole;
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    whole.assign(static_cast<std::size_t>(nodes[k]), {});
    part.nodal_impulse(meshes[k], whole);
    for (int node = 0; node < nodes[k]; ++node) {
      const dem::Vec3& impulse = whole[static_cast<std::size_t>(node)];
      if (base::norm2(impulse) == 0) continue;
      impulses[k].node.push_back(node);
      impulses[k].impulse.push_back(impulse);
    }
    impulses[k].on_grains = part.wall_impulse_on_grains(meshes[k]);
  }
  return impulses;
}

/// What an argument is when it has travelled.
template <class T>
struct Arrived {
  using type = std::remove_cvref_t<T>;
};
template <class T>
struct Arrived<std::span<const T>> {
  using type = std::vector<T>;
};

template <class R, class... A>
struct CallTypes {
  using Result = R;
  using Arguments = std::tuple<typename Arrived<A>::type...>;
};
template <class R, class... A>
CallTypes<R, A...> call_types(R (dem::Simulation::*)(A...));
template <class R, class... A>
CallTypes<R, A...> call_types(R (dem::Simulation::*)(A...) const);
template <class R, class... A>
CallTypes<R, A...> call_types(R (*)(dem::Simulation&, A...));

template <auto call>
using ResultOf = typename decltype(call_types(call))::Result;

/// Takes the arguments from the order, makes the call, puts its result into the answer.
template <auto call>
void perform(dem::Simulation& part, ByteReader& order, ByteWriter& answer) {
  typename decltype(call_types(call))::Arguments arguments;
  order.get(arguments);
  std::apply(
      [&](const auto&... argument) {
        if constexpr (std::is_void_v<ResultOf<call>>)
          std::invoke(call, part, argument...);
        else
          answer.put(std::invoke(call, part, argument...));
      },
      arguments);
}

template <auto... calls>
struct CallTable {
  static constexpr int size = sizeof...(calls);
  using Performer = void (*)(dem::Simulation&, ByteReader&, ByteWriter&);
  static constexpr std::array<Performer, size> performers{&perform<calls>...};

  template <auto call>
  struct Is {};
  /// The row of this call.
  template <auto call>
  static constexpr int number() {
    constexpr std::array<bool, size> same{std::is_same_v<Is<call>, Is<calls>>...};
    for (int k = 0; k < size; ++k)
      if (same[static_cast<std::size_t>(k)]) return k;
    return size;
  }
};

using Sim = dem::Simulation;
using SlabCalls =
    CallTable<&Sim::add_shape, &Sim::add_grains, &Sim::remove_grains, &Sim::grains, &Sim::spheres, &Sim::set_grains,
              &Sim::scale_grains, &Sim::set_material, &Sim::set_interaction, &Sim::set_gravity, &Sim::set_grain_damping,
              &Sim::add_plane, &Sim::add_mesh, &Sim::remove_wall, &Sim::set_wall_velocity, &Sim::set_wall_body,
              &Sim::set_wall_load, &Sim::set_mesh_target, &Sim::node_springs, &Sim::wall_impulse_on_grains,
              &advance_over, &Sim::stable_step, &Sim::contact_stable_step, &Sim::time, &Sim::save, &Sim::restore,
              &Sim::restore_parts, &Sim::energy, &Sim::reset_energy, &Sim::grain_contacts, &Sim::wall_contacts,
              &Sim::counts>;

/// The number of a call in an order; what concerns no simulation's own calls comes after them.
template <auto call>
constexpr int order_of() {
  static_assert(SlabCalls::number<call>() < SlabCalls::size, "the call has no row in SlabCalls");
  return SlabCalls::number<call>();
}
enum SlabOrder : int { create_slab = SlabCalls::size, destroy_slab, use_threads, several, one_for_each, leave };

}  // namespace coupling
