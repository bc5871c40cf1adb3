#include "pipelines/stages/compare_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <sstream>

#include "data/model/resample.hpp"
#include "optimise/metrics.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/model_options.hpp"
#include "pipelines/stages/moment_frames.hpp"

namespace brachium::pipelines {
namespace {

using data::Quantity;
constexpr double degree = std::numbers::pi / 180.0;

std::vector<std::string> words(const std::string& list) {
  std::vector<std::string> out;
  std::istringstream in(list);
  for (std::string word; std::getline(in, word, ',');) out.push_back(word);
  return out;
}

/// A frame's value of a mask between its samples: in use only where both neighbours are.
std::vector<bool> mask_at(const StageData& model, const std::string& trial,
                          const std::vector<double>& time_s) {
  const std::size_t t = trial_index(model, trial);
  const data::TrialInfo& info = model.signals->info().trials[t];
  if (!info.has_signal("use")) return {};
  const data::Signal mask = model.signals->signal(t, info.signal_index("use"));
  std::vector<bool> use;
  for (const double time : time_s) {
    const double at = (time - mask.info.start_time_s) * mask.info.rate_hz;
    const auto last = static_cast<double>(mask.samples.size() - 1);
    const auto low = static_cast<std::size_t>(std::clamp(std::floor(at + 1e-6), 0.0, last)),
               high = static_cast<std::size_t>(std::clamp(std::ceil(at - 1e-6), 0.0, last));
    use.push_back(mask.samples[low] > 0.5 && mask.samples[high] > 0.5);
  }
  return use;
}

/// Moment of each muscle whose force and moment arm the model's output has.
void read_muscles(const StageData& model, std::size_t t, CompareFrames& out) {
  const data::TrialInfo& info = model.signals->info().trials[t];
  for (const data::SignalInfo& s : info.signals) {
    if (s.quantity != Quantity::muscle_force || s.muscle.empty()) continue;
    for (std::size_t a = 0; a < info.signals.size(); ++a) {
      if (info.signals[a].quantity != Quantity::moment_arm || info.signals[a].muscle != s.muscle) continue;
      std::vector<double> moment =
          data::evaluate_at(model.signals->signal(t, info.signal_index(s.name)), out.time_s);
      const std::vector<double> arm = data::evaluate_at(model.signals->signal(t, a), out.time_s);
      for (std::size_t i = 0; i < moment.size(); ++i) moment[i] *= arm[i];
      out.muscle_n_m[s.muscle] = std::move(moment);
    }
  }
}

CompareFrames read_frames(const StageContext& context, const StageData& model, const std::string& trial,
                          const std::string& coordinate) {
  const StageData& reference = context.input("reference");
  const data::Signal measured = signal_of(reference, trial, Quantity::joint_moment, coordinate),
                     modelled = signal_of(model, trial, Quantity::joint_moment, coordinate);
  const double edge_s = context.options->number("edge_s");
  double from = std::max(measured.info.start_time_s, modelled.info.start_time_s) + edge_s,
         to = std::min(measured.info.end_time_s(), modelled.info.end_time_s()) - edge_s;
  std::optional<data::Signal> angle;
  if (const StageData* kinematics = context.maybe_input("kinematics")) {
    angle = signal_of(*kinematics, trial, Quantity::joint_angle, coordinate);
    from = std::max(from, angle->info.start_time_s);
    to = std::min(to, angle->info.end_time_s());
  }
  std::vector<data::Signal> activations;
  if (const StageData* activation = context.maybe_input("activation")) {
    const std::size_t t = trial_index(*activation, trial);
    for (const std::size_t s : signals_of(activation->signals->info().trials[t], Quantity::activation)) {
      activations.push_back(activation->signals->signal(t, s));
      from = std::max(from, activations.back().info.start_time_s);
      to = std::min(to, activations.back().info.end_time_s());
    }
  }
  CompareFrames out;
  out.trial = trial;
  const std::vector<bool> use = use_of(reference, trial);
  std::vector<double> time, values;
  for (std::size_t i = 0; i < measured.samples.size(); ++i) {
    const double t = measured.info.time_s(i);
    if (t < from || t > to || (!use.empty() && !use[i])) continue;
    time.push_back(t);
    values.push_back(measured.samples[i]);
  }
  const std::vector<bool> known = mask_at(model, trial, time);
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (!known.empty() && !known[i]) continue;
    out.time_s.push_back(time[i]);
    out.reference_n_m.push_back(values[i]);
  }
  if (out.time_s.size() < 2)
    throw data::InputError(
        "no-common-window",
        fmt::format("reference and `{}` have no common frames in trial `{}`", model.stage, trial),
        "check start times and `edge_s`");
  out.modelled_n_m = data::evaluate_at(modelled, out.time_s);
  const std::size_t t = trial_index(model, trial);
  const data::TrialInfo& info = model.signals->info().trials[t];
  if (const std::string name = passive_moment_name(coordinate); info.has_signal(name))
    out.passive_n_m = data::evaluate_at(model.signals->signal(t, info.signal_index(name)), out.time_s);
  if (angle) out.angle_rad = data::evaluate_at(*angle, out.time_s);
  for (const data::Signal& s : activations) {
    const std::vector<double> a = data::evaluate_at(s, out.time_s);
    out.activation.resize(a.size(), 0.0);
    for (std::size_t i = 0; i < a.size(); ++i)
      out.activation[i] += a[i] / static_cast<double>(activations.size());
  }
  read_muscles(model, t, out);
  return out;
}

using Column = std::function<std::vector<double>(const CompareFrames&)>;

std::vector<std::vector<double>> collect(const std::vector<const CompareFrames*>& trials, const Column& of) {
  std::vector<std::vector<double>> out;
  for (const CompareFrames* f : trials) out.push_back(of(*f));
  return out;
}

double rms(const std::vector<std::vector<double>>& series, double& mean) {
  double sum = 0.0, square = 0.0, count = 0.0;
  for (const auto& s : series) {
    for (const double x : s) sum += x, square += x * x, count += 1.0;
  }
  mean = sum / count;
  return std::sqrt(square / count);
}

/// At the frames of `at`: models may differ in the frames that they know.
std::vector<double> at_frames(const CompareFrames& from, const std::vector<double>& values,
                              const CompareFrames& at, std::vector<bool>& both) {
  std::vector<double> out(at.time_s.size(), 0.0);
  both.assign(at.time_s.size(), false);
  for (std::size_t i = 0, k = 0; i < at.time_s.size(); ++i) {
    while (k < from.time_s.size() && from.time_s[k] < at.time_s[i] - 1e-9) ++k;
    if (k == from.time_s.size() || from.time_s[k] > at.time_s[i] + 1e-9) continue;
    out[i] = values[k];
    both[i] = true;
  }
  return out;
}

/// Figures of `model` against `other` on the frames that both know; std::nullopt where a trial has none.
optimise::Metrics between(const std::vector<const CompareFrames*>& other, const Column& of_other,
                          const std::vector<const CompareFrames*>& model, const Column& of_model) {
  std::vector<std::vector<double>> a, b;
  for (const CompareFrames* m : model) {
    for (const CompareFrames* o : other) {
      if (o->trial != m->trial) continue;
      std::vector<bool> both;
      const std::vector<double> x = at_frames(*o, of_other(*o), *m, both), y = of_model(*m);
      a.emplace_back();
      b.emplace_back();
      for (std::size_t i = 0; i < y.size(); ++i) {
        if (both[i]) a.back().push_back(x[i]), b.back().push_back(y[i]);
      }
    }
  }
  return optimise::pooled_metrics(a, b);
}

/// Keeps the frames that stay.
void thin(CompareFrames& f, const std::vector<bool>& stays) {
  const auto keep = [&](std::vector<double>& values) {
    if (values.empty()) return;
    std::size_t n = 0;
    for (std::size_t i = 0; i < stays.size(); ++i) {
      if (stays[i]) values[n++] = values[i];
    }
    values.resize(n);
  };
  for (std::vector<double>* values :
       {&f.reference_n_m, &f.modelled_n_m, &f.passive_n_m, &f.angle_rad, &f.activation, &f.time_s})
    keep(*values);
  for (auto& [muscle, values] : f.muscle_n_m) keep(values);
}

/// Models are judged on the frames that all of them know.
void to_common_frames(std::vector<CompareModel>& models) {
  for (std::size_t t = 0; t < models.front().trials.size(); ++t) {
    for (CompareModel& a : models) {
      for (const CompareModel& b : models) {
        CompareFrames& f = a.trials[t];
        std::vector<bool> both;
        at_frames(b.trials[t], b.trials[t].time_s, f, both);
        thin(f, both);
        if (f.time_s.size() < 2)
          throw data::InputError(
              "no-common-window",
              fmt::format("`{}` and `{}` have no common frames in trial `{}`", a.name, b.name, f.trial),
              "leave the trial out, or set `common_frames = false`");
      }
    }
  }
}

bool lacking(const CompareModel& model, const std::string& muscle) {
  return std::find(model.lacks.begin(), model.lacks.end(), muscle) != model.lacks.end();
}

const CompareModel* first_lacking(const std::vector<CompareModel>& models) {
  for (const CompareModel& m : models) {
    if (!m.lacks.empty()) return &m;
  }
  return nullptr;
}

}  // namespace

