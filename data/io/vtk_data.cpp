#include "data/io/vtk_data.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

namespace brachium::io {
namespace {

int base64_value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : (c == '/' ? 63 : -1);
}

/// Whole groups of four characters from `at` on, at least `bytes`; padding ends a run. Nothing if there are
/// too few.
std::optional<std::string> from_base64(std::string_view text, std::size_t& at, std::size_t bytes) {
  std::string out;
  out.reserve(std::min(bytes, text.size()) + 3);
  while (out.size() < bytes) {
    if (text.size() - at < 4) return std::nullopt;
    int v[4];
    int pad = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const char c = text[at + i];
      v[i] = c == '=' && i >= 2 ? 0 : base64_value(c);
      pad += c == '=' ? 1 : 0;
      if (v[i] < 0) return std::nullopt;
    }
    at += 4;
    const int group = v[0] << 18 | v[1] << 12 | v[2] << 6 | v[3];
    out.push_back(static_cast<char>(group >> 16));
    if (pad < 2) out.push_back(static_cast<char>(group >> 8 & 0xFF));
    if (pad < 1) out.push_back(static_cast<char>(group & 0xFF));
    if (pad > 0 && out.size() < bytes) return std::nullopt;
  }
  return out;
}

template <class T>
T load(const char* bytes, bool big_endian) {
  char copy[sizeof(T)];
  std::memcpy(copy, bytes, sizeof(T));
  if (big_endian) std::reverse(copy, copy + sizeof(T));
  T value;
  std::memcpy(&value, copy, sizeof(T));
  return value;
}

/// Reads runs of bytes from a raw or base64 stream.
class Stream {
 public:
  Stream(std::string_view text, bool base64) : base64_(base64), text_(text) {
    if (!base64) return;
    clean_.reserve(text.size());
    for (const char c : text) {
      if (c != ' ' && c != '\n' && c != '\r' && c != '\t') clean_.push_back(c);
    }
    text_ = clean_;
  }
  /// `bytes` more; what a group of base64 holds beyond them is kept for the next call, unless the group was
  /// padded.
  std::optional<std::string> take(std::size_t bytes) {
    std::string out;
    const std::size_t from_rest = std::min(bytes, rest_.size());
    out = rest_.substr(0, from_rest);
    rest_.erase(0, from_rest);
    if (out.size() == bytes) return out;
    const std::size_t needed = bytes - out.size();
    if (!base64_) {
      if (text_.size() - at_ < needed) return std::nullopt;
      out += text_.substr(at_, needed);
      at_ += needed;
      return out;
    }
    if (needed / 3 > (text_.size() - at_) / 4) return std::nullopt;
    auto more = from_base64(text_, at_, needed);
    if (!more) return std::nullopt;
    out += more->substr(0, needed);
    rest_ = more->substr(needed);
    return out;
  }

 private:
  bool base64_;
  std::string clean_, rest_;
  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

std::optional<std::string> decode_array(std::string_view text, const VtkEncoding& encoding,
                                        std::string& reason) {
  Stream stream(text, encoding.base64);
  const std::size_t word = encoding.wide_header ? 8 : 4;
  const auto words = [&](std::size_t n) -> std::optional<std::vector<std::uint64_t>> {
    if (n > text.size() / word + 1) return std::nullopt;
    const auto bytes = stream.take(n * word);
    if (!bytes) return std::nullopt;
    std::vector<std::uint64_t> list;
    for (std::size_t i = 0; i < n; ++i) {
      list.push_back(word == 8 ? load<std::uint64_t>(bytes->data() + 8 * i, encoding.big_endian)
                               : load<std::uint32_t>(bytes->data() + 4 * i, encoding.big_endian));
    }
    return list;
  };
  reason = "the data end too early, or are not encoded as the file says";
  if (!encoding.zlib) {
    const auto size = words(1);
    if (!size || size->front() > text.size()) return std::nullopt;
    return stream.take(size->front());
  }
  const auto head = words(3);
  if (!head) return std::nullopt;
  const std::uint64_t blocks = (*head)[0], block_size = (*head)[1], last_size = (*head)[2];
  const auto sizes = blocks <= text.size() ? words(blocks) : std::nullopt;
  if (!sizes) return std::nullopt;
  std::string out;
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::uint64_t full = b + 1 == blocks && last_size != 0 ? last_size : block_size;
    const std::uint64_t packed = (*sizes)[b];
    // zlib cannot make more than 1032 bytes of one.
    if (packed > text.size() || full > 1032 * packed + 64) return std::nullopt;
    const auto block = stream.take(packed);
    if (!block) return std::nullopt;
    const std::size_t at = out.size();
    out.resize(at + full);
    uLongf made = full;
    const int status = ::uncompress(reinterpret_cast<Bytef*>(out.data() + at), &made,
                                    reinterpret_cast<const Bytef*>(block->data()), packed);
    if (status != Z_OK || made != full) {
      reason = fmt::format("block {} of the zlib data is damaged", b);
      return std::nullopt;
    }
  }
  return out;
}

std::size_t vtk_type_size(std::string_view type) {
  constexpr std::array<std::pair<std::string_view, std::size_t>, 11> sizes{{{"Int8", 1},
                                                                            {"UInt8", 1},
                                                                            {"Int16", 2},
                                                                            {"UInt16", 2},
                                                                            {"Int32", 4},
                                                                            {"UInt32", 4},
                                                                            {"Int64", 8},
                                                                            {"UInt64", 8},
                                                                            {"Float32", 4},
                                                                            {"Float64", 8},
                                                                            {"String", 1}}};
  for (const auto& [name, size] : sizes) {
    if (name == type) return size;
  }
  return 0;
}

std::vector<double> vtk_numbers(const std::string& bytes, std::string_view type, bool big_endian) {
  const std::size_t size = vtk_type_size(type), n = bytes.size() / size;
  std::vector<double> numbers(n);
  const auto fill = [&]<class T>(T) {
    for (std::size_t i = 0; i < n; ++i)
      numbers[i] = static_cast<double>(load<T>(bytes.data() + i * sizeof(T), big_endian));
  };
  if (type == "Float64") fill(double{});
  if (type == "Float32") fill(float{});
  if (type == "Int64") fill(std::int64_t{});
  if (type == "UInt64") fill(std::uint64_t{});
  if (type == "Int32") fill(std::int32_t{});
  if (type == "UInt32") fill(std::uint32_t{});
  if (type == "Int16") fill(std::int16_t{});
  if (type == "UInt16") fill(std::uint16_t{});
  if (type == "Int8") fill(std::int8_t{});
  if (type == "UInt8" || type == "String") fill(std::uint8_t{});
  return numbers;
}

}  // namespace brachium::io
