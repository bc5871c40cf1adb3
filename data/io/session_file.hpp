#pragma once
/// A session as an HDF5 file that h5py and xarray open as it is.
///
///   /                          format "brachium-session", format_version 1, subject, anthropometry.<name>,
///                              attribute.<name> for each free text
///   /trials/<trial>            name, index (order), kind, condition.<name> (numbers), attribute.<name>
///   /trials/<trial>/<signal>   float64, chunked, shuffled, deflated; units and unit (the same text; `units` is
///                              what xarray and the CF conventions read), quantity, rate_hz, start_time_s,
///                              muscle, coordinate, index (order), attribute.<name>
///   /trials/<trial>/time_<n>   time stamps [s], one dimension scale per distinct (rate, start, count) of the
///                              trial, attached to its signals
///
/// The samples carry checksums (Fletcher-32), so that damaged bytes are found when they are read.
/// Names with a `/`, empty names, "." and "..", and signal names of the form time_<n> are refused.
/// Debian's HDF5 is not safe for threads: every call goes through one lock of the whole program.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "data/model/session.hpp"

namespace brachium::io {

/// A session file opened for reading: names, units and rates at once, samples when asked for.
class SessionFile final : public data::SessionSource {
 public:
  /// Throws InputError naming the file: "missing-file", "empty-file", "not-hdf5", "damaged-file" (also
  /// cut-off files), "wrong-format", "wrong-version", "missing-attribute", "missing-group", "wrong-type".
  explicit SessionFile(const std::filesystem::path& file);
  ~SessionFile() override;
  SessionFile(const SessionFile&) = delete;
  SessionFile& operator=(const SessionFile&) = delete;

  const data::SessionInfo& info() const override;
  using SessionSource::read;
  /// Throws std::out_of_range past the end, InputError("damaged-data") where the stored bytes fail their
  /// checksum, InputError("non-finite-sample") where a file of another program holds NaN or Inf.
  void read(std::size_t trial, std::size_t signal, std::size_t first, std::span<double> out) const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes a session file. Nothing stands under the file's name before commit(); without commit() nothing is
/// left.
class SessionFileWriter : public data::SessionSink {
 public:
  struct Options {
    int deflate_level = 1;  ///< 0 (none) to 9
    std::size_t chunk_samples = std::size_t{1}
                                << 16;  ///< samples per chunk; a chunk is what one reads at least
  };

  /// Throws InputError("missing-folder" | "read-only-folder").
  explicit SessionFileWriter(const std::filesystem::path& file);
  SessionFileWriter(const std::filesystem::path& file, const Options& options);
  ~SessionFileWriter() override;
  SessionFileWriter(const SessionFileWriter&) = delete;
  SessionFileWriter& operator=(const SessionFileWriter&) = delete;

  void begin(const data::SessionInfo& session) override;
  /// Throws InputError("bad-name" | "duplicate-trial").
  void begin_trial(const data::TrialInfo& trial) override;
  /// Throws InputError("bad-name" | "duplicate-signal" | "bad-signal" (rate not positive, no samples, no
  /// unit)).
  void begin_signal(const std::string& trial, const data::SignalInfo& info) override;
  /// Every sample once, in any order of chunks (in their order is fastest). Throws
  /// InputError("non-finite-sample") naming signal and time, InputError("write-failed"), std::out_of_range
  /// past the end.
  void write_samples(const std::string& trial, const std::string& signal, std::size_t first,
                     std::span<const double> samples) override;

  /// Flushes and renames. Throws InputError("write-failed") on a full disk, std::logic_error if samples of an
  /// announced signal were never written.
  void commit();

 protected:
  /// The HDF5 identifier of the open file, for what a stage's output adds to it.
  std::int64_t hdf5_id() const;
  const std::filesystem::path& target() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A whole session in one call.
void write_session(const data::Session& session, const std::filesystem::path& file);
data::Session read_session(const std::filesystem::path& file);

}  // namespace brachium::io
