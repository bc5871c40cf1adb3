#include "data/io/hdf5_support.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "data/model/error.hpp"

namespace brachium::io::hdf5 {
namespace {

using data::InputError;

std::mutex& library_mutex() {
  static std::mutex mutex;
  return mutex;
}

// HDF5 hands the system's error on only as part of a description: "..., errno = 28, error message = '...',
// ...".
herr_t find_errno(unsigned, const H5E_error2_t* error, void* found) {
  if (!error->desc) return 0;
  if (const char* at = std::strstr(error->desc, "errno = ")) *static_cast<int*>(found) = std::atoi(at + 8);
  return 0;
}

// HDF5 clears its error stack at the next call, and handles close on the way out: the system's error is noted
// at once.
int last_system_error = 0;  // guarded by library_mutex()
herr_t note_error(hid_t stack, void*) {
  H5Ewalk2(stack, H5E_WALK_UPWARD, find_errno, &last_system_error);
  return 0;
}

Handle scalar_space() {
  return {H5Screate(H5S_SCALAR), H5Sclose};
}

bool write_scalar(hid_t object, const std::string& name, hid_t type, const void* value) {
  const Handle space = scalar_space();
  if (H5Aexists(object, name.c_str()) > 0) H5Adelete(object, name.c_str());
  const Handle attribute(H5Acreate2(object, name.c_str(), type, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose);
  return attribute && H5Awrite(attribute.get(), type, value) >= 0;
}

std::string trimmed(const char* text, std::size_t longest) {
  std::string s(text, ::strnlen(text, longest));
  while (!s.empty() && s.back() == ' ') s.pop_back();
  return s;
}

// Reads text of either kind through `read(memory_type, buffer)`.
template <class Read>
std::optional<std::vector<std::string>> read_any_text(hid_t type, hid_t space, Read read) {
  if (H5Tget_class(type) != H5T_STRING) return std::nullopt;
  const hssize_t points = H5Sget_simple_extent_npoints(space);
  if (points < 0 || points > 100'000'000) return std::nullopt;
  const auto count = static_cast<std::size_t>(points);
  std::vector<std::string> texts(count);
  if (count == 0) return texts;
  // The memory type is the file's own kind of text with the file's character set.
  const Handle memory(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_cset(memory.get(), H5Tget_cset(type));
  if (H5Tis_variable_str(type) > 0) {
    H5Tset_size(memory.get(), H5T_VARIABLE);
    std::vector<char*> pointers(count, nullptr);
    if (read(memory.get(), static_cast<void*>(pointers.data())) < 0) return std::nullopt;
    for (std::size_t i = 0; i < count; ++i) {
      if (pointers[i]) texts[i] = pointers[i];
    }
    H5Dvlen_reclaim(memory.get(), space, H5P_DEFAULT, pointers.data());
    return texts;
  }
  const std::size_t size = H5Tget_size(type);
  if (size == 0 || size > 10'000'000) return std::nullopt;
  H5Tset_size(memory.get(), size);
  H5Tset_strpad(memory.get(), H5Tget_strpad(type));
  std::vector<char> bytes(count * size);
  if (read(memory.get(), static_cast<void*>(bytes.data())) < 0) return std::nullopt;
  for (std::size_t i = 0; i < count; ++i) texts[i] = trimmed(bytes.data() + i * size, size);
  return texts;
}

}  // namespace

Lock::Lock() : lock_(library_mutex()) {
  // HDF5 1.10 crashes in its own exit handler after a file could not be written to a full disk. We close all
  // that we open, so that handler has nothing to do.
  static const bool once = [] { return H5dont_atexit() >= 0; }();
  static_cast<void>(once);
  last_system_error = 0;
  H5Eget_auto2(H5E_DEFAULT, &printer_, &printer_data_);
  H5Eset_auto2(H5E_DEFAULT, note_error, nullptr);
}

Lock::~Lock() {
  H5Eset_auto2(H5E_DEFAULT, printer_, printer_data_);
}

void fail_write(hid_t file, const std::filesystem::path& path, const std::string& what) {
  const int error = last_system_error;
  divert(file);
  throw InputError("write-failed",
                   fmt::format("cannot write {} to `{}`: {}", what, path.string(),
                               error ? std::strerror(error) : "the HDF5 library refused"),
                   "free some space on the disk, or choose another folder, and run again");
}

void divert(hid_t file) {
  void* driver_handle = nullptr;
  if (file < 0 || H5Fget_vfd_handle(file, H5P_DEFAULT, &driver_handle) < 0) return;
  const int memory = ::memfd_create("discarded", MFD_CLOEXEC);
  if (memory < 0) return;
  ::dup2(memory, *static_cast<int*>(driver_handle));
  ::close(memory);
}

Handle text_type() {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), H5T_VARIABLE);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return type;
}

Handle create_group(hid_t parent, const char* name) {
  return {H5Gcreate2(parent, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose};
}

bool write_attribute(hid_t object, const std::string& name, const std::string& value) {
  const char* text = value.c_str();
  return write_scalar(object, name, text_type().get(), static_cast<const void*>(&text));
}

bool write_attribute(hid_t object, const std::string& name, double value) {
  return write_scalar(object, name, H5T_NATIVE_DOUBLE, &value);
}

bool write_attribute(hid_t object, const std::string& name, long long value) {
  return write_scalar(object, name, H5T_NATIVE_LLONG, &value);
}

bool has_attribute(hid_t object, const std::string& name) {
  return H5Aexists(object, name.c_str()) > 0;
}

std::optional<std::string> text_attribute(hid_t object, const std::string& name) {
  if (!has_attribute(object, name)) return std::nullopt;
  const Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose);
  if (!attribute) return std::nullopt;
  const Handle type(H5Aget_type(attribute.get()), H5Tclose);
  const Handle space(H5Aget_space(attribute.get()), H5Sclose);
  if (!type || !space) return std::nullopt;
  auto texts = read_any_text(type.get(), space.get(), [&](hid_t memory, void* buffer) {
    return H5Aread(attribute.get(), memory, buffer);
  });
  if (!texts || texts->size() != 1) return std::nullopt;
  return std::move(texts->front());
}

std::optional<double> number_attribute(hid_t object, const std::string& name) {
  if (!has_attribute(object, name)) return std::nullopt;
  const Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose);
  if (!attribute) return std::nullopt;
  const Handle type(H5Aget_type(attribute.get()), H5Tclose);
  const Handle space(H5Aget_space(attribute.get()), H5Sclose);
  const H5T_class_t kind = H5Tget_class(type.get());
  if ((kind != H5T_FLOAT && kind != H5T_INTEGER) || H5Sget_simple_extent_npoints(space.get()) != 1)
    return std::nullopt;
  double value = 0.0;
  if (H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, &value) < 0) return std::nullopt;
  return value;
}

