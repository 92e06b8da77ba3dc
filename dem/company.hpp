#pragma once
// A simulation may hold a part of the grains only, a slab across x, while the other parts run elsewhere: in other
// processes, on other machines. What it needs of them goes through this interface, so that the library knows no MPI.
//
// Method: domain decomposition in slabs (Plimpton 1995, doi:10.1006/jcph.1995.1039). Each part moves the grains whose
// centres lie in its slab. Spheres of its neighbours that its own might touch are ghosts: rows that take place and
// motion of their originals once a step. A contact between two parts is worked out by both, from the same numbers, and
// each adds the force to its own grain: no forces travel, and a contact keeps its history on either side.
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace dem {

/// The parts of one simulation as one of them sees them, from 0 at small x upwards. Every call but part() and parts()
/// is collective: all parts make the same calls in the same order. Where another part has given up, a call throws
/// base::UnstableError: what is lost cannot be worked out by one part alone.
class Company {
 public:
  enum Side { below, above };
  using Letter = std::vector<std::byte>;

  virtual ~Company() = default;
  virtual int part() const = 0;
  virtual int parts() const = 0;
  /// Space repeats itself along x: the last part is the first one's neighbour below.
  virtual bool ring() const = 0;
  /// Largest over all parts, number by number; the same on all.
  virtual void largest(std::span<double>) = 0;
  /// Sum over all parts, number by number; the same bits on all.
  virtual void sum(std::span<double>) = 0;
  /// Takes what the neighbours of this part hand to it: in[below] is what the one below had in its out[above]. Where
  /// there is no neighbour, out[] must be empty and in[] comes back empty. in[] takes the size of what comes.
  virtual void swap(const std::array<Letter, 2>& out, std::array<Letter, 2>& in) = 0;
  /// The same where every part knows how long the letters are: in[] has that size already.
  virtual void swap_known(const std::array<Letter, 2>& out, std::array<Letter, 2>& in) = 0;

  bool has(Side side) const { return parts() > 1 && (ring() || (side == below ? part() > 0 : part() + 1 < parts())); }
};

}  // namespace dem
