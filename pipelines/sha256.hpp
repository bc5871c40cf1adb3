#pragma once
/// SHA-256 (FIPS 180-4, doi:10.6028/NIST.FIPS.180-4), for fingerprints of options and files.

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace brachium::pipelines {

class Sha256 {
 public:
  void add(std::span<const std::uint8_t> bytes);
  void add(std::string_view text);
  /// 64 hexadecimal digits; nothing may be added afterwards.
  std::string finish();

 private:
  void compress(const std::uint8_t* block);

  std::array<std::uint32_t, 8> hash_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                     0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<std::uint8_t, 64> block_{};
  std::size_t filled_ = 0;
  std::uint64_t length_ = 0;  ///< bytes
};

std::string sha256(std::string_view text);
/// Of a file's content, read by chunks; throws InputError("missing-file").
std::string sha256_of_file(const std::filesystem::path& file);

}  // namespace brachium::pipelines
