// Two windows are one graph where their notes are the same, to the byte. A difference that was overlooked would replay
// old forces; one that is none (what lies between the members of a struct) would make a new graph for every window.
#include <gtest/gtest.h>

#include <cstring>
#include <new>

#include "dem/core/launch_notes.hpp"

namespace {

struct Pass {
  char kind;
  double* rows;
  int count;
};
struct OtherPass : Pass {};

/// In memory that held something else before.
Pass pass(int dirt, char kind, double* rows, int count) {
  alignas(Pass) unsigned char memory[sizeof(Pass)];
  std::memset(memory, dirt, sizeof memory);
  Pass* made = new (memory) Pass;
  made->kind = kind;
  made->rows = rows;
  made->count = count;
  Pass copy;
  std::memcpy(&copy, memory, sizeof copy);
  return copy;
}

bool same(const Pass& one, const Pass& other, int rows, int other_rows) {
  dem::LaunchNotes notes;
  notes.begin();
  notes.add(&dem::mark_of<Pass>, rows, one);
  EXPECT_FALSE(notes.same_again());
  notes.begin();
  notes.add(&dem::mark_of<Pass>, other_rows, other);
  return notes.same_again();
}

TEST(LaunchNotes, OnlyWhatMattersMakesADifference) {
  double rows[2];
  const Pass is = pass(0x00, 1, rows, 7);
  EXPECT_TRUE(same(is, is, 3, 3));
  EXPECT_TRUE(same(is, pass(0xff, 1, rows, 7), 3, 3));
  EXPECT_FALSE(same(is, pass(0x00, 2, rows, 7), 3, 3));
  EXPECT_FALSE(same(is, pass(0x00, 1, rows + 1, 7), 3, 3));
  EXPECT_FALSE(same(is, pass(0x00, 1, rows, 8), 3, 3));
  EXPECT_FALSE(same(is, is, 3, 4));
}

// The kind of a pass counts, their order and their number; a window that queues nothing is nobody's double.
TEST(LaunchNotes, KindOrderAndNumberOfPasses) {
  dem::LaunchNotes notes;
  const auto window = [&](auto... marks) {
    notes.begin();
    (notes.add(marks), ...);
    return notes.same_again();
  };
  const char *one = &dem::mark_of<Pass>, *other = &dem::mark_of<OtherPass>;
  EXPECT_FALSE(window(one, other));
  EXPECT_TRUE(window(one, other));
  EXPECT_FALSE(window(other, one));
  EXPECT_FALSE(window(other));
  EXPECT_FALSE(window(one));
  EXPECT_TRUE(window(one));
  EXPECT_FALSE(window());
  EXPECT_FALSE(window());
}

}  // namespace