std::vector<std::string> attribute_names(hid_t object) {
  std::vector<std::string> names;
  const auto add = [](hid_t, const char* name, const H5A_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  hsize_t at = 0;
  H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, &at, add, &names);
  return names;
}

std::vector<std::string> children(hid_t group, H5O_type_t type) {
  std::vector<std::string> all, wanted;
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &all);
  for (std::string& name : all) {
    H5O_info_t info;
    if (H5Oget_info_by_name2(group, name.c_str(), &info, H5O_INFO_BASIC, H5P_DEFAULT) >= 0 &&
        info.type == type) {
      wanted.push_back(std::move(name));
    }
  }
  return wanted;
}

std::optional<std::vector<std::string>> read_texts(hid_t dataset) {
  const Handle type(H5Dget_type(dataset), H5Tclose);
  const Handle space(H5Dget_space(dataset), H5Sclose);
  if (!type || !space) return std::nullopt;
  return read_any_text(type.get(), space.get(), [&](hid_t memory, void* buffer) {
    return H5Dread(dataset, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer);
  });
}

bool write_text(hid_t parent, const std::string& name, const std::string& value) {
  const Handle space = scalar_space();
  const Handle type = text_type();
  const Handle dataset(
      H5Dcreate2(parent, name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose);
  const char* text = value.c_str();
  return dataset && H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                             static_cast<const void*>(&text)) >= 0;
}

Handle open_for_reading(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    throw InputError("missing-file", fmt::format("cannot read `{}`", file.string()), "check the path");
  }
  if (std::filesystem::file_size(file, error) == 0) {
    throw InputError("empty-file", fmt::format("`{}` is empty", file.string()), "make it again");
  }
  if (H5Fis_hdf5(file.c_str()) <= 0) {
    throw InputError("not-hdf5", fmt::format("`{}` is not an HDF5 file", file.string()),
                     "give a session made with `brachium import`, or a session description (.toml)");
  }
  Handle handle(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!handle) {
    throw InputError("damaged-file",
                     fmt::format("`{}` is cut off or damaged: HDF5 cannot open it", file.string()),
                     "make it again, or fetch a complete copy");
  }
  return handle;
}

void check_name(const std::string& name, const std::string& what) {
  const bool control =
      std::any_of(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; });
  if (name.empty() || name == "." || name == ".." || name.find('/') != std::string::npos || control) {
    throw InputError("bad-name", fmt::format("`{}` cannot be the name of a {}", name, what),
                     "a name must not be empty and must not hold `/` or control characters");
  }
}

}  // namespace brachium::io::hdf5
