#pragma once
/// What the HDF5 files of this folder share: one lock, handles that close themselves, attributes, error
/// texts. For the .cpp files of data/io only.

#include <hdf5.h>

#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace brachium::io::hdf5 {

/// Held around every HDF5 call of the program (Debian's library is built without its own lock). While it is
/// held, the library's own printing of errors is off.
class Lock {
 public:
  Lock();
  ~Lock();
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

 private:
  std::unique_lock<std::mutex> lock_;
  H5E_auto2_t printer_ = nullptr;
  void* printer_data_ = nullptr;
};

/// An HDF5 identifier and the function that closes it. Must die while a Lock is held.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle() = default;
  Handle(hid_t id, Close close_function) : id_(id), close_(close_function) {}
  Handle(Handle&& other) noexcept { swap(other); }
  Handle& operator=(Handle&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Handle() { close(); }

  hid_t get() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }
  /// False if closing failed, which for a file or dataset means that data could not be written.
  bool close() {
    const bool done = id_ < 0 || close_(id_) >= 0;
    id_ = H5I_INVALID_HID;
    return done;
  }

 private:
  void swap(Handle& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
  }
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

/// Throws InputError("write-failed") with the system's reason out of HDF5's error stack, after divert(file).
[[noreturn]] void fail_write(hid_t file, const std::filesystem::path& path, const std::string& what);

/// Sends all further writes of an open file to memory, so that HDF5 can close a file that will be thrown away
/// even when the disk is full (closing fails otherwise, and HDF5 1.10 does not survive that).
void divert(hid_t file);

Handle text_type();                                   ///< variable-length UTF-8
Handle create_group(hid_t parent, const char* name);  ///< id < 0 on failure
bool write_attribute(hid_t object, const std::string& name, const std::string& value);
bool write_attribute(hid_t object, const std::string& name, double value);
bool write_attribute(hid_t object, const std::string& name, long long value);

/// Values of attributes; nothing where the attribute is absent or of another kind.
std::optional<std::string> text_attribute(hid_t object, const std::string& name);
std::optional<double> number_attribute(hid_t object, const std::string& name);
bool has_attribute(hid_t object, const std::string& name);
std::vector<std::string> attribute_names(hid_t object);
/// Names of the children of a group, groups or datasets, in alphabetical order.
std::vector<std::string> children(hid_t group, H5O_type_t type);

/// All texts of a one-dimensional or scalar text dataset; nothing if it is none or cannot be read.
std::optional<std::vector<std::string>> read_texts(hid_t dataset);
bool write_text(hid_t parent, const std::string& name, const std::string& value);

/// Opens for reading; throws InputError "missing-file", "empty-file", "not-hdf5", "damaged-file".
Handle open_for_reading(const std::filesystem::path& file);

/// Throws InputError("bad-name") unless `name` can name an HDF5 object: not empty, ".", "..", no "/", no
/// control characters.
void check_name(const std::string& name, const std::string& what);

}  // namespace brachium::io::hdf5
