/// twin.session: a synthetic session whose truth is known.

#include <fmt/format.h>

#include <numbers>

#include "optimise/twin.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/model_options.hpp"

namespace brachium::pipelines {
namespace {

constexpr double rad_per_deg = std::numbers::pi / 180.0;

optimise::TwinOptions twin_options(const Options& o) {
  optimise::TwinOptions t;
  t.seed = static_cast<std::uint64_t>(o.integer("seed"));
  for (const Options& row : o.tables("trial")) {
    optimise::TwinTrial trial;
    trial.name = row.text("name");
    trial.programme = optimise::parse_programme(row.text("programme"));
    trial.kind = data::parse_trial_kind(row.text("kind"));
    trial.duration_s = row.number("duration_s");
    trial.lower_rad = row.number("lower_deg") * rad_per_deg;
    trial.upper_rad = row.number("upper_deg") * rad_per_deg;
    trial.effort = row.number("effort");
    trial.cycle_s = row.number("cycle_s");
    trial.load_mass_kg = row.number("load_mass_kg");
    t.trials.push_back(trial);
  }
  t.motion_rate_hz = o.number("motion_rate_hz");
  t.excitation_rate_hz = o.number("excitation_rate_hz");
  t.cocontraction = o.number("cocontraction");
  t.independence = o.number("independence");
  t.emg.rate_hz = o.number("emg_rate_hz");
  t.emg.snr_db = o.maybe_number("snr_db");
  t.emg.hum_hz = o.number("hum_hz");
  t.emg.hum_V = o.number("hum_V");
  t.emg.ecg_V = o.number("ecg_V");
  t.emg.motion_V = o.number("motion_V");
  t.emg.offset_V = o.number("offset_V");
  t.emg.drift_V_per_s = o.number("drift_V_per_s");
  t.emg.clip_V = o.number("clip_V");
  t.emg.dropouts_per_minute = o.number("dropouts_per_minute");
  t.moment_noise_sd_N_m = o.number("moment_noise_sd_N_m");
  t.raw_emg = o.boolean("raw_emg");
  t.dynamometer = o.boolean("dynamometer");
  t.model = model_choice(o);
  return t;
}

void run(const StageContext& context, StageOutput& out) {
  const data::Scene& scene = context.need_scene();
  const optimise::Twin twin = optimise::make_twin(scene, twin_options(*context.options));
  data::store(context.options->text("content") == "truth" ? twin.truth : twin.recordings, *out.signals);
  TableBuilder truth("true parameters");
  truth.text("muscle")
      .number("max_isometric_force_N", "N")
      .number("strength", "1")
      .number("optimal_fibre_length_m", "m")
      .number("tendon_slack_length_m", "m")
      .number("delay_s", "s")
      .number("time_constant_1_s", "s")
      .number("time_constant_2_s", "s")
      .number("shape", "1");
  for (const data::SubjectMuscle& m : twin.subject.muscles) {
    truth.row({m.name, m.parameters.max_isometric_force_N, m.parameters.strength,
               m.parameters.optimal_fibre_length_m, m.parameters.tendon_slack_length_m, m.activation.delay_s,
               m.activation.time_constant_1_s, m.activation.time_constant_2_s, m.activation.shape});
  }
  out.tables["truth"] = truth.take();
  out.note(
      "synthetic",
      fmt::format(
          "these recordings are synthetic (seed {}): their truth is known, and they say nothing of a person",
          context.options->integer("seed")));
}

void fill(const ReportContext& context, report::Section& section) {
  section.blocks.push_back(report::Paragraph{"Synthetic recordings: every parameter behind them is known."});
  section.title += ": synthetic recordings";
  report::GridOptions grid;
  grid.names = {{"max_isometric_force_N", "max. force"},
                {"optimal_fibre_length_m", "optimal fibre length"},
                {"tendon_slack_length_m", "slack length"},
                {"delay_s", "delay"},
                {"time_constant_1_s", "τ1"},
                {"time_constant_2_s", "τ2"}};
  grid.decimals = {{"max_isometric_force_N", 1}, {"optimal_fibre_length_m", 4},
                   {"tendon_slack_length_m", 4}, {"delay_s", 3},
                   {"time_constant_1_s", 3},     {"time_constant_2_s", 3}};
  section.blocks.push_back(report::make_grid(context.output->tables.at("truth"), grid));
  std::vector<std::string> trials;
  for (const data::TrialInfo& trial : context.output->signals->info().trials) trials.push_back(trial.name);
  section.blocks.push_back(
      trial_plots(*context.output->signals, trials, data::Quantity::joint_angle, "joint angle", "deg"));
}

OptionSpec trial_option() {
  OptionSpec trial;
  trial.key = "trial";
  trial.type = OptionType::tables;
  trial.doc = "the protocol, one [[stage.trial]] each; empty: a protocol that shows most parameters";
  const optimise::TwinTrial d;
  OptionSpec name = text_option("name", "", "name of the trial");
  name.fallback.reset();
  trial.fields = {name,
                  choice_option("programme", "random",
                                {"mvc", "isometric_ramp", "isometric_hold", "curl", "isokinetic",
                                 "passive_sweep", "random"},
                                "what is done"),
                  choice_option("kind", "calibration", {"mvc", "calibration", "test", "passive", "rest"},
                                "what it is recorded for"),
                  number_option("duration_s", "s", d.duration_s, above(0), "length"),
                  number_option("lower_deg", "deg", d.lower_rad / rad_per_deg, {},
                                "lowest angle, or the angle of isometric trials"),
                  number_option("upper_deg", "deg", d.upper_rad / rad_per_deg, {}, "highest angle"),
                  number_option("effort", "", d.effort, between(0, 1), "largest excitation aimed at"),
                  number_option("cycle_s", "s", d.cycle_s, above(0), "length of one repetition"),
                  number_option("load_mass_kg", "kg", d.load_mass_kg, at_least(0),
                                "held mass, kept as the trial's condition")};
  trial.fallback = std::vector<Options>{};
  return trial;
}

}  // namespace

void add_session_stages(Catalogue& catalogue) {
  const optimise::TwinOptions d;
  StageSpec spec;
  spec.name = "twin.session";
  spec.summary = "a synthetic session whose truth is known: raw EMG, motion, moment";
  spec.doc =
      "Generates recordings from the scene: trial programmes give angle and effort, efforts become channel "
      "excitations, these go through activation dynamics and the muscle model to the joint "
      "moment. Raw EMG is band-limited noise whose amplitude follows the excitation (Hogan & Mann 1980, "
      "doi:10.1109/TBME.1980.326652; spectrum after Shwedyk et al. 1977, "
      "doi:10.1109/TBME.1977.326175), to which sensor noise, line hum, ECG, motion artefact, clipping and "
      "dropouts are added as asked. The same seed gives the same session on every machine. "
      "With `content = \"truth\"` the stage gives what no recorder sees: true excitations, activations and "
      "forces.\n"
      "It feeds tests, the demo and studies; with `dynamometer = true` also the signals of a dynamometer, "
      "for want of a public recording that has both.";
  spec.needs_scene = true;
  spec.options = {
      choice_option("content", "recordings", {"recordings", "truth"},
                    "what a recorder keeps, or what nobody can record"),
      integer_option("seed", 1, at_least(0), "of all random numbers"),
      trial_option(),
      number_option("motion_rate_hz", "Hz", d.motion_rate_hz, above(0), "rate of angle, velocity and moment"),
      number_option("excitation_rate_hz", "Hz", d.excitation_rate_hz, above(0),
                    "rate of the true excitations"),
      number_option("emg_rate_hz", "Hz", d.emg.rate_hz, above(0), "rate of the raw EMG"),
      number_option("cocontraction", "", d.cocontraction, between(0, 1),
                    "excitation of antagonists as a share of the agonists'"),
      number_option("independence", "", d.independence, between(0, 1),
                    "share of each channel's excitation that others do not follow"),
      optional_number("snr_db", "dB", {},
                      "clean EMG at excitation 1 against sensor noise; absent: no sensor noise"),
      number_option("hum_hz", "Hz", d.emg.hum_hz, above(0), "line frequency"),
      number_option("hum_V", "V", d.emg.hum_V, at_least(0), "amplitude of the line hum"),
      number_option("ecg_V", "V", d.emg.ecg_V, at_least(0), "height of the R wave at the electrodes"),
      number_option("motion_V", "V", d.emg.motion_V, at_least(0), "standard deviation of motion artefact"),
      number_option("offset_V", "V", d.emg.offset_V, {}, "offset"),
      number_option("drift_V_per_s", "V/s", d.emg.drift_V_per_s, {}, "drift"),
      number_option("clip_V", "V", d.emg.clip_V, at_least(0), "amplifier's range; 0: no clipping"),
      number_option("dropouts_per_minute", "", d.emg.dropouts_per_minute, at_least(0),
                    "expected number of dropouts"),
      number_option("moment_noise_sd_N_m", "N m", d.moment_noise_sd_N_m, at_least(0),
                    "noise of the reference moment"),
      flag_option("raw_emg", d.raw_emg,
                  "false: motion and moment only, without raw EMG; true excitations are part of `content = "
                  "\"truth\"`"),
      flag_option("dynamometer", d.dynamometer,
                  "also the machine's torque, angle and velocity, gravity included")};
  for (OptionSpec& o : muscle_option_specs()) spec.options.push_back(std::move(o));
  for (OptionSpec& o : activation_option_specs()) spec.options.push_back(std::move(o));
  spec.run = run;
  spec.report = fill;
  spec.methods = [](const ReportContext&) {
    return std::string("The recordings are synthetic (a twin with known parameters), made by Brachium.");
  };
  catalogue.add(std::move(spec));
}

}  // namespace brachium::pipelines
