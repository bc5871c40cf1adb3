/// Peak memory and time of importing a long recording and reading it back by signals and pieces.
///
///   session_memory_bench FOLDER [MINUTES = 60] [CHANNELS = 16] [RATE_HZ = 2000]
///
/// Writes FOLDER/long.csv first (about 1.1 GB for an hour) and leaves it there for the next run. Fails when the peak
/// exceeds 300 MB.

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "data/io/session_description.hpp"
#include "data/io/session_file.hpp"

using namespace brachium;

namespace {

double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void write_recording(const std::filesystem::path& file, std::size_t rows, int channels, double rate_hz) {
  std::ofstream out(file, std::ios::binary);
  std::string text = "time";
  for (int c = 0; c < channels; ++c) text += fmt::format(",emg{}", c + 1);
  text += "\n";
  for (std::size_t i = 0; i < rows; ++i) {
    text += fmt::format("{:.4f}", static_cast<double>(i) / rate_hz);
    for (int c = 0; c < channels; ++c)
      text += fmt::format(",{:.3f}", 100.0 * std::sin(0.01 * static_cast<double>(i % 100003) * (c + 1)));
    text += "\n";
    if (text.size() > (1u << 20) || i + 1 == rows) {
      out << text;
      text.clear();
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::puts("session_memory_bench FOLDER [MINUTES] [CHANNELS] [RATE_HZ]");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  const double minutes = argc > 2 ? std::atof(argv[2]) : 60.0;
  const int channels = argc > 3 ? std::atoi(argv[3]) : 16;
  const double rate_hz = argc > 4 ? std::atof(argv[4]) : 2000.0;
  const auto rows = static_cast<std::size_t>(minutes * 60.0 * rate_hz);
  if (!std::filesystem::exists(folder / "long.csv"))
    write_recording(folder / "long.csv", rows, channels, rate_hz);
  std::ofstream(folder / "long.toml")
      << "[session]\nsubject = \"long\"\n[[trial]]\nname = \"long\"\nkind = \"test\"\n"
         "[[file]]\npath = \"long.csv\"\ntime = \"time\"\nname = \"{column}\"\nquantity = \"emg\"\nunit = "
         "\"uV\"\n";
  double begin = seconds();
  {
    io::SessionFileWriter writer(folder / "long.h5");
    io::import_session(io::read_session_description(folder / "long.toml"), writer);
    writer.commit();
  }
  std::printf("import: %.1f s for %.0f MB of text, peak memory %.0f MB\n", seconds() - begin,
              static_cast<double>(std::filesystem::file_size(folder / "long.csv")) / 1e6, peak_megabytes());
  begin = seconds();
  const io::SessionFile session(folder / "long.h5");
  double largest = 0.0;
  std::vector<double> piece(1 << 16);
  for (std::size_t s = 0; s < session.info().trials[0].signals.size(); ++s) {
    const std::size_t count = session.info().trials[0].signals[s].count;
    for (std::size_t first = 0; first < count; first += piece.size()) {
      const std::size_t n = std::min(piece.size(), count - first);
      session.read(0, s, first, std::span(piece).first(n));
      for (std::size_t i = 0; i < n; ++i) largest = std::max(largest, std::abs(piece[i]));
    }
  }
  std::printf("read by pieces: %.1f s, largest sample %.3g V, peak memory %.0f MB\n", seconds() - begin,
              largest, peak_megabytes());
  begin = seconds();
  for (std::size_t s = 0; s < session.info().trials[0].signals.size(); ++s)
    largest = std::max(largest, session.signal(0, s).samples.back());
  std::printf("read by signals: %.1f s, peak memory %.0f MB\n", seconds() - begin, peak_megabytes());
  return peak_megabytes() < 300.0 ? 0 : 1;
}
