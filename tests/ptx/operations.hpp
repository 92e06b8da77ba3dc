#pragma once
// What each instruction does to a row of lanes.
#include <string>
#include <vector>

#include "tests/ptx/program.hpp"

namespace ptx {

/// Sets `run` and `kind` from an opcode's parts, e.g. {"fma", "rn", "f64"}; false where it is not known. Loads and
/// stores take their space from the opcode unless the instruction has one.
bool choose_operation(const std::vector<std::string>& parts, Instruction& instruction);

}  // namespace ptx
