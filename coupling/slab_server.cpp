#include "coupling/slab_server.hpp"

#include <algorithm>
#include <utility>

#include "base/error.hpp"
#include "coupling/agree.hpp"
#include "coupling/interrupt.hpp"
#include "coupling/slab_simulation.hpp"

namespace coupling {

namespace {

/// Parts that stop because another one did know no cause.
bool tells_cause(const FailureText& failure) {
  return failure.kind != Failure::none && !failure.text.starts_with("stopped with");
}

}  // namespace

SlabBench::SlabBench(MPI_Comm dem_ranks, MakeGrains make) : make_(std::move(make)) {
  MPI_Comm_dup(dem_ranks, &between_parts_);
}

SlabBench::~SlabBench() {
  parts_.clear();
  MPI_Comm_free(&between_parts_);
}

Bytes SlabBench::perform(const Bytes& order) {
  ByteReader reader(order);
  ByteWriter result;
  const FailureText failure = caught([&] { perform(reader, result); });
  ByteWriter answer(failure.kind, failure.text);
  if (failure.kind == Failure::none) answer.append(result.bytes());
  return answer.take();
}

void SlabBench::perform(ByteReader& order, ByteWriter& answer) {
  const int call = order.get<int>(), simulation = order.get<int>();
  if (call < SlabCalls::size) {
    SlabCalls::performers[static_cast<std::size_t>(call)](part(simulation), order, answer);
  } else if (call == create_slab) {
    auto setup = order.get<dem::Setup>();
    const auto backend = order.get<dem::Backend>();
    Part made{std::make_unique<SlabCompany>(between_parts_, setup.periods[0].length > 0), nullptr};
    setup.company = made.company.get();
    made.grains = make_(setup, backend);
    parts_[simulation] = std::move(made);
  } else if (call == destroy_slab) {
    parts_.erase(simulation);
  } else if (call == use_threads) {
    dem::set_threads(order.get<int>());
  } else if (call == several) {
    for (const Bytes& one : order.get<std::vector<Bytes>>()) {
      ByteReader next(one);
      perform(next, answer);
    }
  }
  base::require_internal(order.empty(), "an order to a DEM rank is longer than its call");
}

void serve_slabs(MPI_Comm dem_ranks, const MakeGrains& make) {
  // A signal that goes to all ranks is for the leading ones to act on.
  const InterruptWatch ends;
  const CheckpointWatch checkpoints;
  SlabPost post(dem_ranks);
  SlabBench bench(dem_ranks, make);
  for (;;) {
    Bytes order = post.next_order();
    const int what = ByteReader(order).get<int>();
    if (what == leave) return;
    if (what == one_for_each) order = post.own_order();
    post.answer(bench.perform(order));
  }
}

SlabCrew::SlabCrew(MPI_Comm dem_ranks, const MakeGrains& make) : post_(dem_ranks), bench_(dem_ranks, make) {}

SlabCrew::~SlabCrew() { post_.give(ByteWriter(leave, 0).bytes()); }

std::unique_ptr<dem::Simulation> SlabCrew::make(const dem::Setup& setup, dem::Backend backend) {
  const int number = made_++;
  auto simulation = std::make_unique<SlabSimulation>(*this, number);  // what some ranks have made goes with it
  order(ByteWriter(create_slab, number, setup, backend).bytes());
  return simulation;
}

void SlabCrew::set_threads(int threads) { order(ByteWriter(use_threads, 0, threads).bytes()); }

std::vector<ByteReader> SlabCrew::order(const Bytes& what) {
  if (later_.empty()) {
    post_.give(what);
    return collect(what);
  }
  later_.push_back(what);
  const Bytes all = ByteWriter(several, 0, std::exchange(later_, {})).take();
  post_.give(all);
  return collect(all);
}

void SlabCrew::order_later(Bytes what) { later_.push_back(std::move(what)); }

std::vector<ByteReader> SlabCrew::order_each(const std::vector<Bytes>& orders) {
  if (has_later()) order(ByteWriter(several, 0, std::vector<Bytes>{}).bytes());
  post_.give(ByteWriter(one_for_each, 0).bytes());
  for (int rank = 1; rank < ranks(); ++rank) post_.give_to(rank, orders[static_cast<std::size_t>(rank)]);
  return collect(orders[0]);
}

std::vector<ByteReader> SlabCrew::collect(const Bytes& own_order) {
  answers_ = post_.collect(bench_.perform(own_order));
  std::vector<ByteReader> readers(answers_.begin(), answers_.end());
  std::vector<FailureText> failures;
  for (ByteReader& reader : readers) {
    FailureText& failure = failures.emplace_back();
    reader.get(failure.kind);
    reader.get(failure.text);
  }
  auto worst = std::ranges::find_if(failures, tells_cause);
  if (worst == failures.end())
    worst = std::ranges::find_if(failures, [](const auto& failure) { return failure.kind != Failure::none; });
  if (worst != failures.end()) raise(*worst);
  return readers;
}

}  // namespace coupling
