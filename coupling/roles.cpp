#include "coupling/roles.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <vector>

#include "base/error.hpp"

namespace coupling {

namespace {

std::vector<int> gathered(int mine, int ranks, MPI_Comm all) {
  std::vector<int> values(static_cast<std::size_t>(ranks));
  MPI_Allgather(&mine, 1, MPI_INT, values.data(), 1, MPI_INT, all);
  return values;
}

std::string ranks_text(long ranks) { return fmt::format("{} rank{}", ranks, ranks == 1 ? "" : "s"); }

/// How many ranks --role asks to have grains; none: it is given to no rank.
std::optional<int> dem_by_role(const std::vector<int>& is_dem, const std::vector<int>& has_role, const Scene& scene) {
  const auto ranks = static_cast<long>(has_role.size());
  const auto with_role = std::ranges::count(has_role, 1), dem = std::ranges::count(is_dem, 1);
  if (with_role == 0) return std::nullopt;
  base::require_user(with_role == ranks,
                     fmt::format("--role: given to {} of {}; give every part of the mpirun line --role dem or "
                                 "--role fem, or none",
                                 ranks_text(with_role), ranks));
  base::require_user(scene.has_grains() || dem == 0,
                     fmt::format("--role dem: {} has no grains; start all ranks without --role", scene.file.string()));
  base::require_user(
      scene.has_bodies() || dem == ranks,
      fmt::format("--role fem: {} has no deformable body; start all ranks without --role", scene.file.string()));
  const bool both = scene.has_grains() && scene.has_bodies();
  base::require_user(
      !both || (dem > 0 && dem < ranks),
      fmt::format("--role: all of {} have the role {}; {} needs ranks of both roles, or none with a role",
                  ranks_text(ranks), dem > 0 ? "dem" : "fem", scene.file.string()));
  return static_cast<int>(dem);
}

/// How many ranks --dem-ranks asks to have grains; none: it is given to no rank.
std::optional<int> dem_by_number(const std::vector<int>& wished) {
  const auto [least, most] = std::ranges::minmax(wished);
  if (most == 0) return std::nullopt;
  base::require_user(least == most,
                     fmt::format("--dem-ranks: {} on some ranks, {} on others; give every part of the mpirun line the "
                                 "same, or none",
                                 most, least > 0 ? std::to_string(least) : "none"));
  return most;
}

/// Ranks with grains. Throws when the scene has no use for them.
int dem_ranks_of(const Scene& scene, int ranks, std::optional<int> number, std::optional<int> roles) {
  base::require_user(!number || !roles || *number == *roles,
                     fmt::format("--dem-ranks {}: but --role dem is given to {}; leave one of the two out",
                                 number.value_or(0), ranks_text(roles.value_or(0))));
  if (!scene.has_grains()) {
    base::require_user(!number, fmt::format("--dem-ranks {}: {} has no grains; leave it out", number.value_or(0),
                                            scene.file.string()));
    return 0;
  }
  const int asked = roles ? *roles : number.value_or(scene.has_bodies() ? 1 : ranks);
  if (!scene.has_bodies()) {
    base::require_user(asked == ranks, fmt::format("--dem-ranks {}: {} has no deformable body, so all of {} hold "
                                                   "grains; leave it out, or start mpirun with -n {}",
                                                   asked, scene.file.string(), ranks_text(ranks), asked));
  } else if (ranks > 1 || asked > 1) {
    base::require_user(asked < ranks,
                       fmt::format("--dem-ranks {}: {} in all, and the bodies of {} need one at least; start mpirun "
                                   "with -n {} or more, or take fewer DEM ranks",
                                   asked, ranks_text(ranks), scene.file.string(), asked + 1));
  }
  base::require_user(asked == 1 || !scene.grains->bonding.any(),
                     fmt::format("{}: has bonds, which need one DEM rank, and {} would hold grains; start with {}",
                                 scene.file.string(), ranks_text(asked),
                                 scene.has_bodies() ? "--dem-ranks 1" : "one rank, without mpirun"));
  return asked;
}

}  // namespace

Roles::Roles(MPI_Comm all, const Scene& scene, const RankWishes& wishes) {
  int number = 0;
  MPI_Comm_rank(all, &number);
  MPI_Comm_size(all, &all_ranks);
  const auto asks_dem = gathered(wishes.role == "dem", all_ranks, all);
  const auto by_role = dem_by_role(asks_dem, gathered(!wishes.role.empty(), all_ranks, all), scene);
  const auto by_number = dem_by_number(gathered(wishes.dem_ranks.value_or(0), all_ranks, all));
  dem_ranks = dem_ranks_of(scene, all_ranks, by_number, by_role);
  if (by_role) {  // DEM ranks first, each kind in its order
    const auto mine = asks_dem.begin() + number;
    const auto dem_before = std::count(asks_dem.begin(), mine, 1);
    number = static_cast<int>(*mine == 1 ? dem_before : dem_ranks + (mine - asks_dem.begin()) - dem_before);
  }
  const bool lone = all_ranks == 1, has_grains = number < dem_ranks;
  coupled = scene.has_grains() && scene.has_bodies();
  fem_ranks = !scene.has_bodies() ? 0 : lone ? 1 : all_ranks - dem_ranks;
  is_dem = has_grains && number == 0;
  is_worker = has_grains && number > 0;
  is_fem = scene.has_bodies() && (lone || !has_grains);
  first_fem_rank = coupled && !lone ? 1 : 0;
  const auto split = [&](bool joins, MPI_Comm& part) { MPI_Comm_split(all, joins ? 0 : MPI_UNDEFINED, number, &part); };
  split(!is_worker, world);
  split(has_grains, dem);
  split(is_fem, fem);
  split(coupled, joint);
  if (!is_worker) {
    MPI_Comm_rank(world, &rank);
    MPI_Comm_size(world, &size);
  }
  MPI_Comm here = MPI_COMM_NULL;
  MPI_Comm_split_type(all, MPI_COMM_TYPE_SHARED, number, MPI_INFO_NULL, &here);
  const int mine[2] = {has_grains, !has_grains};
  int both[2] = {0, 0};
  MPI_Allreduce(mine, both, 2, MPI_INT, MPI_SUM, here);
  int up_to_me = 0;
  MPI_Scan(mine, &up_to_me, 1, MPI_INT, MPI_SUM, here);
  dem_number_here = up_to_me - mine[0];
  MPI_Comm_free(&here);
  dem_here = both[0];
  fem_here = both[1];
}

Roles::~Roles() {
  for (MPI_Comm* part : {&joint, &fem, &dem, &world})
    if (*part != MPI_COMM_NULL) MPI_Comm_free(part);
}

}  // namespace coupling
