#pragma once
// ParaView's collection file: which data file holds which instant. Rewritten whole, through a temporary file and a
// rename, at every addition, so that a run that is cut off leaves a readable collection.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <utility>

#include "base/error.hpp"

namespace base {

class Pvd {
 public:
  explicit Pvd(std::filesystem::path file) : file_(std::move(file)) {}

  /// What has been added so far, for go_on_after() of another life of the run.
  const std::string& entries() const { return entries_; }
  /// The next addition follows these; whatever else the file names goes then.
  void go_on_after(const std::string& entries) { entries_ = entries; }

  /// Adds one data file (its path relative to the folder of the collection) at a time [s].
  /// Throws base::MachineError when the disk fails.
  void add(double time, const std::string& data_file) { write(enter(time, data_file)); }

  /// The same in two parts: what the file is to hold from now on, which write() puts there at some time.
  std::string enter(double time, const std::string& data_file) {
    char stamp[32];
    std::snprintf(stamp, sizeof stamp, "%.9g", time);
    entries_ += std::string("    <DataSet timestep=\"") + stamp + "\" part=\"0\" file=\"" + data_file + "\"/>\n";
    return "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
           "  <Collection>\n" +
           entries_ + "  </Collection>\n</VTKFile>\n";
  }

  void write(const std::string& text) const {
    auto temporary = file_;
    temporary += ".part";
    std::ofstream out(temporary, std::ios::trunc);
    out << text;
    out.close();
    std::error_code failure;
    if (out) std::filesystem::rename(temporary, file_, failure);
    if (!out || failure) throw MachineError("cannot write " + file_.string() + ": is the disk full or read-only?");
  }

 private:
  std::filesystem::path file_;
  std::string entries_;  // the <DataSet> lines so far
};

}  // namespace base
