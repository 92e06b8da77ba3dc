// What `trackbed render` reads and decides before anything is drawn: no test here needs a display.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "coupling/render.hpp"
#include "coupling/render_curves.hpp"
#include "coupling/render_page.hpp"
#include "coupling/run_directory.hpp"
#include "coupling/virtual_display.hpp"

namespace {

namespace fs = std::filesystem;

/// A run directory of the test's own, removed at the end.
struct CouplingRender : testing::Test {
  fs::path folder = fs::temp_directory_path() / ("trackbed_render_" + std::to_string(getpid()));
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }
  void put(const std::string& name, const std::string& text) const { std::ofstream(folder / name) << text; }
  void put_collection(const std::string& name, std::initializer_list<double> times) const {
    std::string text = "<VTKFile type=\"Collection\" version=\"0.1\"><Collection>";
    for (double time : times) {
      const std::string file = name + std::to_string(time) + ".vtp";
      put(file, "");
      text += "<DataSet timestep=\"" + std::to_string(time) + "\" part=\"0\" file=\"" + file + "\"/>";
    }
    put(name + ".pvd", text + "</Collection></VTKFile>");
  }
};

std::string user_error(const std::function<void()>& act) {
  try {
    act();
  } catch (const base::UserError& error) {
    return error.what();
  }
  return "";
}

TEST_F(CouplingRender, HistoryKeepsNamesUnitsAndNumbers) {
  put("history.csv", "time [s],seat_load [N],porosity [-]\n0,1.5,0.4\n0.001,-2e3,nan\n");
  const auto table = coupling::read_history(folder / "history.csv");
  ASSERT_EQ(table.columns.size(), 3U);
  EXPECT_EQ(table.columns[1].name, "seat_load");
  EXPECT_EQ(table.columns[1].unit, "N");
  EXPECT_EQ(table.time().back(), 0.001);
  EXPECT_EQ(table.columns[1].values.back(), -2000);
}

TEST_F(CouplingRender, BrokenHistoryNamesLineAndColumn) {
  const auto message = [&] { return user_error([&] { coupling::read_history(folder / "history.csv"); }); };
  put("history.csv", "time [s],seat_load [N]\n0,1\n1\n");
  EXPECT_NE(message().find("history.csv:3: 1 cells; the header has 2"), std::string::npos) << message();
  put("history.csv", "time [s],seat_load [N]\n0,one\n");
  EXPECT_NE(message().find("history.csv:2: seat_load = 'one'; must be a number"), std::string::npos) << message();
}

// kill -9 can cut a row in two anywhere: between cells, or within a number, which then reads as another one.
TEST_F(CouplingRender, LastRowOfAKilledRunIsLeftOut) {
  for (const std::string torn : {"0.001", "0.001,-2", "0.001,-2000"}) {
    put("history.csv", "time [s],seat_load [N]\n0,1.5\n" + torn);
    const auto table = coupling::read_history(folder / "history.csv");
    EXPECT_EQ(table.time(), std::vector{0.0}) << torn;
    EXPECT_EQ(table.columns[1].values, std::vector{1.5}) << torn;
  }
}

TEST_F(CouplingRender, CollectionGivesTimesAndFiles) {
  put_collection("grains", {0.0, 0.25});
  const auto levels = coupling::read_pvd(folder / "grains.pvd");
  ASSERT_EQ(levels.size(), 2U);
  EXPECT_EQ(levels[1].time, 0.25);
  EXPECT_EQ(levels[1].file, folder / "grains0.250000.vtp");
  EXPECT_EQ(coupling::nearest_level(levels, 0.2).time, 0.25);
  put("broken.pvd", "no xml");
  EXPECT_NE(user_error([&] { coupling::read_pvd(folder / "broken.pvd"); }).find("broken.pvd"), std::string::npos);
}

// The load peaks at 0.2 s between two levels: the level with the larger load (0.3 s: 70 N, not 0.1 s: 50 N) is
// pictured. A code that takes the level nearest to the peak, or the last one, fails.
TEST_F(CouplingRender, PeakIsTheLevelWithTheLargestLoad) {
  put_collection("grains", {0.1, 0.32, 0.5});
  put("history.csv",
      "time [s],seat_settlement [m],seat_load [N]\n0,0,0\n0.1,0.5,-50\n0.2,1,-100\n0.3,2,-80\n0.4,2,-30\n0.5,9,-1\n");
  const auto moment = coupling::peak_moment(coupling::open_run_directory(folder));
  EXPECT_EQ(moment.time, 0.32);
  EXPECT_EQ(moment.text, "seat load = -70 N");
}

