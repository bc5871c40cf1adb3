/// limb.kinematics: recorded joint angles, smoothed, with velocity and acceleration.

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <numbers>

#include "data/limb/smoothing.hpp"
#include "data/model/parallel.hpp"
#include "data/model/resample.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/limb_common.hpp"

namespace brachium::pipelines {

data::Signal recorded_angle(const StageData& input, const std::string& trial,
                            const data::Coordinate& coordinate) {
  const std::size_t t = trial_index(input, trial);
  const data::TrialInfo& info = input.signals->info().trials[t];
  const std::string& name = coordinate.angle_signal.empty() ? coordinate.name : coordinate.angle_signal;
  if (info.has_signal(name)) {
    data::Signal signal = input.signals->signal(t, info.signal_index(name));
    if (signal.info.quantity != data::Quantity::joint_angle) {
      throw data::InputError(
          "wrong-quantity",
          fmt::format("signal `{}` of trial `{}` is meant as the angle of `{}`, but it is {} [{}]", name,
                      trial, coordinate.name, data::to_string(signal.info.quantity), signal.info.unit),
          "set quantity = \"joint_angle\" in the session description, or `angle_signal` in the scene");
    }
    return signal;
  }
  return signal_of(input, trial, data::Quantity::joint_angle, coordinate.name);
}

data::Signal make_signal(const data::TimeGrid& grid, const std::string& name, data::Quantity quantity,
                         const std::string& unit, const std::string& coordinate,
                         const Eigen::VectorXd& values) {
  data::Signal signal;
  signal.info.name = name;
  signal.info.quantity = quantity;
  signal.info.unit = unit;
  signal.info.coordinate = coordinate;
  signal.info.rate_hz = grid.rate_hz;
  signal.info.start_time_s = grid.start_s;
  signal.info.count = static_cast<std::size_t>(values.size());
  signal.samples.assign(values.data(), values.data() + values.size());
  return signal;
}

namespace {

data::Signal like(const data::Signal& angle, const std::string& name, data::Quantity quantity,
                  const std::string& unit, const data::Coordinate& coordinate, std::vector<double> samples) {
  data::Signal signal{angle.info, std::move(samples)};
  signal.info.name = name;
  signal.info.quantity = quantity;
  signal.info.unit = unit;
  signal.info.coordinate = coordinate.name;
  signal.info.count = signal.samples.size();
  return signal;
}

void run(const StageContext& context, StageOutput& out) {
  const data::Scene& scene = context.need_scene();
  const StageData& input = context.input("signals");
  const double cutoff = context.options->number("lowpass_hz");
  const double rate = context.options->number("output_rate_hz");
  const double offset = context.options->number("angle_offset_deg") * std::numbers::pi / 180.0;
  begin_output(context, input, out);
  struct Row {
    std::string coordinate;
    double lowest, highest, fastest;
  };
  std::vector<std::vector<Row>> rows(context.trials.size());
  std::atomic<std::size_t> done{0};
  data::parallel_for(context.trials.size(), context.threads, [&](std::size_t i) {
    const std::string& trial = context.trials[i];
    for (const data::Coordinate& coordinate : scene.coordinates) {
      data::Signal angle = recorded_angle(input, trial, coordinate);
      for (double& q : angle.samples) q += offset;
      if (cutoff > 0.0) {
        angle.samples = limb::smooth(angle.samples, {cutoff, angle.info.rate_hz},
                                     fmt::format("joint angle `{}` of trial `{}`", angle.info.name, trial));
        angle.info.attributes["smoothing"] =
            fmt::format("Butterworth low-pass, effective order 4, zero lag, -3 dB at {:g} Hz", cutoff);
      }
      if (offset != 0.0)
        angle.info.attributes["angle_offset"] =
            fmt::format("{:g} deg added", context.options->number("angle_offset_deg"));
      if (rate > 0.0 && rate != angle.info.rate_hz) {
        const data::TimeGrid grid = data::common_grid(std::span(&angle.info, 1), rate);
        angle = data::resample(angle, grid);
      }
      const std::vector<double> velocity = limb::derivative(angle.samples, angle.info.rate_hz);
      const std::vector<double> acceleration = limb::derivative(velocity, angle.info.rate_hz);
      const auto [low, high] = std::minmax_element(angle.samples.begin(), angle.samples.end());
      double fastest = 0.0;
      for (const double v : velocity) fastest = std::max(fastest, std::abs(v));
      if (*low < coordinate.lower_rad || *high > coordinate.upper_rad) {
        const double deg = 180.0 / std::numbers::pi;
        throw data::InputError("angle-out-of-range",
                               fmt::format("`{}` of trial `{}` goes from {:.1f} to {:.1f} deg; the scene's "
                                           "geometry holds from {:.1f} to {:.1f} deg",
                                           coordinate.name, trial, *low * deg, *high * deg,
                                           coordinate.lower_rad * deg, coordinate.upper_rad * deg),
                               "widen `range_deg` with geometry that is valid there, check the angle's zero, "
                               "or leave the trial out");
      }
      rows[i].push_back({coordinate.name, *low, *high, fastest});
      out.signals->write(
          trial, like(angle, coordinate.name, data::Quantity::joint_angle, "rad", coordinate, angle.samples));
      out.signals->write(trial, like(angle, coordinate.name + "_velocity", data::Quantity::joint_velocity,
                                     "rad/s", coordinate, velocity));
      out.signals->write(
          trial, like(angle, coordinate.name + "_acceleration", data::Quantity::joint_acceleration, "rad/s^2",
                      coordinate, acceleration));
    }
    if (context.progress)
      context.progress(static_cast<double>(++done) / static_cast<double>(context.trials.size()), trial);
  });
  TableBuilder table("ranges of motion");
  table.text("trial")
      .text("coordinate")
      .number("lowest_rad", "rad")
      .number("highest_rad", "rad")
      .number("fastest_rad_s", "rad/s");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const Row& r : rows[i]) table.row({context.trials[i], r.coordinate, r.lowest, r.highest, r.fastest});
  }
  out.tables["ranges"] = table.take();
}

