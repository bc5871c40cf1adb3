#include "data/io/mesh_cursor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "data/io/atomic_file.hpp"
#include "data/model/error.hpp"

namespace brachium::io {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\n' || c == '\r' || c == '\t';
}

}  // namespace

MeshCursor::MeshCursor(std::filesystem::path file) : file_(std::move(file)), text_(read_text(file_)) {}

void MeshCursor::fail_at(std::size_t at, const std::string& code, const std::string& message,
                         const std::string& help) const {
  data::Diagnostic d{data::Severity::error, code, message, std::nullopt, help};
  at = std::min(at, text_.size());
  if (binary_) {
    d.message = fmt::format("`{}`, byte {}: {}", file_.string(), at, message);
    throw data::InputError(std::move(d));
  }
  const auto begin = text_.begin();
  const std::size_t start = at == 0 ? 0 : text_.rfind('\n', at - 1) + 1;
  const std::size_t end = std::min(text_.find('\n', at), text_.size());
  std::string line = text_.substr(start, std::min<std::size_t>(end - start, 120));
  std::erase_if(line, [](char c) { return static_cast<unsigned char>(c) < 0x20; });
  d.where = data::SourceSpan{
      file_.string(),
      static_cast<int>(std::count(begin, begin + static_cast<std::ptrdiff_t>(start), '\n')) + 1,
      static_cast<int>(std::min<std::size_t>(at - start, 119)) + 1, 1, std::move(line)};
  throw data::InputError(std::move(d));
}

void MeshCursor::skip_blanks() {
  while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
}

bool MeshCursor::at_end() {
  skip_blanks();
  return at_ == text_.size();
}

std::string_view MeshCursor::peek() {
  skip_blanks();
  std::size_t end = at_;
  while (end < text_.size() && !is_blank(text_[end])) ++end;
  return std::string_view(text_).substr(at_, end - at_);
}

std::string_view MeshCursor::token(const char* what) {
  const std::string_view found = peek();
  if (found.empty())
    fail("mesh-truncated", fmt::format("the file ends where {} should follow", what),
         "write or fetch the file again");
  at_ += found.size();
  return found;
}

std::string_view MeshCursor::line() {
  const std::size_t end = std::min(text_.find('\n', at_), text_.size());
  std::string_view found = std::string_view(text_).substr(at_, end - at_);
  at_ = std::min(end + 1, text_.size());
  if (!found.empty() && found.back() == '\r') found.remove_suffix(1);
  return found;
}

double MeshCursor::number(const char* what) {
  skip_blanks();
  const std::size_t start = at_;
  const std::string_view word = token(what);
  const bool plus = word.starts_with('+');
  double value = 0.0;
  const auto [end, status] = std::from_chars(word.data() + plus, word.data() + word.size(), value);
  if (status != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
    fail_at(start, "mesh-syntax", fmt::format("`{}` is not a finite number ({})", word.substr(0, 40), what));
  return value;
}

long long MeshCursor::integer(const char* what) {
  skip_blanks();
  const std::size_t start = at_;
  const std::string_view word = token(what);
  long long value = 0;
  const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (status != std::errc() || end != word.data() + word.size())
    fail_at(start, "mesh-syntax", fmt::format("`{}` is not an integer ({})", word.substr(0, 40), what));
  return value;
}

std::size_t MeshCursor::checked_count(long long count, const char* what, std::size_t bytes_each) const {
  if (count < 0) fail("mesh-syntax", fmt::format("{} cannot be {}", what, count));
  if (static_cast<unsigned long long>(count) > left() / bytes_each + 1) {
    fail("mesh-truncated", fmt::format("the file ends too early for {} = {}", what, count),
         "write or fetch the file again");
  }
  return static_cast<std::size_t>(count);
}

std::size_t MeshCursor::count(const char* what, std::size_t bytes_each) {
  return checked_count(integer(what), what, bytes_each);
}

void MeshCursor::need(std::size_t bytes, const char* what) const {
  if (left() < bytes)
    fail("mesh-truncated", fmt::format("the file ends within {}", what), "write or fetch the file again");
}

}  // namespace brachium::io