std::vector<const CompareFrames*> CompareModel::judged() const {
  std::vector<const CompareFrames*> unseen, all;
  for (const CompareFrames& f : trials) {
    all.push_back(&f);
    if (!f.seen) unseen.push_back(&f);
  }
  return unseen.empty() ? all : unseen;
}

std::vector<CompareModel> compare_models(const StageContext& context, const std::string& coordinate,
                                         const std::vector<std::string>& learnt) {
  std::vector<CompareModel> models;
  for (const StageData* model : context.inputs.at("models")) {
    CompareModel m;
    m.name = model->stage;
    if (const auto lacks = model->attributes.find("left_out_muscles"); lacks != model->attributes.end())
      m.lacks = words(lacks->second);
    for (const std::string& trial : context.trials) {
      m.trials.push_back(read_frames(context, *model, trial, coordinate));
      m.trials.back().seen = std::find(learnt.begin(), learnt.end(), trial) != learnt.end();
    }
    models.push_back(std::move(m));
  }
  if (context.options->boolean("common_frames")) to_common_frames(models);
  return models;
}

data::Table score_rows(const std::vector<CompareModel>& models) {
  TableBuilder scores("agreement with the reference");
  scores.text("model")
      .text("trial")
      .text("seen_in_calibration")
      .number("frames", "1")
      .number("rmse_N_m", "N m");
  scores.number("nrmse_range", "1").number("r2", "1").number("bias_N_m", "N m").number("largest_N_m", "N m");
  scores.number("lower_limit_N_m", "N m").number("upper_limit_N_m", "N m");
  const auto row = [&](const CompareModel& model, const std::string& trial, bool seen,
                       const optimise::Metrics& m) {
    const double n = static_cast<double>(m.count);
    const double deviation = std::sqrt(std::max(0.0, (m.rmse * m.rmse - m.bias * m.bias) * n / (n - 1.0)));
    scores.row({model.name, trial, std::string(seen ? "yes" : "no"), n, m.rmse, or_undefined(m.nrmse_range),
                or_undefined(m.r2), m.bias, m.max_absolute_error, m.bias - 1.96 * deviation,
                m.bias + 1.96 * deviation});
  };
  for (const CompareModel& model : models) {
    for (const CompareFrames& f : model.trials)
      row(model, f.trial, f.seen, optimise::metrics(f.reference_n_m, f.modelled_n_m));
    const auto judged = model.judged();
    const bool seen = judged.front()->seen;
    row(model, seen ? "all trials" : "all unseen trials", seen,
        optimise::pooled_metrics(collect(judged, [](const CompareFrames& f) { return f.reference_n_m; }),
                                 collect(judged, [](const CompareFrames& f) { return f.modelled_n_m; })));
  }
  return scores.take();
}