TEST_F(CouplingRender, WithoutLoadTheSettlementDecidesAndElseTheLastLevel) {
  put_collection("ground", {0.1, 0.2, 0.3});
  put("history.csv", "time [s],seat_settlement [m]\n0.1,0\n0.2,2e-3\n0.3,1e-3\n");
  EXPECT_EQ(coupling::peak_moment(coupling::open_run_directory(folder)).text, "seat settlement = 2 mm");
  put("history.csv", "time [s],porosity [-]\n0.1,0.4\n0.2,0.5\n0.3,0.4\n");
  EXPECT_EQ(coupling::peak_moment(coupling::open_run_directory(folder)).time, 0.3);
}

// A load that stays: the latest level shows most.
TEST_F(CouplingRender, StepLoadIsPicturedAtTheEnd) {
  put_collection("beam", {0.1, 0.2, 0.3});
  put("history.csv", "time [s],tip_load [N]\n0.1,200\n0.2,200\n0.3,200\n");
  EXPECT_EQ(coupling::peak_moment(coupling::open_run_directory(folder)).time, 0.3);
}

TEST_F(CouplingRender, FolderWithoutRunSaysSo) {
  EXPECT_NE(user_error([&] { coupling::render(folder); }).find("holds no run"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "pictures"));
  EXPECT_NE(user_error([&] { coupling::render(folder / "missing"); }).find("no such folder"), std::string::npos);
}

TEST_F(CouplingRender, SummaryBecomesTheTableOfResults) {
  put("summary.json", R"({"title": "A <bay>", "status": "completed", "results": {
      "k_sub": {"value": 88.31, "unit": "kN/mm", "expected_range": [50, 150], "source": "eq. 1"},
      "tip_peak": {"value": 150.5, "unit": "um", "expected": 150, "relative_error": 0.0033},
      "lost": {"value": null, "unit": "m"}}})");
  const auto run = coupling::open_run_directory(folder);
  ASSERT_EQ(run.results.size(), 3U);
  const std::string page = coupling::results_page(run, {"pictures/view.png"});
  for (const char* part :
       {"A &lt;bay&gt;", "k sub", "88.31", "kN/mm", "50 – 150", "eq. 1", "+0.33 %", "src=\"view.png\""})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  put("summary.json", "{\"title\":");
  EXPECT_NE(user_error([&] { coupling::open_run_directory(folder); }).find("no JSON object"), std::string::npos);
}

// One chart per unit, in the order of interest; what is zero throughout has no line.
TEST_F(CouplingRender, ChartsGoByUnit) {
  put("history.csv",
      "time [s],stage [-],a [m/s2],load [N],w [m],none [m],energy_strain [J],energy_tiny [J],energy_residual [J]\n"
      "0,0,1,2000,1e-4,0,5,0.001,0.1\n1,1,1,1000,-3e-3,0,5,0,0.1\n");
  const auto history = coupling::read_history(folder / "history.csv");
  const auto charts = coupling::charts_of(history);
  ASSERT_EQ(charts.size(), 5U);
  EXPECT_EQ(charts[0].unit.name, "kN");
  EXPECT_EQ(charts[1].unit.name, "mm");
  ASSERT_EQ(charts[2].columns.size(), 1U);
  EXPECT_EQ(charts[2].columns[0]->name, "energy_strain");
  EXPECT_EQ(charts[3].columns[0]->name, "energy_residual");
  EXPECT_EQ(charts[4].unit.name, "m/s²");
}

TEST(RenderTicks, AreRoundAndInside) {
  EXPECT_EQ(coupling::round_ticks(0, 39.6, 8), (std::vector<double>{0, 5, 10, 15, 20, 25, 30, 35}));
  EXPECT_EQ(coupling::round_ticks(-7, 7, 4), (std::vector<double>{-5, 0, 5}));
  EXPECT_TRUE(coupling::round_ticks(1, 1, 5).empty());
}

// No Xvfb on the path and no DISPLAY: the message says what to install.
TEST(VirtualDisplay, SaysWhatToInstall) {
  const auto value = [](const char* name) {
    return std::string(std::getenv(name) != nullptr ? std::getenv(name) : "");
  };
  const std::string path = value("PATH"), display = value("DISPLAY");
  setenv("PATH", "/nowhere", 1);
  unsetenv("DISPLAY");
  const std::string message = user_error([] { const coupling::VirtualDisplay none; });
  setenv("PATH", path.c_str(), 1);
  if (!display.empty()) setenv("DISPLAY", display.c_str(), 1);
  EXPECT_NE(message.find("apt-get install xvfb"), std::string::npos) << message;
}

}  // namespace
