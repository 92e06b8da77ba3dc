#pragma once
// Several DEM ranks: the first one leads and takes part in the run, the others do what it says, each on its own part of
// the grains, from start to end. An order is the number of a call (slab_calls.hpp), that of a simulation and the
// arguments; the answer a failure, or what the call gave back.
#include <mpi.h>

#include <map>
#include <memory>
#include <vector>

#include "coupling/agree.hpp"
#include "coupling/make_grains.hpp"
#include "coupling/slab_calls.hpp"
#include "coupling/slab_company.hpp"
#include "coupling/slab_post.hpp"

namespace coupling {

/// The parts that this rank holds, by the numbers of their simulations.
class SlabBench {
 public:
  SlabBench(MPI_Comm dem_ranks, MakeGrains, MPI_Comm joint);
  ~SlabBench();
  SlabBench(const SlabBench&) = delete;
  SlabBench& operator=(const SlabBench&) = delete;

  /// Does what the order says; never throws.
  Bytes perform(const Bytes& order);
  dem::Simulation& part(int simulation) { return *parts_.at(simulation).grains; }

 private:
  struct Part {
    std::unique_ptr<SlabCompany> company;
    std::unique_ptr<dem::Simulation> grains;
    std::unique_ptr<GrainEnd> end;  // of the exchange with bodies
  };
  void perform(ByteReader& order, ByteWriter& answer);
  void refuse(ByteReader& order);
  void perform_exchange(int call, Part&, ByteReader& order, ByteWriter& answer);

  MPI_Comm between_parts_ = MPI_COMM_NULL, joint_ = MPI_COMM_NULL;
  std::unique_ptr<SlabMail> mail_;
  MakeGrains make_;
  std::map<int, Part> parts_;
};

/// The life of a DEM rank that does not lead. `joint`: all DEM ranks and then those of the bodies, if there are any.
/// Returns when the first one's SlabCrew is gone.
void serve_slabs(MPI_Comm dem_ranks, const MakeGrains& = dem::Simulation::create, MPI_Comm joint = MPI_COMM_NULL);

/// The DEM ranks as the first of them sees them. Must outlive the simulations that it makes.
class SlabCrew {
 public:
  explicit SlabCrew(MPI_Comm dem_ranks, const MakeGrains& = dem::Simulation::create, MPI_Comm joint = MPI_COMM_NULL);
  ~SlabCrew();
  SlabCrew(const SlabCrew&) = delete;
  SlabCrew& operator=(const SlabCrew&) = delete;

  /// A simulation whose grains are shared out over the ranks.
  std::unique_ptr<dem::Simulation> make(const dem::Setup&, dem::Backend);
  /// dem::set_threads() on every rank.
  void set_threads(int threads);
  int ranks() const { return post_.ranks(); }

  /// Has all parts do this; what they answer, by rank. When any of them fails, throws for all.
  std::vector<ByteReader> order(const Bytes&);
  /// The same, with the next order: for what gives no answer and does not fail.
  void order_later(Bytes);
  bool has_later() const { return !later_.empty(); }
  /// As order(), with an order of its own for every part.
  std::vector<ByteReader> order_each(const std::vector<Bytes>&);
  dem::Simulation& own_part(int simulation) { return bench_.part(simulation); }

 private:
  std::vector<ByteReader> collect(const Bytes& own_order);
  [[noreturn]] void stop(const std::vector<FailureText>&);

  SlabPost post_;
  SlabBench bench_;
  std::vector<Bytes> answers_;  // to the last order
  std::vector<Bytes> later_;    // to go with the next
  int made_ = 0;
};

}  // namespace coupling
