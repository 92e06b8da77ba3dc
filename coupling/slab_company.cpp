#include "coupling/slab_company.hpp"

#include <cmath>
#include <cstdint>

namespace coupling {

namespace {

/// Messages that go up and those that go down are told apart even where both neighbours are one.
constexpr SlabMail::Kind to(int side) { return side == dem::Company::below ? SlabMail::to_below : SlabMail::to_above; }
constexpr SlabMail::Kind from(int side) { return to(1 - side); }

}  // namespace

/// By dissemination (Hensgen, Finkel & Manber 1988): each tells the one 1, 2, 4 ... places above all that it knows.
void SlabCompany::largest(std::span<double> values) {
  theirs_.resize(values.size());
  for (int places = 1; places < parts(); places *= 2) {
    mail_.send(values.data(), values.size_bytes(), mail_.beside(places), SlabMail::passed_round);
    mail_.receive(theirs_.data(), values.size_bytes(), mail_.beside(-places), SlabMail::passed_round);
    mail_.await();
    for (std::size_t k = 0; k < values.size(); ++k)  // what is no number goes round too
      if (theirs_[k] > values[k] || std::isnan(theirs_[k])) values[k] = theirs_[k];
  }
}

/// In one place, in the order of the parts, and then handed out.
void SlabCompany::sum(std::span<double> values) {
  if (part() > 0) {
    mail_.send(values.data(), values.size_bytes(), 0, SlabMail::gathered);
    mail_.receive(values.data(), values.size_bytes(), 0, SlabMail::handed_out);
    return mail_.await();
  }
  theirs_.resize(values.size());
  for (int other = 1; other < parts(); ++other) {
    mail_.receive(theirs_.data(), values.size_bytes(), other, SlabMail::gathered);
    mail_.await();
    for (std::size_t k = 0; k < values.size(); ++k) values[k] += theirs_[k];
  }
  for (int other = 1; other < parts(); ++other)
    mail_.send(values.data(), values.size_bytes(), other, SlabMail::handed_out);
  mail_.await();
}

void SlabCompany::swap(const std::array<Letter, 2>& out, std::array<Letter, 2>& in) {
  std::array<std::uint64_t, 2> leaving{out[below].size(), out[above].size()}, coming{};
  for (const Side side : {below, above})
    if (has(side)) mail_.send(&leaving[side], sizeof leaving[side], neighbour(side), to(side));
  for (const Side side : {below, above})
    if (has(side)) mail_.receive(&coming[side], sizeof coming[side], neighbour(side), from(side));
  mail_.await();
  for (const Side side : {below, above}) in[side].resize(coming[side]);
  swap_known(out, in);
}

void SlabCompany::swap_known(const std::array<Letter, 2>& out, std::array<Letter, 2>& in) {
  for (const Side side : {below, above})
    if (has(side)) mail_.send(out[side].data(), out[side].size(), neighbour(side), to(side));
  for (const Side side : {below, above})
    if (has(side)) mail_.receive(in[side].data(), in[side].size(), neighbour(side), from(side));
  mail_.await();
}

}  // namespace coupling
