#pragma once
/// A text file line by line, in large blocks. For the .cpp files of data/io only.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace brachium::io {

class TextLines {
 public:
  /// Throws InputError("missing-file" | "empty-file"). Skips a UTF-8 byte-order mark; refuses UTF-16
  /// ("wrong-encoding").
  explicit TextLines(const std::filesystem::path& file);

  /// The next line without its end (\n, \r\n or a lone \r at its end); false at the end of the file. The view
  /// holds until the next call. Throws InputError("not-text") for a line longer than 16 MB or with a null
  /// byte.
  bool next(std::string_view& line);

  std::size_t line() const { return line_; }                ///< number of the line handed out last, from 1
  std::uintmax_t next_byte() const { return base_ + at_; }  ///< where the next line starts
  void seek(std::uintmax_t byte, std::size_t lines_before);
  double fraction() const {
    return size_ == 0 ? 1.0 : static_cast<double>(next_byte()) / static_cast<double>(size_);
  }

 private:
  bool refill();

  std::filesystem::path file_;
  std::ifstream stream_;
  std::vector<char> buffer_;
  std::uintmax_t base_ = 0;  // place of buffer_[0] in the file
  std::uintmax_t size_ = 0;
  std::size_t at_ = 0, end_ = 0, line_ = 0;
};

}  // namespace brachium::io
