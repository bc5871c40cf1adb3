#include "data/io/text_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "data/model/error.hpp"

namespace brachium::io {
namespace {

using data::InputError;
constexpr std::size_t block_bytes = std::size_t{1} << 18;
constexpr std::size_t longest_line = std::size_t{1} << 24;

}  // namespace

TextLines::TextLines(const std::filesystem::path& file) : file_(file), stream_(file, std::ios::binary) {
  std::error_code error;
  if (!stream_ || !std::filesystem::is_regular_file(file, error)) {
    throw InputError("missing-file", fmt::format("cannot read `{}`", file.string()),
                     "check the path and its permissions");
  }
  size_ = std::filesystem::file_size(file, error);
  buffer_.resize(block_bytes);
  refill();
  if (end_ >= 2 &&
      ((buffer_[0] == '\xFF' && buffer_[1] == '\xFE') || (buffer_[0] == '\xFE' && buffer_[1] == '\xFF'))) {
    throw InputError("wrong-encoding", fmt::format("`{}` is UTF-16 text", file.string()), "save it as UTF-8");
  }
  if (end_ >= 3 && std::memcmp(buffer_.data(), "\xEF\xBB\xBF", 3) == 0) at_ = 3;
  if (std::all_of(buffer_.begin() + static_cast<std::ptrdiff_t>(at_),
                  buffer_.begin() + static_cast<std::ptrdiff_t>(end_),
                  [](char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }) &&
      end_ == size_) {
    throw InputError("empty-file", fmt::format("`{}` is empty", file.string()), "export the recording again");
  }
}

// Keeps what has not been handed out and reads on behind it; false when nothing more came.
bool TextLines::refill() {
  if (at_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + at_, end_ - at_);
    base_ += at_;
    end_ -= at_;
    at_ = 0;
  }
  if (end_ == buffer_.size()) buffer_.resize(buffer_.size() * 2);
  stream_.read(buffer_.data() + end_, static_cast<std::streamsize>(buffer_.size() - end_));
  const auto got = static_cast<std::size_t>(stream_.gcount());
  end_ += got;
  return got > 0;
}

bool TextLines::next(std::string_view& line) {
  std::size_t searched = 0;
  while (true) {
    const char* begin = buffer_.data() + at_;
    if (const void* found = std::memchr(begin + searched, '\n', end_ - at_ - searched)) {
      const auto length = static_cast<std::size_t>(static_cast<const char*>(found) - begin);
      line = std::string_view(begin, length);
      at_ += length + 1;
      break;
    }
    searched = end_ - at_;
    if (searched > longest_line) {
      throw InputError("not-text", fmt::format("`{}` is not a text table: line {} does not end",
                                               file_.string(), line_ + 1));
    }
    if (refill()) continue;
    if (at_ == end_) return false;
    line = std::string_view(buffer_.data() + at_, end_ - at_);
    at_ = end_;
    break;
  }
  ++line_;
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  if (std::memchr(line.data(), '\0', line.size())) {
    throw InputError("not-text", fmt::format("`{}` is not a text table: line {} holds a null byte",
                                             file_.string(), line_));
  }
  return true;
}

void TextLines::seek(std::uintmax_t byte, std::size_t lines_before) {
  stream_.clear();
  stream_.seekg(static_cast<std::streamoff>(byte));
  base_ = byte;
  at_ = end_ = 0;
  line_ = lines_before;
}

}  // namespace brachium::io
