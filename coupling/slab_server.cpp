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

SlabBench::SlabBench(MPI_Comm dem_ranks, MakeGrains make, MPI_Comm joint) : joint_(joint), make_(std::move(make)) {
  MPI_Comm_dup(dem_ranks, &between_parts_);
  mail_ = std::make_unique<SlabMail>(between_parts_);
}

SlabBench::~SlabBench() {
  parts_.clear();
  mail_.reset();
  MPI_Comm_free(&between_parts_);
}

Bytes SlabBench::perform(const Bytes& order) {
  ByteReader reader(order);
  ByteWriter result;
  const FailureText failure = caught([&] { perform(reader, result); });
  if (failure.kind != Failure::none) mail_->give_up();  // others may be waiting for this part
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
    Part made{std::make_unique<SlabCompany>(*mail_, setup.periods[0].length > 0), nullptr, nullptr};
    setup.company = made.company.get();
    made.grains = make_(setup, backend);
    parts_[simulation] = std::move(made);
  } else if (call == destroy_slab) {
    parts_.erase(simulation);
  } else if (call == use_threads) {
    dem::set_threads(order.get<int>());
  } else if (call == clear_mail) {
    mail_->clear();
  } else if (call == several) {
    FailureText failure;
    for (const Bytes& one : order.get<std::vector<Bytes>>()) {
      ByteReader next(one);
      if (failure.kind == Failure::none)
        failure = caught([&] { perform(next, answer); });
      else
        refuse(next);
    }
    raise(failure);
  } else {
    perform_exchange(call, parts_.at(simulation), order, answer);
  }
  base::require_internal(order.empty(), "an order to a DEM rank is longer than its call");
}

/// An order that nothing can come of any more: bodies that wait for their impulses are told so.
void SlabBench::refuse(ByteReader& order) {
  const int call = order.get<int>(), simulation = order.get<int>();
  if (call != exchange_window) return;
  Part& part = parts_.at(simulation);
  static_cast<void>(caught([&] { part.end->window(*part.grains, {.refused = true}); }));
}

/// The part's end of the exchange with the bodies.
void SlabBench::perform_exchange(int call, Part& part, ByteReader& order, ByteWriter& answer) {
  if (call == join_bodies) {
    auto is = order.get<Interface>();
    part.end = std::make_unique<GrainEnd>(std::move(is), joint_, mail_->ranks(), order.get<std::vector<int>>());
  } else if (call == exchange_window) {
    answer.put(part.end->window(*part.grains, order.get<WindowOrder>()));
  } else if (call == exchange_traffic) {
    answer.put(part.end->traffic());
  } else if (call == save_end) {
    answer.put(part.end->save());
  } else if (call == restore_end) {
    part.end->restore(order.get<std::vector<double>>());
  }
}

void serve_slabs(MPI_Comm dem_ranks, const MakeGrains& make, MPI_Comm joint) {
  // A signal that goes to all ranks is for the leading ones to act on.
  const InterruptWatch ends;
  const CheckpointWatch checkpoints;
  SlabPost post(dem_ranks);
  SlabBench bench(dem_ranks, make, joint);
  for (;;) {
    Bytes order = post.next_order();
    const int what = ByteReader(order).get<int>();
    if (what == leave) return;
    if (what == one_for_each) order = post.own_order();
    post.answer(bench.perform(order));
  }
}

SlabCrew::SlabCrew(MPI_Comm dem_ranks, const MakeGrains& make, MPI_Comm joint)
    : post_(dem_ranks), bench_(dem_ranks, make, joint) {}

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
  const auto failed = [](const FailureText& failure) { return failure.kind != Failure::none; };
  if (std::ranges::any_of(failures, failed)) stop(failures);
  return readers;
}

/// Throws for all, once nothing that failed parts have left behind is on its way.
void SlabCrew::stop(const std::vector<FailureText>& failures) {
  const Bytes order = ByteWriter(clear_mail, 0).take();
  post_.give(order);
  post_.collect(bench_.perform(order));
  auto worst = std::ranges::find_if(failures, tells_cause);
  if (worst == failures.end())
    worst = std::ranges::find_if(failures, [](const auto& failure) { return failure.kind != Failure::none; });
  raise(*worst);
  throw base::InternalError("a failure of a DEM rank without a kind");
}

}  // namespace coupling
