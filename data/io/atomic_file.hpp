#pragma once
/// Files that are either the old ones or the whole new ones: written under a temporary name in the same
/// folder, flushed to the disk, then renamed.

#include <filesystem>
#include <string>

namespace brachium::io {

/// Owns a temporary name beside `target`. commit() flushes and renames; without it the destructor removes the
/// file. The temporary name is `.<target>.partial-<host>-<process id>-<counter>`: nothing that reads results
/// matches it.
class AtomicFile {
 public:
  /// Throws InputError("missing-folder" | "read-only-folder") if the target's folder cannot take a new file.
  explicit AtomicFile(std::filesystem::path target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::filesystem::path& target() const { return target_; }
  const std::filesystem::path& temporary() const { return temporary_; }

  /// Call when the temporary file is written and closed. Throws InputError("write-failed") with the system's
  /// reason.
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path temporary_;
  bool committed_ = false;
};

/// The whole text to `target`, atomically. Throws InputError("write-failed", ...) naming the path.
void write_text_atomically(const std::filesystem::path& target, const std::string& text);

/// The whole file as text. Throws InputError("missing-file" | "empty-file").
std::string read_text(const std::filesystem::path& file);

}  // namespace brachium::io
