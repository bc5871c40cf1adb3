/// emg.activation: excitations of channels to activations of muscles.

#include <fmt/format.h>

#include <algorithm>
#include <atomic>

#include "data/limb/drive.hpp"
#include "data/model/parallel.hpp"
#include "emg/activation.hpp"
#include "optimise/model_choice.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/emg_common.hpp"
#include "pipelines/stages/model_options.hpp"

namespace brachium::pipelines {
namespace {

/// sum += weight * gain * samples, read in pieces: a long recording's channels never stand in memory together.
void add_channel(const data::SessionSource& source, std::size_t trial, const ExcitationChannel& channel,
                 double weight, std::vector<double>& sum) {
  std::vector<double> piece(std::min<std::size_t>(sum.size(), std::size_t{1} << 16));
  for (std::size_t first = 0; first < sum.size(); first += piece.size()) {
    piece.resize(std::min(piece.size(), sum.size() - first));
    source.read(trial, channel.signal, first, piece);
    for (std::size_t k = 0; k < piece.size(); ++k) sum[first + k] += weight * (channel.gain * piece[k]);
  }
}

void run(const StageContext& context, StageOutput& out) {
  const data::Scene& scene = context.need_scene();
  const StageData& input = context.input("excitation");
  const StageData* with = context.maybe_input("subject");
  const data::Subject* subject = with ? &subject_of(*with) : nullptr;
  const optimise::ModelChoice model =
      subject ? optimise::ModelChoice::from_map(subject->model) : activation_choice(*context.options);

  begin_output(context, input, out);
  struct Count {
    std::string trial, muscle;
    std::size_t samples;
    double maximum;
  };
  std::vector<std::vector<Count>> above(context.trials.size());
  std::vector<std::vector<std::string>> undriven(context.trials.size());
  std::atomic<std::size_t> done{0};
  data::parallel_for(context.trials.size(), context.threads, [&](std::size_t i) {
    const std::size_t t = trial_index(input, context.trials[i]);
    const data::TrialInfo& trial = input.signals->info().trials[t];
    const std::vector<ExcitationChannel> channels = excitation_channels(input, context.trials[i], subject);
    std::vector<std::string> names;
    for (const ExcitationChannel& c : channels) names.push_back(c.info.name);
    const limb::DriveMap drive = limb::drive_map(scene, names);
    undriven[i] = drive.undriven;
    const data::SignalInfo& grid = channels.front().info;
    std::vector<double> mixed(grid.count), activation(grid.count);
    for (std::size_t m = 0; m < scene.muscles.size(); ++m) {
      const data::SceneMuscle& muscle = scene.muscles[m];
      const data::ActivationParameters& parameters =
          subject ? subject->muscle(muscle.name).activation : muscle.activation;
      std::fill(mixed.begin(), mixed.end(), 0.0);
      for (std::size_t c = 0; c < drive.channels.size(); ++c) {
        const double weight = drive.weights(static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(c));
        if (weight == 0.0) continue;
        const auto channel = std::ranges::find(
            channels, drive.channels[c], [](const ExcitationChannel& known) { return known.info.name; });
        add_channel(*input.signals, t, *channel, weight, mixed);
      }
      emg::check_parameters(model.activation, parameters, muscle.name);
      emg::activate(model.activation, parameters, mixed, grid.rate_hz, activation);
      data::SignalInfo info = grid;
      info.name = muscle.name;
      info.muscle = muscle.name;
      info.quantity = data::Quantity::activation;
      info.unit = "1";
      info.attributes = {{"activation_form", optimise::to_string(model.activation.form)},
                         {"delay_s", fmt::format("{:.6g}", parameters.delay_s)},
                         {"time_constant_1_s", fmt::format("{:.6g}", parameters.time_constant_1_s)},
                         {"time_constant_2_s", fmt::format("{:.6g}", parameters.time_constant_2_s)},
                         {"shape", fmt::format("{:.6g}", parameters.shape)}};
      const auto outside = static_cast<std::size_t>(
          std::count_if(activation.begin(), activation.end(), [](double a) { return a > 1.0; }));
      if (outside > 0)
        above[i].push_back(
            {trial.name, muscle.name, outside, *std::max_element(activation.begin(), activation.end())});
      out.signals->begin_signal(trial.name, info);
      out.signals->write_samples(trial.name, info.name, 0, activation);
    }
    if (context.progress)
      context.progress(static_cast<double>(++done) / static_cast<double>(context.trials.size()), trial.name);
  });

  TableBuilder table("activation above 1");
  table.text("trial").text("muscle").number("samples", "1").number("maximum", "1");
  for (const auto& trial : above) {
    for (const Count& c : trial) table.row({c.trial, c.muscle, static_cast<double>(c.samples), c.maximum});
  }
  data::Table counted = table.take();
  if (counted.rows() > 0) {
    out.warn("activation-above-one", fmt::format("{} muscle trials have activations above 1", counted.rows()),
             "the recorded effort exceeds what an activation of 1 stands for; see the table `above_one` of "
             "this stage");
    out.tables["above_one"] = std::move(counted);
  }
  if (!undriven.empty()) {
    for (const std::string& muscle : undriven.front())
      out.note("undriven-muscle", fmt::format("muscle `{}` has no excitation: it is passive", muscle));
  }
}

void fill(const ReportContext& context, report::Section& section) {
  std::vector<std::string> trials;
  for (const data::TrialInfo& trial : context.output->signals->info().trials) trials.push_back(trial.name);
  section.title += ": muscle activations";
  section.blocks.push_back(
      trial_plots(*context.output->signals, trials, data::Quantity::activation, "activation"));
  if (context.output->tables.contains("above_one"))
    section.blocks.push_back(report::make_grid(context.output->tables.at("above_one")));
}

std::string methods(const ReportContext& context) {
  const auto subject = context.inputs.find("subject");
  const bool calibrated = subject != context.inputs.end() && !subject->second.empty();
  const data::Subject* s = calibrated ? &subject_of(*subject->second.front()) : nullptr;
  const optimise::ModelChoice model =
      s ? optimise::ModelChoice::from_map(s->model) : activation_choice(*context.options);
  std::string text = "Excitations became activations through ";
  if (model.activation.form == emg::ActivationForm::first_order) {
    text += "first-order dynamics with an electromechanical delay (Thelen 2003, doi:10.1115/1.1531112)";
  } else {
    text +=
        "second-order dynamics with an electromechanical delay (Lloyd & Besier 2003, "
        "doi:10.1016/S0021-9290(03)00010-1; Buchanan et al. 2004, doi:10.1123/jab.20.4.367), ";
    text += model.activation.form == emg::ActivationForm::recursive
                ? "as the recursive filter of that source"
                : "discretised exactly so that the result does not depend on the sampling rate";
  }
  if (model.activation.nonlinearity == emg::Nonlinearity::exponential)
    text += ", and an exponential nonlinearity";
  if (model.activation.nonlinearity == emg::Nonlinearity::piecewise)
    text +=
        ", and a static nonlinearity in two pieces (Manal & Buchanan 2003, "
        "doi:10.1016/S0021-9290(03)00152-0)";
  return text +
         (calibrated ? ", with the calibrated subject's parameters." : ", with the scene's parameters.");
}

}  // namespace

void add_emg_activation(Catalogue& catalogue) {
  StageSpec spec;
  spec.name = "emg.activation";
  spec.summary = "excitations to muscle activations: delay, second-order dynamics, nonlinearity";
  spec.doc =
      "Mixes channels into muscles' excitations as the scene says, and runs each through a delay, "
      "second-order dynamics and a nonlinearity. With a "
      "`subject` its parameters, gains and model choices are used (the options below are then not), "
      "otherwise the scene's parameters.\n"
      "Sources: Lloyd & Besier 2003, doi:10.1016/S0021-9290(03)00010-1; Manal & Buchanan 2003, "
      "doi:10.1016/S0021-9290(03)00152-0; Thelen 2003, "
      "doi:10.1115/1.1531112 (first_order).";
  spec.needs_scene = true;
  spec.inputs = {{"excitation", PortType::signals, "normalised envelopes (emg.envelope)"},
                 {"subject", PortType::subject, "calibrated subject", true}};
  spec.options = activation_option_specs();
  spec.run = run;
  spec.report = fill;
  spec.methods = methods;
  catalogue.add(std::move(spec));
}

}  // namespace brachium::pipelines