data::Table bias_rows(const std::vector<CompareModel>& models, bool of_angle, int intervals) {
  const double unit = of_angle ? degree : 1.0;
  const auto of = [of_angle](const CompareFrames& f) -> const std::vector<double>& {
    return of_angle ? f.angle_rad : f.activation;
  };
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const CompareModel& m : models) {
    for (const CompareFrames* f : m.judged()) {
      for (const double x : of(*f)) low = std::min(low, x), high = std::max(high, x);
    }
  }
  TableBuilder table(of_angle ? "bias over the joint angle" : "bias over the mean activation");
  table.text("model").number(of_angle ? "from_deg" : "from_activation", of_angle ? "deg" : "1");
  table.number(of_angle ? "to_deg" : "to_activation", of_angle ? "deg" : "1").number("frames", "1");
  table.number("reference_N_m", "N m").number("bias_N_m", "N m").number("rmse_N_m", "N m");
  if (!(high > low)) return table.take();
  for (const CompareModel& m : models) {
    for (int k = 0; k < intervals; ++k) {
      const double from = low + (high - low) * k / intervals, to = low + (high - low) * (k + 1) / intervals;
      double count = 0.0, bias = 0.0, square = 0.0, reference = 0.0;
      for (const CompareFrames* f : m.judged()) {
        for (std::size_t i = 0; i < f->time_s.size(); ++i) {
          const double x = of(*f)[i];
          if (x < from || (k + 1 < intervals ? x >= to : x > to)) continue;
          const double error = f->modelled_n_m[i] - f->reference_n_m[i];
          count += 1.0, bias += error, square += error * error, reference += f->reference_n_m[i];
        }
      }
      if (count > 0.0)
        table.row({m.name, from / unit, to / unit, count, reference / count, bias / count,
                   std::sqrt(square / count)});
    }
  }
  return table.take();
}

