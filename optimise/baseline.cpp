#include "optimise/baseline.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"
#include "optimise/prepare.hpp"

namespace brachium::optimise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kDelays_s[] = {0.0, 0.1, 0.2};

struct Frames {
  std::vector<double> time_s, reference;
  MatrixXd features;
  std::vector<std::string> names;
};

/// A channel at given instants, `delay` earlier; before its first sample it keeps the first value.
VectorXd delayed(const data::Signal& channel, const std::vector<double>& time_s, double delay) {
  std::vector<double> earlier(time_s);
  for (double& t : earlier) t = std::max(t - delay, channel.info.start_time_s);
  VectorXd out(static_cast<Index>(time_s.size()));
  Resampling(channel.info, earlier)
      .apply(channel.samples, {out.data(), static_cast<std::size_t>(out.size())});
  return out;
}

Frames frames_of(const BaselineSpec& spec, const CalibrationTrial& trial, double edge_s) {
  const std::string what = fmt::format("trial `{}`", trial.name);
  if (trial.moment.samples.empty())
    throw data::InputError("missing-moment", fmt::format("trial `{}` has no reference moment", trial.name));
  for (const data::Signal& signal : trial.excitations) check_samples(signal, what);
  check_samples(trial.angle, what);
  check_samples(trial.moment, what);
  Frames out;
  const UsableSpan span = usable_span(trial, edge_s);
  for (std::size_t i = span.first_row; i <= span.last_row; ++i) {
    out.time_s.push_back(trial.moment.info.time_s(i));
    out.reference.push_back(trial.moment.samples[i]);
  }
  std::vector<double> angle, velocity;
  motion_at(trial, out.time_s, angle, velocity);
  const auto n = static_cast<Index>(out.time_s.size());
  const Eigen::ArrayXd q = Eigen::Map<const VectorXd>(angle.data(), n).array();
  const Eigen::ArrayXd v = Eigen::Map<const VectorXd>(velocity.data(), n).array();
  std::vector<VectorXd> columns;
  const auto add = [&](const std::string& name, const VectorXd& column) {
    out.names.push_back(name);
    columns.push_back(column);
  };
  switch (spec.kind) {
    case BaselineSpec::Kind::linear_envelope:
      for (const data::Signal& channel : trial.excitations)
        add(channel.info.name, delayed(channel, out.time_s, 0.0));
      add("sin q", q.sin().matrix());
      break;
    case BaselineSpec::Kind::angle_polynomial:
      for (int k = 1; k <= spec.degree; ++k) add(fmt::format("q^{}", k), q.pow(k).matrix());
      break;
    case BaselineSpec::Kind::flexible: {
      for (double delay : kDelays_s) {
        for (const data::Signal& channel : trial.excitations) {
          const Eigen::ArrayXd c = delayed(channel, out.time_s, delay).array();
          const std::string name = fmt::format("{} -{:.1f} s", channel.info.name, delay);
          add(name, c.matrix());
          add(name + " * sin q", (c * q.sin()).matrix());
          add(name + " * cos q", (c * q.cos()).matrix());
          add(name + " * q'", (c * v).matrix());
          add(name + " * q' sin q", (c * v * q.sin()).matrix());
        }
      }
      VectorXd acceleration(n);
      for (Index i = 0; i < n; ++i) {
        const Index a = std::max<Index>(i - 1, 0), b = std::min(i + 1, n - 1);
        acceleration[i] = (v[b] - v[a]) * trial.moment.info.rate_hz / static_cast<double>(b - a);
      }
      add("q", q.matrix());
      add("q^2", q.square().matrix());
      add("q^3", q.cube().matrix());
      add("sin q", q.sin().matrix());
      add("cos q", q.cos().matrix());
      add("q'", v.matrix());
      add("q''", acceleration);
      break;
    }
  }
  std::vector<Index> kept;
  for (Index i = 0; i < n; ++i) {
    if (trial.use.empty() || trial.use[span.first_row + static_cast<std::size_t>(i)]) kept.push_back(i);
  }
  out.features.resize(static_cast<Index>(kept.size()), static_cast<Index>(columns.size()));
  for (std::size_t j = 0; j < columns.size(); ++j) out.features.col(static_cast<Index>(j)) = columns[j](kept);
  for (std::size_t k = 0; k < kept.size(); ++k) {
    out.time_s[k] = out.time_s[static_cast<std::size_t>(kept[k])];
    out.reference[k] = out.reference[static_cast<std::size_t>(kept[k])];
  }
  out.time_s.resize(kept.size());
  out.reference.resize(kept.size());
  return out;
}

