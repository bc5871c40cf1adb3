#include "optimise/verdicts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace brachium::optimise {
namespace {

void append(std::string& remark, const std::string& text) {
  remark += (remark.empty() ? "" : "; ") + text;
}

std::string bounds_text(double value) {
  return fmt::format("{:.4g}", value);
}

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> exchangeable_pairs(
    const std::vector<Parameter>& parameters) {
  std::vector<std::pair<std::size_t, std::size_t>> out;
  for (std::size_t a = 0; a < parameters.size(); ++a) {
    for (std::size_t b = 0; b < parameters.size(); ++b) {
      if (parameters[a].owner != parameters[b].owner) continue;
      const bool constants =
          parameters[a].name == "time_constant_1_s" && parameters[b].name == "time_constant_2_s";
      const bool coefficients = parameters[a].name == "recursion_1" && parameters[b].name == "recursion_2";
      if (constants || coefficients) out.emplace_back(a, b);
    }
  }
  return out;
}

std::vector<data::ParameterVerdict> verdicts(const VerdictInput& input) {
  const auto& parameters = *input.parameters;
  const FitStatistics& statistics = *input.statistics;
  std::vector<data::ParameterVerdict> out;
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    const Parameter& p = parameters[j];
    data::ParameterVerdict v;
    v.muscle = p.owner;
    v.parameter = p.name;
    v.unit = p.unit;
    v.start = p.start;
    v.lower = p.lower;
    v.upper = p.upper;
    v.fitted = input.x[i];
    v.bias = input.bias[i];
    v.standard_error = statistics.standard_error[i];
    const double width = p.upper - p.lower;
    const double lower = input.intervals.lower[i], upper = input.intervals.upper[i];
    const bool finite = std::isfinite(v.standard_error) && std::isfinite(upper - lower);
    v.interval_lower = finite ? lower : p.lower;
    v.interval_upper = finite ? upper : p.upper;
    const double solution = input.x_uncorrected[i];
    if (!finite) {
      v.verdict = "NOT IDENTIFIED";
      append(v.remark, statistics.degrees_of_freedom > 0.0 ? "lies in a direction that the data do not see"
                                                           : "fewer independent samples than parameters");
    } else if (solution - p.lower <= 1e-6 * width) {
      v.verdict = "AT LOWER BOUND";
    } else if (p.upper - solution <= 1e-6 * width) {
      v.verdict = "AT UPPER BOUND";
    } else if (!(upper - lower < width)) {
      v.verdict = "NOT IDENTIFIED";
      append(v.remark,
             fmt::format("its 95 % interval ({} wide) is wider than its bounds", bounds_text(upper - lower)));
    } else if (p.prior && statistics.prior_ratio[i] > 0.9) {
      v.verdict = "NOT IDENTIFIED";
    } else {
      v.verdict = "identified";
    }
    if (v.verdict.starts_with("AT ") && std::abs(v.fitted - solution) > 1e-6 * width)
      append(v.remark,
             "the least-squares solution ends there; the value has the bias of the excitation's noise taken "
             "off");
    if (p.prior && finite && statistics.prior_ratio[i] > 0.5)
      append(v.remark,
             fmt::format("determined by its prior (posterior / prior sd {:.2f})", statistics.prior_ratio[i]));
    out.push_back(std::move(v));
  }
  for (const CorrelatedPair& pair : statistics.correlated) {
    append(out[pair.first].remark,
           fmt::format("correlated {:+.3f} with {}", pair.correlation, parameters[pair.second].label()));
    append(out[pair.second].remark,
           fmt::format("correlated {:+.3f} with {}", pair.correlation, parameters[pair.first].label()));
  }
  for (const WeakDirection& weak : statistics.weak) {
    if (weak.parameters.size() < 2) continue;
    for (std::size_t j = 0; j < parameters.size(); ++j)
      if (std::find(weak.parameters.begin(), weak.parameters.end(), parameters[j].label()) !=
          weak.parameters.end())
        append(out[j].remark, "hardly determined along: " + weak.text);
  }
  for (const auto& [gain, strength] : input.gain_strength) {
    for (const auto& [one, other] : {std::pair{gain, strength}, std::pair{strength, gain}}) {
      out[one].verdict = "NOT IDENTIFIED";
      append(
          out[one].remark,
          fmt::format(
              "one parameter with {}: without a maximal contraction or a prior only their product is known",
              parameters[other].label()));
    }
  }
  for (const auto& [a, b] : exchangeable_pairs(parameters)) {
    append(out[a].remark, fmt::format("interchangeable with {}: the pair is determined, not which is which",
                                      parameters[b].name));
    append(out[b].remark, fmt::format("interchangeable with {}: the pair is determined, not which is which",
                                      parameters[a].name));
  }
  return out;
}

data::Table verdict_table(const data::Subject& subject) {
  std::vector<std::string> owner, parameter, unit, verdict, remark;
  std::map<std::string, std::vector<double>> number;
  for (const auto& v : subject.verdicts) {
    owner.push_back(v.muscle);
    parameter.push_back(v.parameter);
    unit.push_back(v.unit);
    verdict.push_back(v.verdict);
    remark.push_back(v.remark);
    number["start"].push_back(v.start);
    number["fitted"].push_back(v.fitted);
    number["lower"].push_back(v.lower);
    number["upper"].push_back(v.upper);
    number["standard_error"].push_back(v.standard_error);
    number["interval_lower"].push_back(v.interval_lower);
    number["interval_upper"].push_back(v.interval_upper);
    number["bias"].push_back(v.bias);
  }
  data::Table table;
  table.title = "Verdict on every parameter";
  table.columns.push_back({"owner", "", owner});
  table.columns.push_back({"parameter", "", parameter});
  table.columns.push_back({"unit", "", unit});
  for (const char* name :
       {"start", "fitted", "lower", "upper", "standard_error", "interval_lower", "interval_upper", "bias"})
    table.columns.push_back({name, "mixed", number[name]});
  table.columns.push_back({"verdict", "", verdict});
  table.columns.push_back({"remark", "", remark});
  return table;
}

std::string verdict_text(const data::Subject& subject) {
  std::size_t owner = 5, parameter = 9;
  for (const auto& v : subject.verdicts) {
    owner = std::max(owner, v.muscle.size());
    parameter = std::max(parameter, v.parameter.size());
  }
  std::string out =
      fmt::format("{:<{}}  {:<{}}  {:>9}  {:>9}  {:<19}  {:<21}  {:>9}  verdict\n", "owner", owner,
                  "parameter", parameter, "start", "fitted", "bounds", "95 % interval", "bias");
  for (const auto& v : subject.verdicts) {
    const std::string interval = std::isfinite(v.standard_error)
                                     ? fmt::format("{:.4g} .. {:.4g}", v.interval_lower, v.interval_upper)
                                     : std::string("unknown");
    out += fmt::format("{:<{}}  {:<{}}  {:>9.4g}  {:>9.4g}  {:<19}  {:<21}  {:>9.2g}  {}{}\n", v.muscle,
                       owner, v.parameter, parameter, v.start, v.fitted,
                       fmt::format("{:.4g} .. {:.4g}", v.lower, v.upper), interval, v.bias, v.verdict,
                       v.remark.empty() ? "" : " (" + v.remark + ")");
  }
  return out;
}

}  // namespace brachium::optimise