data::Table part_rows(const std::vector<CompareModel>& models) {
  TableBuilder table("active and passive parts");
  table.text("model").text("part").number("mean_N_m", "N m").number("rms_N_m", "N m").text("against");
  table.number("rmse_N_m", "N m").number("r2", "1").number("bias_N_m", "N m");
  const Column passive = [](const CompareFrames& f) { return f.passive_n_m; };
  const Column active = [](const CompareFrames& f) {
    std::vector<double> out = f.modelled_n_m;
    for (std::size_t i = 0; i < out.size(); ++i) out[i] -= f.passive_n_m[i];
    return out;
  };
  const CompareModel* first = nullptr;
  for (const CompareModel& m : models) {
    const auto judged = m.judged();
    if (judged.front()->passive_n_m.empty()) continue;
    for (const auto& [name, of] : {std::pair{"active", active}, std::pair{"passive", passive}}) {
      double mean = 0.0;
      const double size = rms(collect(judged, of), mean);
      const double none = or_undefined(std::nullopt);
      if (!first) {
        table.row({m.name, std::string(name), mean, size, std::string(), none, none, none});
        continue;
      }
      const optimise::Metrics b = between(first->judged(), of, judged, of);
      table.row({m.name, std::string(name), mean, size, first->name, b.rmse, or_undefined(b.r2), b.bias});
    }
    if (!first) first = &m;
  }
  return table.take();
}

data::Table muscle_rows(const std::vector<CompareModel>& models) {
  TableBuilder table("moment of each muscle");
  table.text("model")
      .text("muscle")
      .text("in_continuum_model")
      .number("mean_N_m", "N m")
      .number("rms_N_m", "N m");
  table.number("share_of_rms", "1");
  const CompareModel* continuum = first_lacking(models);
  for (const CompareModel& m : models) {
    const auto judged = m.judged();
    double all = 0.0;
    std::vector<std::tuple<std::string, double, double>> rows;
    for (const auto& [muscle, values] : judged.front()->muscle_n_m) {
      double mean = 0.0;
      const double size =
          rms(collect(judged, [&muscle = muscle](const CompareFrames& f) { return f.muscle_n_m.at(muscle); }),
              mean);
      rows.emplace_back(muscle, mean, size);
      all += size;
    }
    for (const auto& [muscle, mean, size] : rows) {
      const std::string known = !continuum ? "" : lacking(*continuum, muscle) ? "no" : "yes";
      table.row({m.name, muscle, known, mean, size, all > 0.0 ? size / all : 0.0});
    }
  }
  return table.take();
}

data::Table same_muscle_rows(const std::vector<CompareModel>& models) {
  TableBuilder table("the same muscles only");
  table.text("model")
      .text("against")
      .text("without")
      .number("rmse_N_m", "N m")
      .number("r2", "1")
      .number("bias_N_m", "N m");
  table.number("missing_mean_N_m", "N m").number("missing_rms_N_m", "N m");
  for (const CompareModel& m : models) {
    if (m.lacks.empty()) continue;
    for (const CompareModel& other : models) {
      const auto judged = other.judged();
      const auto& known = judged.front()->muscle_n_m;
      if (!other.lacks.empty() ||
          !std::all_of(m.lacks.begin(), m.lacks.end(), [&](const auto& n) { return known.contains(n); }))
        continue;
      const Column missing = [&](const CompareFrames& f) {
        std::vector<double> sum(f.time_s.size(), 0.0);
        for (const std::string& muscle : m.lacks) {
          for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += f.muscle_n_m.at(muscle)[i];
        }
        return sum;
      };
      const Column rest = [&](const CompareFrames& f) {
        std::vector<double> out = f.modelled_n_m;
        const std::vector<double> away = missing(f);
        for (std::size_t i = 0; i < out.size(); ++i) out[i] -= away[i];
        return out;
      };
      const optimise::Metrics b =
          between(judged, rest, m.judged(), [](const CompareFrames& f) { return f.modelled_n_m; });
      double mean = 0.0;
      const double size = rms(collect(judged, missing), mean);
      std::string names;
      for (const std::string& n : m.lacks) names += (names.empty() ? "" : ", ") + n;
      table.row({m.name, other.name, names, b.rmse, or_undefined(b.r2), b.bias, mean, size});
    }
  }
  return table.take();
}

}  // namespace brachium::pipelines
