/// Peak memory of the stages from raw EMG to the elbow's moment on a long recording, through the command line.
///
///   stage_memory_bench BRACHIUM SCENE FOLDER [MINUTES = 60] [CHANNELS = 16] [RATE_HZ = 2000]
///
/// SCENE is pipelines/scenes/elbow.toml, whose three electrodes are the first three channels. Writes FOLDER/long.h5
/// (noise that comes and goes and a moving elbow; about 0.9 GB for an hour) unless it is there, runs the stages on it
/// one by one, each a process of its own, then all of them with the report, and prints the peak memory of each.
/// Fails when one exceeds 300 MB.

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "data/io/session_file.hpp"
#include "emg/random.hpp"

using namespace brachium;

namespace {

constexpr double limit_megabytes = 300.0;
constexpr const char* electrodes[] = {"biceps", "brachioradialis", "triceps_lateral"};

void write_recording(const std::filesystem::path& file, double minutes, int channels, double rate_hz) {
  io::SessionFileWriter writer(file);
  data::SessionInfo session;
  session.subject = "long";
  data::TrialInfo trial;
  trial.name = "long";
  writer.begin(session);
  writer.begin_trial(trial);
  emg::Random random(1);
  std::vector<double> piece(std::size_t{1} << 16);
  for (int c = 0; c < channels; ++c) {
    data::SignalInfo info;
    info.name = c < 3 ? electrodes[c] : fmt::format("emg{}", c + 1);
    info.quantity = data::Quantity::emg;
    info.unit = "V";
    info.rate_hz = rate_hz;
    info.count = static_cast<std::size_t>(minutes * 60.0 * rate_hz);
    writer.begin_signal("long", info);
    double before = 0.0;
    for (std::size_t first = 0; first < info.count; first += piece.size()) {
      const std::size_t n = std::min(piece.size(), info.count - first);
      for (std::size_t i = 0; i < n; ++i) {
        const double t = static_cast<double>(first + i) / rate_hz;
        const double level =
            std::pow(std::sin(std::numbers::pi * t / (10.0 + c)), 2) + 0.01;  // bursts of some seconds
        before = 0.6 * before + 1e-4 * random.normal();  // most of the power below 150 Hz
        piece[i] = level * before;
      }
      writer.write_samples("long", info.name, first, std::span(piece).first(n));
    }
  }
  data::SignalInfo angle;
  angle.name = angle.coordinate = "elbow_flexion";
  angle.quantity = data::Quantity::joint_angle;
  angle.unit = "rad";
  angle.rate_hz = 100.0;
  angle.count = static_cast<std::size_t>(minutes * 60.0 * angle.rate_hz);
  std::vector<double> angles(angle.count);
  for (std::size_t i = 0; i < angle.count; ++i)
    angles[i] = 1.2 - 0.8 * std::cos(std::numbers::pi * static_cast<double>(i) / angle.rate_hz / 3.0);
  writer.begin_signal("long", angle);
  writer.write_samples("long", angle.name, 0, angles);
  writer.commit();
}

struct Usage {
  bool good = false;
  double seconds = 0.0, megabytes = 0.0;
};

Usage run(const std::vector<std::string>& command) {
  const pid_t child = fork();
  if (child == 0) {
    std::vector<char*> arguments;
    for (const std::string& a : command) arguments.push_back(const_cast<char*>(a.c_str()));
    arguments.push_back(nullptr);
    execv(arguments.front(), arguments.data());
    _exit(127);
  }
  int status = 0;
  rusage used{};
  wait4(child, &status, 0, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return {WIFEXITED(status) && WEXITSTATUS(status) == 0, seconds(used.ru_utime) + seconds(used.ru_stime),
          static_cast<double>(used.ru_maxrss) / 1024.0};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::puts("stage_memory_bench BRACHIUM SCENE FOLDER [MINUTES] [CHANNELS] [RATE_HZ]");
    return 2;
  }
  const std::filesystem::path folder = argv[3];
  if (!std::filesystem::exists(folder / "long.h5")) {
    write_recording(folder / "long.h5", argc > 4 ? std::atof(argv[4]) : 60.0,
                    argc > 5 ? std::atoi(argv[5]) : 16, argc > 6 ? std::atof(argv[6]) : 2000.0);
  }
  const std::filesystem::path definition = folder / "long_stages.toml", out = folder / "long_run";
  std::ofstream(definition)
      << "[pipeline]\ntitle = \"A long recording\"\nsession = \"long.h5\"\nscene = \""
      << std::filesystem::absolute(argv[2]).string()
      << "\"\n"
         "[[stage]]\nname = \"quality\"\nrun = \"emg.quality\"\non_bad = \"warn\"\n"
         "[[stage]]\nname = \"excitation\"\nrun = \"emg.envelope\"\nnormalise = \"trials_maximum\"\n"
         "[[stage]]\nname = \"onset\"\nrun = \"emg.onset\"\n"
         "[[stage]]\nname = \"activation\"\nrun = \"emg.activation\"\ninput = { excitation = \"excitation\" "
         "}\n"
         "[[stage]]\nname = \"kinematics\"\nrun = \"limb.kinematics\"\n"
         "[[stage]]\nname = \"moment\"\nrun = \"hill.moment\"\n"
         "input = { activation = \"activation\", kinematics = \"kinematics\" }\n";
  std::filesystem::remove_all(out);
  bool good = true;
  const auto show = [&good](const std::string& what, const std::vector<std::string>& command) {
    const Usage u = run(command);
    good = good && u.good && u.megabytes < limit_megabytes;
    std::printf("%-40s %6.1f s CPU, peak memory %4.0f MB%s\n", what.c_str(), u.seconds, u.megabytes,
                !u.good                         ? ", FAILED"
                : u.megabytes < limit_megabytes ? ""
                                                : ", ABOVE THE LIMIT");
    std::fflush(stdout);
  };
  const std::vector<std::string> base{argv[1], "run", definition.string(), "--out", out.string(), "--quiet"};
  for (const std::string stage : {"quality", "excitation", "onset", "activation", "kinematics", "moment"}) {
    std::vector<std::string> command = base;
    command.insert(command.end(), {"--only", stage});
    show("--only " + stage, command);
  }
  std::filesystem::remove_all(out);
  show("all stages and the report", base);
  std::filesystem::remove_all(out);
  return good ? 0 : 1;
}
