// Starts the tests of the DEM, on the backend that TRACKBED_TEST_BACKEND names (tests/dem_backend.hpp).
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "base/error.hpp"
#include "tests/dem_backend.hpp"

namespace {

/// Tests that a GPU, or its way of taking contacts, has no part in, and why.
struct ProcessorOnly {
  std::string_view test, reason;
};
constexpr std::array processor_only{
    ProcessorOnly{"DemThreads.OneByOneDoesNotDependOnThreadsAtAll", "compares numbers of threads"},
    ProcessorOnly{"DemThreads.ThreadsAndLanesAgree", "compares numbers of threads and lanes; Gpu.* compares backends"},
    ProcessorOnly{"DemThreads.BondsDoNotDependOnThreads", "compares numbers of threads"},
    ProcessorOnly{"DemThreads.EveryLawAgreesBetweenLanes", "compares lanes; Gpu.* compares backends"},
    ProcessorOnly{"DemThreads.EveryRollingModelAgreesBetweenLanes", "compares lanes; Gpu.* compares backends"},
    ProcessorOnly{"DemState.GoesOnWithOtherVectors", "goes from one vector width to another"},
    ProcessorOnly{"DemLists.WithoutFrictionAndWallsNothingIsKeptForThem", "counts the bytes of the processor's lists"}};

class SkipProcessorOnly final : public testing::EmptyTestEventListener {
  void OnTestStart(const testing::TestInfo& test) override {
    const std::string name = std::string(test.test_suite_name()) + "." + test.name();
    for (const ProcessorOnly& row : processor_only)
      if (row.test == name) GTEST_SKIP() << "for the processor's own way: " << row.reason;
  }
};

/// 0, or the exit status of a program that cannot test what it was asked to.
int look_for_device() {
  std::string why_not;
  try {
    if (dem_test::backend() == dem::Backend::omp || dem::cuda_available(&why_not)) return 0;
    std::fprintf(stderr, "TRACKBED_TEST_BACKEND=cuda: no test can run on a GPU here: %s\n", why_not.c_str());
  } catch (const base::UserError& error) {
    std::fprintf(stderr, "%s\n", error.what());
  }
  return 2;
}

}  // namespace

namespace {

const std::string& wanted() {
  static const std::string name = [] {
    const char* set = std::getenv("TRACKBED_TEST_BACKEND");
    return std::string(set && *set ? set : "omp");
  }();
  base::require_user(name == "omp" || name == "one_by_one" || name == "cuda",
                     "TRACKBED_TEST_BACKEND=" + name + ": must be omp, one_by_one or cuda; not set, it is omp");
  return name;
}

}  // namespace

dem::Backend dem_test::backend() { return wanted() == "cuda" ? dem::Backend::cuda : dem::Backend::omp; }
bool dem_test::one_by_one() { return wanted() == "one_by_one"; }

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  if (!testing::GTEST_FLAG(list_tests)) {
    if (const int status = look_for_device()) return status;
    if (dem_test::backend() == dem::Backend::cuda || dem_test::one_by_one()) {
      std::printf("TRACKBED_TEST_BACKEND: simulations run %s\n",
                  dem_test::one_by_one() ? "on the processor, contacts one by one as on a GPU" : "on the GPU");
      testing::UnitTest::GetInstance()->listeners().Append(new SkipProcessorOnly);
    }
  }
  return RUN_ALL_TESTS();
}
