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

/// dem::Simulation::nodal_impulse, of a mesh of so many nodes.
inline std::vector<dem::Vec3> nodal_impulses(dem::Simulation& part, int wall, int nodes) {
  std::vector<dem::Vec3> impulses(static_cast<std::size_t>(nodes));
  part.nodal_impulse(wall, impulses);
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
              &Sim::set_wall_load, &Sim::set_mesh_target, &Sim::know_mesh_nodes, &Sim::keep_within, &Sim::reach,
              &nodal_impulses, &Sim::node_springs, &Sim::wall_impulse_on_grains, &Sim::advance, &Sim::stable_step,
              &Sim::contact_stable_step, &Sim::time, &Sim::save, &Sim::restore, &Sim::restore_parts, &Sim::energy,
              &Sim::reset_energy, &Sim::grain_contacts, &Sim::wall_contacts, &Sim::counts>;

/// The number of a call in an order; what concerns no simulation's own calls comes after them.
template <auto call>
constexpr int order_of() {
  static_assert(SlabCalls::number<call>() < SlabCalls::size, "the call has no row in SlabCalls");
  return SlabCalls::number<call>();
}
enum SlabOrder : int {
  create_slab = SlabCalls::size,
  destroy_slab,
  use_threads,
  join_bodies,
  exchange_window,
  exchange_traffic,
  save_end,
  restore_end,
  clear_mail,
  several,
  one_for_each,
  leave
};

}  // namespace coupling
