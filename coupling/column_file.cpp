#include "coupling/column_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <hdf5.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <mutex>
#include <new>

namespace coupling {
namespace {

namespace fs = std::filesystem;

/// Nothing here relies on an HDF5 that knows threads: whoever calls it holds this.
std::mutex one_at_a_time;

/// HDF5's numbers, each with what closes it.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }
  bool sound() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// While it lives HDF5 prints nothing: exceptions say it in our words.
class Quiet {
 public:
  Quiet() {
    H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Quiet() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

 private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

/// POSIX' file numbers.
class Descriptor {
 public:
  Descriptor(const fs::path& path, int flags) : number_(open(path.c_str(), flags, 0666)) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  operator int() const { return number_; }

 private:
  int number_;
};

hid_t type_of(double) { return H5T_NATIVE_DOUBLE; }
hid_t type_of(float) { return H5T_NATIVE_FLOAT; }
hid_t type_of(int) { return H5T_NATIVE_INT; }
hid_t type_of(std::int64_t) { return H5T_NATIVE_INT64; }
hid_t type_of(char) { return H5T_C_S1; }

/// No failure of an image in memory but for want of memory.
void need(bool done) {
  if (!done) throw std::bad_alloc();
}

template <class Values>
void write_dataset(hid_t file, const std::string& name, const Values& values) {
  const hid_t type = type_of(typename Values::value_type{});
  const hsize_t size = values.size();
  const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose), links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  need(H5Pset_create_intermediate_group(links, 1) >= 0);
  const Handle data(H5Dcreate2(file, name.c_str(), type, space, links, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
  need(data.sound());
  if (size > 0) need(H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0);
}

/// Ends the file, behind what HDF5 knows of: a mark, and the checksum of all before it.
struct Seal {
  std::array<char, 8> mark{'t', 'r', 'a', 'c', 'k', 'b', 'e', 'd'};
  std::uint64_t checksum = 0;
  bool operator==(const Seal&) const = default;
};

std::uint64_t checksum_of(std::uint64_t before, const char* bytes, std::size_t size) {
  return crc32_z(before, reinterpret_cast<const unsigned char*>(bytes), size);
}

/// The file as it is to lie on the disk. HDF5 makes it in memory and leaves it there when it closes it, so that a full
/// disk meets plain writes only, whose failure is told in full.
class Image {
 public:
  explicit Image(const base::Columns& columns) {
    const std::lock_guard alone(one_at_a_time);
    constexpr std::size_t increment = 4096;  // [bytes] HDF5's part ends in up to so many that mean nothing
    const Quiet quiet;
    const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    need(H5Pset_fapl_core(access, increment, 0) >= 0);
    need(H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST) >= 0);
    H5FD_file_image_callbacks_t calls{allocate, nullptr, resize, leave, same, done, this};
    need(H5Pset_file_image_callbacks(access, &calls) >= 0);
    const hid_t file = H5Fcreate("checkpoint in memory", H5F_ACC_TRUNC, H5P_DEFAULT, access);
    need(file >= 0);
    const Handle closed_last(file, H5Fclose);
    for (const auto& [name, column] : columns)
      std::visit([&](const auto& values) { write_dataset(file, name, values); }, column);
    hsize_t end = 0;
    need(H5Fflush(file, H5F_SCOPE_GLOBAL) >= 0 && H5Fget_filesize(file, &end) >= 0);
    size_ = end;
  }
  ~Image() { std::free(bytes_); }
  Image(const Image&) = delete;
  Image& operator=(const Image&) = delete;
  const char* data() const { return static_cast<const char*>(bytes_); }
  std::size_t size() const { return bytes_ ? size_ : 0; }

 private:
  static void* allocate(std::size_t size, H5FD_file_image_op_t, void*) { return std::malloc(size); }
  static void* resize(void* bytes, std::size_t size, H5FD_file_image_op_t, void*) { return std::realloc(bytes, size); }
  static herr_t leave(void* bytes, H5FD_file_image_op_t when, void* self) {
    if (when == H5FD_FILE_IMAGE_OP_FILE_CLOSE)
      static_cast<Image*>(self)->bytes_ = bytes;
    else
      std::free(bytes);
    return 0;
  }
  static void* same(void* self) { return self; }
  static herr_t done(void*) { return 0; }

  void* bytes_ = nullptr;
  std::size_t size_ = 0;
};

[[noreturn]] void fail_to_write(const fs::path& path) {
  throw base::MachineError(fmt::format("{}: cannot be written ({})", path.string(), std::strerror(errno)));
}

void write_all(const Descriptor& file, const fs::path& path, const char* bytes, std::size_t size) {
  for (std::size_t done = 0; done < size;) {
    const ssize_t more = write(file, bytes + done, size - done);
    if (more < 0 && errno != EINTR) fail_to_write(path);
    if (more > 0) done += static_cast<std::size_t>(more);
  }
}

void write_image(const fs::path& path, const Image& image) {
  const Descriptor file(path, O_WRONLY | O_CREAT | O_TRUNC);
  if (file < 0) fail_to_write(path);
  const Seal seal{.checksum = checksum_of(0, image.data(), image.size())};
  write_all(file, path, image.data(), image.size());
  write_all(file, path, reinterpret_cast<const char*>(&seal), sizeof seal);
  if (fsync(file) != 0) fail_to_write(path);
}

/// Before HDF5 sees the file, which is not made for damaged ones.
void require_sealed(const fs::path& path) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  std::ifstream in(path, std::ios::binary);
  if (error || size < sizeof(Seal)) throw DamagedFile("it is truncated, or no checkpoint");
  std::vector<char> block(1 << 20);
  Seal expected, found;
  for (std::uintmax_t left = size - sizeof(Seal); left > 0 && in;) {
    const std::size_t length = std::min<std::uintmax_t>(left, block.size());
    in.read(block.data(), static_cast<std::streamsize>(length));
    expected.checksum = checksum_of(expected.checksum, block.data(), length);
    left -= length;
  }
  in.read(reinterpret_cast<char*>(&found), sizeof found);
  if (!in || found.mark != expected.mark) throw DamagedFile("it is truncated, or no checkpoint");
  if (found != expected) throw DamagedFile("it is damaged: its checksum does not fit");
}

template <class Values>
Values read_dataset(hid_t data, std::size_t size) {
  Values values(size, typename Values::value_type{});
  const bool done = size == 0 || H5Dread(data, type_of(typename Values::value_type{}), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                                         values.data()) >= 0;
  if (!done) throw DamagedFile("its data cannot be read");
  return values;
}

base::Column read_column(hid_t file, const std::string& name) {
  const Handle data(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!data.sound()) throw DamagedFile("its structure is damaged");
  const Handle type(H5Dget_type(data), H5Tclose), space(H5Dget_space(data), H5Sclose);
  const hssize_t points = space.sound() ? H5Sget_simple_extent_npoints(space) : -1;
  if (!type.sound() || points < 0) throw DamagedFile("its structure is damaged");
  const auto size = static_cast<std::size_t>(points);
  const bool wide = H5Tget_size(type) == 8;
  switch (H5Tget_class(type)) {
    case H5T_STRING:
      return read_dataset<std::string>(data, size);
    case H5T_INTEGER:
      if (wide) return read_dataset<std::vector<std::int64_t>>(data, size);
      return read_dataset<std::vector<int>>(data, size);
    default:
      if (wide) return read_dataset<std::vector<double>>(data, size);
      return read_dataset<std::vector<float>>(data, size);
  }
}

herr_t remember_dataset(hid_t, const char* name, const H5O_info_t* info, void* names) {
  if (info->type == H5O_TYPE_DATASET) static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

}  // namespace

void start_column_files() {
  const std::lock_guard alone(one_at_a_time);
  need(H5open() >= 0);
}

void write_columns(const fs::path& path, const base::Columns& columns) {
  const fs::path temporary = path.string() + ".part";
  std::error_code error;
  try {
    write_image(temporary, Image(columns));
    fs::rename(temporary, path, error);
    if (error) throw base::MachineError(fmt::format("{}: cannot be written ({})", path.string(), error.message()));
    sync_file(path.parent_path());
  } catch (...) {
    fs::remove(temporary, error);
    throw;
  }
}

void sync_file(const fs::path& path) {
  const Descriptor file(path.empty() ? fs::path(".") : path, O_RDONLY);
  if (file < 0 || fsync(file) != 0) fail_to_write(path);
}

base::Columns read_columns(const fs::path& path, const std::string& group) {
  std::error_code ignored;
  base::require_user(fs::is_regular_file(path, ignored), path.string() + ": no such file; name a checkpoint-NNNN.h5");
  base::require_user(std::ifstream(path).good(),
                     path.string() + ": no permission to read it; change its permissions or copy it");
  const std::lock_guard alone(one_at_a_time);
  const Quiet quiet;
  try {
    require_sealed(path);
    const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    if (!file.sound()) throw DamagedFile("HDF5 cannot open it");
    std::vector<std::string> names;
    if (H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_NATIVE, remember_dataset, &names, H5O_INFO_BASIC) < 0)
      throw DamagedFile("its structure is damaged");
    base::Columns columns;
    for (const std::string& name : names)
      if (name.starts_with(group)) columns[name.substr(group.size())] = read_column(file, name);
    return columns;
  } catch (const DamagedFile& damage) {
    throw DamagedFile(fmt::format("{}: cannot be used: {}; name an earlier checkpoint", path.string(), damage.what()));
  }
}

}  // namespace coupling
