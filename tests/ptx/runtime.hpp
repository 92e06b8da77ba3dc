#pragma once
// What CUDA has no word for.
namespace ptx {

/// After a failure that a device would not recover from, and what was found: as if nothing had been. Whether it failed.
bool make_whole();

}  // namespace ptx
