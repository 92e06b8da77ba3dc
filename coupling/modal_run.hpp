#pragma once
// A scene of free vibrations: no stages, no time; the modes of every body, their shapes for ParaView, its results.
#include <filesystem>

#include "coupling/setup.hpp"
#include "coupling/summary.hpp"

namespace coupling {

/// Finds and writes the modes; probes become one sample of the series. Collective; throws the same error on every rank.
void run_modal(Setup&, const std::filesystem::path& directory, Summary&, Series&);

/// One line per mode: number, frequency, share of the body's mass that moves along x, y and z with it.
std::string modes_table(std::span<const fem::BodyModes>, std::span<const fem::BodyCounts>);

}  // namespace coupling
