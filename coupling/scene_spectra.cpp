// Spectra of probes: the table [[spectrum]].
#include <fmt/format.h>

#include "coupling/scene_parts.hpp"
#include "coupling/scene_tables.hpp"

namespace coupling {

using base::fail;
using base::Value;

const base::Table& spectrum_table() {
  static const base::Table table{
      "spectrum",
      "a column of spectra.csv: Fourier amplitude of a probe over the time that is measured",
      {base::name("name", "of the column"), base::text("probe", "name of the probe"),
       base::text("over", "probe whose spectrum divides it: of a load, for a mobility").optional("none"),
       base::real("bandwidth", "Hz", "of Parzen's window, which smooths it; 0: as it is").at_least(0).otherwise(0.0)}};
  return table;
}

void build_spectra(Value& root, Scene& scene) {
  auto& rows = root.at("spectrum").list();
  require_unique(rows, "spectrum");
  std::vector<std::string> probes;
  for (const auto& probe : scene.probes) probes.push_back(probe.name);
  const auto unit_of = [&](const std::string& name) {
    for (const auto& probe : scene.probes)
      if (probe.name == name) return probe.unit;
    return std::string();
  };
  for (const auto& row : rows) {
    if (scene.is_modal()) fail(row, "fem.solver = \"modal\" goes through no time", "remove it");
    SpectrumScene spectrum;
    spectrum.name = row.at("name").text();
    spectrum.probe = row.at("probe").text();
    require_known(row.at("probe"), probes, "probe", "probes");
    const std::string unit = unit_of(spectrum.probe);
    spectrum.unit = unit.empty() ? "s" : unit + " s";
    if (const Value* over = row.find("over")) {
      require_known(*over, probes, "probe", "probes");
      spectrum.over = over->text();
      const std::string under = unit_of(spectrum.over);
      spectrum.unit = unit == under   ? "-"
                      : under.empty() ? unit
                                      : fmt::format("{}/({})", unit.empty() ? "1" : unit, under);
    }
    spectrum.bandwidth = row.at("bandwidth").real();
    scene.spectra.push_back(std::move(spectrum));
  }
}

}  // namespace coupling
