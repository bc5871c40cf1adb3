#include "runner_fake_stages.hpp"

#include <chrono>
#include <cmath>
#include <fstream>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "data/model/parallel.hpp"

namespace brachium::pipelines::tests {
namespace {

InputSpec signals_port(const std::string& name) {
  return {name, PortType::signals, "any signals", false, false, true};
}

data::TrialInfo bare(const data::TrialInfo& trial) {
  data::TrialInfo info = trial;
  info.signals.clear();
  return info;
}

void source(const StageContext& context, StageOutput& output) {
  const auto count = static_cast<std::size_t>(context.options->integer("count"));
  output.signals->begin({"nobody", {}, {}, {}});
  for (const std::string& name : context.options->texts("names")) {
    data::TrialInfo trial;
    trial.name = name;
    output.signals->begin_trial(trial);
    data::Signal signal{{"x", data::Quantity::other, "1", 100.0, 0.0, count, "", "", {}},
                        std::vector<double>(count)};
    std::iota(signal.samples.begin(), signal.samples.end(),
              context.options->number("value") + static_cast<double>(name.front()));
    output.signals->write(name, signal);
  }
}

void scale(const StageContext& context, StageOutput& output) {
  const StageData& in = context.input("signal");
  output.signals->begin(in.signals->info());
  for (const std::string& name : context.trials)
    output.signals->begin_trial(bare(in.signals->info().trials[in.signals->info().trial_index(name)]));
  std::vector<double> means(context.trials.size());
  data::parallel_for(context.trials.size(), context.threads, [&](std::size_t t) {
    data::Signal signal = in.signals->signal(context.trials[t], "x");
    for (double& v : signal.samples) v = std::sin(v) * context.options->number("factor");
    means[t] = std::accumulate(signal.samples.begin(), signal.samples.end(), 0.0) /
               static_cast<double>(signal.samples.size());
    output.signals->write(context.trials[t], signal);
    context.progress(1.0, context.trials[t]);
  });
  output.tables["means"] = {"Means", {{"trial", "", context.trials}, {"mean", "1", means}}};
  output.warn("fake-warning", "this is only a test");
}

void sum(const StageContext& context, StageOutput& output) {
  double total = 0.0;
  for (const StageData* part : context.inputs.at("parts")) {
    for (const double mean : part->tables.at("means").numbers("mean")) total += mean;
  }
  output.tables["total"] = {
      "Total", {{"what", "", std::vector<std::string>{"all"}}, {"sum", "1", std::vector<double>{total}}}};
  output.attributes["verdict"] = "the sum is there";
}

void fit(const StageContext& context, StageOutput& output) {
  data::Subject subject;
  subject.name = "nobody";
  data::SubjectMuscle muscle;
  muscle.name = muscle.group = "BIC";
  muscle.parameters = {context.options->number("force_N"), 0.1, 0.2, 0.0, 10.0, 0.1, 1.0};
  subject.muscles.push_back(muscle);
  output.subject = subject;
}

void predict(const StageContext& context, StageOutput& output) {
  const double force = context.input("subject").subject->muscle("BIC").parameters.max_isometric_force_N;
  output.tables["forces"] = {"Forces", {{"force", "N", std::vector<double>{force}}}};
}

void fail(const StageContext& context, StageOutput&) {
  const std::string& how = context.options->text("how");
  if (how == "input") throw data::InputError("bad-signal", "the signal `x` is no good", "record it again");
  if (how == "numbers")
    throw data::ConvergenceFailure({"trial `a`", "the step became too small", 7, 0.5, 1e-9, "BIC"});
  throw std::out_of_range("index 7");
}

void slow(const StageContext& context, StageOutput& output) {
  data::TrialInfo trial;
  trial.name = "a";
  output.signals->begin({});
  output.signals->begin_trial(trial);
  const std::size_t count = 100;
  output.signals->begin_signal("a", {"x", data::Quantity::other, "1", 100.0, 0.0, count, "", "", {}});
  for (std::size_t i = 0; i < count; ++i) {
    const double value = 1.0;
    output.signals->write_samples("a", "x", i, std::span(&value, 1));
    context.progress(static_cast<double>(i) / count, "waiting");
    std::this_thread::sleep_for(std::chrono::duration<double>(context.options->number("seconds") / count));
  }
}

OptionSpec number(std::string key, std::string unit, std::optional<OptionValue> fallback) {
  OptionSpec option;
  option.key = std::move(key);
  option.unit = std::move(unit);
  option.doc = "A number for tests.";
  option.fallback = std::move(fallback);
  return option;
}

OptionSpec of_type(OptionType type, std::string key, OptionValue fallback) {
  OptionSpec option = number(std::move(key), "", std::move(fallback));
  option.type = type;
  return option;
}

}  // namespace

Catalogue fake_catalogue() {
  Catalogue catalogue;
  const auto add = [&](std::string name, PortType gives, std::vector<InputSpec> inputs,
                       std::vector<OptionSpec> options,
                       std::function<void(const StageContext&, StageOutput&)> run) {
    StageSpec spec;
    spec.name = std::move(name);
    spec.summary = "a stage for tests";
    spec.doc = "Nothing of use.";
    spec.inputs = std::move(inputs);
    spec.options = std::move(options);
    spec.output = gives;
    spec.run = std::move(run);
    catalogue.add(std::move(spec));
  };
  OptionSpec factor = number("factor", "1", 2.0);
  factor.lower = 0.0;
  factor.upper = 100.0;
  OptionSpec lowpass = number("lowpass_hz", "Hz", 6.0);
  lowpass.lower = 0.0;
  lowpass.lower_open = true;
  OptionSpec mode = of_type(OptionType::text, "mode", std::string("plain"));
  mode.allowed = {"plain", "fancy"};
  OptionSpec bounds = of_type(OptionType::tables, "bounds", std::vector<Options>{});
  bounds.fields = {number("upper", "1", std::nullopt), number("lower", "1", 0.0)};
  add("fake.source", PortType::signals, {},
      {number("value", "1", std::nullopt), of_type(OptionType::integer, "count", std::int64_t{50}),
       of_type(OptionType::texts, "names", std::vector<std::string>{"a", "b", "c"})},
      source);
  add("fake.scale", PortType::signals, {signals_port("signal")}, {factor, lowpass, mode, bounds}, scale);
  add("fake.sum", PortType::tables,
      {{"parts", PortType::tables, "stages with a table of means", false, true, false}}, {}, sum);
  add("fake.fit", PortType::subject, {signals_port("signal")}, {number("force_N", "N", 500.0)}, fit);
  add("fake.predict", PortType::tables,
      {signals_port("signal"), {"subject", PortType::subject, "a subject", false, false, false}}, {},
      predict);
  add("fake.fail", PortType::signals, {signals_port("signal")},
      {of_type(OptionType::text, "how", std::string("input"))}, fail);
  add("fake.slow", PortType::signals, {}, {number("seconds", "s", 20.0)}, slow);
  return catalogue;
}

void write_file(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

std::string file_text(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

Study::Study(std::filesystem::path where) : folder(std::move(where)) {
  request.definition = folder / "study.toml";
  request.out = folder / "run";
}

RunResult Study::run(const std::vector<std::string>& settings) {
  request.settings = settings;
  watcher = {};
  return run_pipeline(fake_catalogue(), request, watcher);
}

}  // namespace brachium::pipelines::tests
