#pragma once
/// A mesh file in memory, read from front to end as text or bytes; mistakes know their place. For the .cpp
/// files of data/io only.

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

namespace brachium::io {

class MeshCursor {
 public:
  /// Throws InputError("missing-file" | "empty-file").
  explicit MeshCursor(std::filesystem::path file);

  const std::filesystem::path& file() const { return file_; }
  const std::string& text() const { return text_; }
  std::size_t at() const { return at_; }
  std::size_t left() const { return text_.size() - at_; }
  void seek(std::size_t at) { at_ = at; }
  /// From here on places are told as bytes, not lines.
  void set_binary(bool binary) { binary_ = binary; }
  void set_swap(bool swap) { swap_ = swap; }

  /// InputError with the place of the cursor, or of `at`.
  [[noreturn]] void fail(const std::string& code, const std::string& message,
                         const std::string& help = {}) const {
    fail_at(at_, code, message, help);
  }
  [[noreturn]] void fail_at(std::size_t at, const std::string& code, const std::string& message,
                            const std::string& help = {}) const;

  // Text. Blanks and line ends part tokens. At the end of the file: "mesh-truncated".
  bool at_end();  ///< only blanks are left
  std::string_view token(const char* what);
  std::string_view peek();          ///< next token without taking it; empty at the end
  std::string_view line();          ///< the rest of this line, without its end
  double number(const char* what);  ///< finite, else "mesh-syntax"
  long long integer(const char* what);
  /// How many things follow: not negative, and no more than fit into the rest of the file at `bytes_each`.
  std::size_t count(const char* what, std::size_t bytes_each);

  // Bytes.
  template <class T>
  T raw(const char* what) {
    need(sizeof(T), what);
    T value;
    char* bytes = reinterpret_cast<char*>(&value);
    std::memcpy(bytes, text_.data() + at_, sizeof(T));
    if (swap_) {
      for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
    }
    at_ += sizeof(T);
    return value;
  }
  std::size_t checked_count(long long count, const char* what, std::size_t bytes_each) const;
  void need(std::size_t bytes, const char* what) const;

 private:
  void skip_blanks();
  std::filesystem::path file_;
  std::string text_;
  std::size_t at_ = 0;
  bool binary_ = false, swap_ = false;
};

}  // namespace brachium::io