void fill(const ReportContext& context, report::Section& section) {
  report::GridOptions grid;
  grid.digits = 3;
  grid.units = {{"lowest_rad", "deg"}, {"highest_rad", "deg"}, {"fastest_rad_s", "deg/s"}};
  grid.names = {{"lowest_rad", "lowest"}, {"highest_rad", "highest"}, {"fastest_rad_s", "fastest"}};
  grid.decimals = {{"lowest_rad", 1}, {"highest_rad", 1}, {"fastest_rad_s", 0}};
  section.title += ": joint angles";
  section.blocks.emplace_back(report::make_grid(context.output->tables.at("ranges"), grid));
  std::vector<std::string> trials;
  for (const data::TrialInfo& trial : context.output->signals->info().trials) trials.push_back(trial.name);
  section.blocks.push_back(
      trial_plots(*context.output->signals, trials, data::Quantity::joint_angle, "joint angle", "deg"));
}

std::string methods(const ReportContext& context) {
  const double cutoff = context.options->number("lowpass_hz");
  return cutoff > 0.0 ? fmt::format(
                            "Joint angles were low-pass filtered at {:g} Hz (Butterworth, effective order 4, "
                            "no lag; Winter 2009, doi:10.1002/9780470549148) and differentiated by central "
                            "differences of fourth order.",
                            cutoff)
                      : std::string(
                            "Joint angles were used as recorded and differentiated by central differences of "
                            "fourth order.");
}

}  // namespace

void add_limb_kinematics(Catalogue& catalogue) {
  StageSpec spec;
  spec.name = "limb.kinematics";
  spec.summary = "joint angle, velocity and acceleration from the recorded angle";
  spec.doc =
      "Smooths the recorded angle of every coordinate of the scene without lag (Winter 2009; Robertson & "
      "Dowling 2003, doi:10.1016/S1050-6411(03)00080-4), differentiates it, and checks it "
      "against the range in which the scene's geometry holds. An angle outside that range is an error, not "
      "an extrapolation.";
  spec.needs_scene = true;
  spec.inputs = {{"signals", PortType::signals, "recordings with a joint angle", false, false, true}};
  spec.options = {
      number_option("lowpass_hz", "Hz", 6.0, at_least(0), "low-pass of the angle; 0: none"),
      number_option("output_rate_hz", "Hz", 0.0, at_least(0), "rate of the result; 0: the recording's"),
      number_option("angle_offset_deg", "deg", 0.0, {},
                    "added to the recorded angle, where the recorder's zero is not the straight arm")};
  spec.run = run;
  spec.report = fill;
  spec.methods = methods;
  catalogue.add(std::move(spec));
}

void add_limb_stages(Catalogue& catalogue) {
  add_limb_kinematics(catalogue);
  add_limb_inverse_dynamics(catalogue);
  add_limb_dynamometer(catalogue);
}

}  // namespace brachium::pipelines
