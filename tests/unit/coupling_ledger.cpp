// The energy balance: closes for consistent sides, shows what is missing, and counts only from its zero.
#include <gtest/gtest.h>

#include "coupling/ledger.hpp"

namespace {

using coupling::Ledger;
using coupling::Sides;

// 10 J of load, 3 J handed to the grains, of which 2 J are lost in friction: bodies keep 7 J, grains 1 J.
Sides consistent() {
  Sides sides;
  sides.bodies.work_loads = 10;
  sides.bodies.work_interface = -3;
  sides.bodies.strain = 7;
  sides.grains.work_interface = 3;
  sides.grains.loss_friction = 2;
  sides.grains.elastic_normal = 1;
  return sides;
}

TEST(Ledger, ClosesWhenNothingIsLost) {
  Ledger ledger;
  ledger.start({});
  ledger.add(consistent());
  EXPECT_DOUBLE_EQ(ledger.residual(), 0);
  EXPECT_DOUBLE_EQ(ledger.interface_mismatch(), 0);
  EXPECT_DOUBLE_EQ(ledger.external_work(), 10);
}

TEST(Ledger, ShowsAMissingLossAndKeepsTheWorst) {
  Ledger ledger;
  ledger.start({});
  Sides sides = consistent();
  sides.grains.loss_friction = 1.5;  // half a joule unaccounted for
  ledger.add(sides);
  EXPECT_DOUBLE_EQ(ledger.residual(), -0.5);
  ledger.add(consistent());
  EXPECT_DOUBLE_EQ(ledger.residual(), 0);
  EXPECT_DOUBLE_EQ(ledger.relative_error(), 0.05);
}

TEST(Ledger, InterfaceMismatchIsAnError) {
  Ledger ledger;
  ledger.start({});
  Sides sides = consistent();
  sides.grains.work_interface = 3.2;  // the grains claim more than the bodies gave …
  sides.grains.elastic_normal = 1.2;  // … and have it
  ledger.add(sides);
  EXPECT_NEAR(ledger.interface_mismatch(), 0.2, 1e-15);
  EXPECT_NEAR(ledger.residual(), 0.2, 1e-15);
}

TEST(Ledger, WhatWasStoredBeforeTheZeroDoesNotCount) {
  Sides before;
  before.grains.elastic_normal = 50;
  Ledger ledger;
  ledger.start(before);
  Sides after = consistent();
  after.grains.elastic_normal += 50;
  ledger.add(after);
  EXPECT_DOUBLE_EQ(ledger.residual(), 0);
}

// A body let go: 8 J swing, the load's last 1e-12 J are no scale for what is missing.
TEST(Ledger, FreeVibrationsAreMeasuredByTheirEnergy) {
  Sides sides;
  sides.bodies.strain = 8;
  Ledger ledger;
  ledger.start(sides);
  sides.bodies.kinetic = 2;
  sides.bodies.strain = 6.08;
  sides.bodies.work_loads = 1e-12;
  ledger.add(sides);
  EXPECT_NEAR(ledger.relative_error(), 0.01, 1e-12);
}

}  // namespace