std::string title_of(const BaselineSpec& spec, std::size_t columns) {
  switch (spec.kind) {
    case BaselineSpec::Kind::linear_envelope:
      return "linear in the envelopes and sin(angle)";
    case BaselineSpec::Kind::angle_polynomial:
      return fmt::format("polynomial of degree {} in the angle alone, no EMG", spec.degree);
    case BaselineSpec::Kind::flexible:
      break;
  }
  return fmt::format("flexible regression, {} columns of delayed envelopes times angle and velocity",
                     columns);
}

}  // namespace

std::string BaselineSpec::name() const {
  switch (kind) {
    case Kind::linear_envelope:
      return "linear_envelope";
    case Kind::angle_polynomial:
      return fmt::format("angle_polynomial_{}", degree);
    case Kind::flexible:
      break;
  }
  return "flexible";
}

Baseline fit_baseline(const BaselineSpec& spec, const std::vector<CalibrationTrial>& training,
                      double edge_s) {
  if (training.empty()) throw data::InputError("no-trials", "a regression needs at least one trial");
  if (!(spec.ridge >= 0.0) || spec.degree < 1)
    throw data::InputError("out-of-range",
                           fmt::format("baseline `{}`: ridge {} must not be negative, degree {} at least 1",
                                       spec.name(), spec.ridge, spec.degree));
  std::vector<Frames> parts;
  Index rows = 0;
  for (const CalibrationTrial& trial : training) {
    parts.push_back(frames_of(spec, trial, edge_s));
    rows += parts.back().features.rows();
    if (parts.back().names != parts.front().names)
      throw data::InputError(
          "unmapped-channel",
          fmt::format("trials `{}` and `{}` do not have the same channels in the same order",
                      training.front().name, trial.name));
  }
  Baseline out;
  out.spec = spec;
  out.columns = parts.front().names;
  out.title = title_of(spec, out.columns.size());
  const Index k = static_cast<Index>(out.columns.size());
  MatrixXd A(rows, k);
  VectorXd y(rows);
  Index row = 0;
  for (const Frames& part : parts) {
    A.middleRows(row, part.features.rows()) = part.features;
    y.segment(row, part.features.rows()) =
        Eigen::Map<const VectorXd>(part.reference.data(), part.features.rows());
    row += part.features.rows();
  }
  out.mean = A.colwise().mean();
  A.rowwise() -= out.mean.transpose();
  out.deviation = (A.colwise().squaredNorm() / static_cast<double>(rows)).cwiseSqrt();
  for (Index j = 0; j < k; ++j)
    if (!(out.deviation[j] > 1e-12 * std::max(1.0, std::abs(out.mean[j]))))
      out.deviation[j] = 1.0;  // a constant column: weight 0
  A = A * out.deviation.cwiseInverse().asDiagonal();
  out.intercept = y.mean();
  const VectorXd centred = y.array() - out.intercept;
  if (spec.ridge > 0.0) {
    MatrixXd augmented = MatrixXd::Zero(rows + k, k);
    augmented.topRows(rows) = A;
    augmented.bottomRows(k).diagonal().setConstant(std::sqrt(spec.ridge * static_cast<double>(rows)));
    VectorXd b = VectorXd::Zero(rows + k);
    b.head(rows) = centred;
    out.weights = augmented.completeOrthogonalDecomposition().solve(b);
  } else {
    out.weights = A.completeOrthogonalDecomposition().solve(centred);
  }
  return out;
}

BaselinePrediction predict(const Baseline& baseline, const CalibrationTrial& trial, double edge_s) {
  const Frames frames = frames_of(baseline.spec, trial, edge_s);
  if (frames.names != baseline.columns)
    throw data::InputError("unmapped-channel",
                           fmt::format("trial `{}` does not have the channels that `{}` was fitted with",
                                       trial.name, baseline.spec.name()));
  const MatrixXd standard = (frames.features.rowwise() - baseline.mean.transpose()) *
                            baseline.deviation.cwiseInverse().asDiagonal();
  const VectorXd y = (standard * baseline.weights).array() + baseline.intercept;
  return {frames.time_s, frames.reference, std::vector<double>(y.data(), y.data() + y.size())};
}

}  // namespace brachium::optimise
