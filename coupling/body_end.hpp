#pragma once
// A FEM rank's end of the exchange: it speaks with every DEM part, and moves to and from each the skin nodes that it
// owns and the part's grains may touch (skin_share.hpp). The messages of a window:
//   bodies to part: status; sum of the impulses applied in the window before; per skin how far its nodes have moved
//     along x; positions and velocities of the shared nodes at the window's end (SkinMotion), and behind them of those
//     that were not shared before at its start.
//   part to bodies: status; per skin the interval of the next window; impulses of the shared nodes.
#include <mpi.h>

#include "base/columns.hpp"
#include "coupling/skin_share.hpp"
#include "fem/fem.hpp"

namespace coupling {

constexpr int skin_tag = 11, impulse_tag = 12;
constexpr std::size_t skin_header(std::size_t skins) { return 4 + 2 * skins; }
constexpr std::size_t impulse_header(std::size_t skins) { return 1 + 2 * skins; }

class BodyEnd {
 public:
  /// `joint`: the DEM ranks, then the FEM ranks, of which this is number `rank`; or the one rank that is both.
  BodyEnd(const Interface&, MPI_Comm joint, int dem_ranks, int rank);

  /// Before predict(): a parabola leaves with the velocities that the nodes have then.
  void begin_window(const fem::Model&);
  /// As they are after predict() (ahead = 0), or extrapolated with the present velocity over `ahead` seconds.
  void send_skins(const fem::Model&, double ahead, bool failed);
  /// False when any part has failed; all have been heard then. Adds to `waited` [s].
  bool receive_impulses(double& waited);
  /// Nodal forces = the impulses last received / window [s].
  void apply(fem::Model&, double window);
  double finish_window();  // [s] waited

  base::Vec3& applied() { return applied_; }
  const base::Vec3& applied() const { return applied_; }
  /// `intervals`: of each part, per skin: of the window that was last and of the next one.
  void restore(std::span<const std::vector<std::array<Interval, 2>>> intervals);
  /// By skin and node, of all FEM ranks, on the first; and back.
  void save(base::Columns&, MPI_Comm fem) const;
  void load(const base::Columns&);

 private:
  struct Part {
    int rank = 0;
    std::vector<Interval> before{}, now{};  // per skin
    std::vector<SharedNodes> shared{};
    std::vector<double> out{}, in{};
    MPI_Request out_request = MPI_REQUEST_NULL, in_request = MPI_REQUEST_NULL;
  };
  void share(Part&);
  template <class Self, class Visit>
  static void each_field(Self&, const Visit&);

  const Interface& is_;
  MPI_Comm joint_;
  const std::vector<std::vector<int>>& owned_;
  std::vector<std::vector<Interval>> reaches_;
  std::vector<Part> parts_;
  using Field = std::vector<std::vector<base::Vec3>>;  // per skin, owned nodes
  Field leaving_;                                      // [m/s] velocities as the window began
  Field told_, told_velocity_;                         // [m] [m/s] where the last window was to end
  Field start_, start_velocity_;                       // the same of the window before it
  Field waiting_;                                      // [N s] impulses last received
  base::Vec3 applied_;                                 // [N s] sum of force x window in the window before
};

}  // namespace coupling
