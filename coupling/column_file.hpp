#pragma once
// Columns (base/columns.hpp) as an HDF5 file: one dataset per column, its name the path. Behind HDF5's part the file
// ends with a CRC-32 of all of it, which is looked at before anything is read.
#include <filesystem>
#include <string>

#include "base/columns.hpp"
#include "base/error.hpp"

namespace coupling {

/// The file is truncated, its checksums do not fit, or it is no such file at all.
struct DamagedFile : base::UserError {
  using base::UserError::UserError;
};

/// HDF5 asks MPI when it starts: to be called in the thread that may, before another one writes columns.
void start_column_files();

/// Writes the whole file or nothing: under a temporary name, forced to the disk, renamed.
/// Throws base::MachineError.
void write_columns(const std::filesystem::path&, const base::Columns&);

/// The columns whose names begin with this group's, without it; "" reads all. Throws base::UserError when the file
/// cannot be opened, DamagedFile when it is not what was written.
base::Columns read_columns(const std::filesystem::path&, const std::string& group);

/// Forces to the disk what has been written to a file so far. Throws base::MachineError.
void sync_file(const std::filesystem::path&);

}  // namespace coupling
