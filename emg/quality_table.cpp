#include "emg/quality.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <functional>
#include <utility>

namespace brachium::emg {

data::Table quality_table(std::span<const ChannelQuality> rows) {
  data::Table table;
  table.title = "EMG quality";
  const auto text = [&](const char* name, const std::function<std::string(const ChannelQuality&)>& of) {
    std::vector<std::string> values;
    for (const ChannelQuality& q : rows) values.push_back(of(q));
    table.columns.push_back({name, "", std::move(values)});
  };
  const auto number = [&](const char* name, const char* unit,
                          const std::function<double(const ChannelQuality&)>& of) {
    std::vector<double> values;
    for (const ChannelQuality& q : rows) values.push_back(of(q));
    table.columns.push_back({name, unit, std::move(values)});
  };
  text("trial", [](const auto& q) { return q.trial; });
  text("channel", [](const auto& q) { return q.channel; });
  text("verdict", [](const auto& q) { return std::string(q.good() ? "good" : "BAD"); });
  number("snr_db", "dB", [](const auto& q) { return q.snr_db; });
  number("line_ratio", "1", [](const auto& q) { return q.line_ratio; });
  number("median_hz", "Hz", [](const auto& q) { return q.median_hz; });
  number("clipped_fraction", "1", [](const auto& q) { return q.clipped_fraction; });
  number("dropout_fraction", "1", [](const auto& q) { return q.dropout_fraction; });
  number("baseline_drift", "1", [](const auto& q) { return q.baseline_drift; });
  number("offset", "signal", [](const auto& q) { return q.mean; });
  number("rms", "signal", [](const auto& q) { return q.rms; });
  text("reasons", [](const auto& q) { return fmt::format("{}", fmt::join(q.reasons, "; ")); });
  return table;
}

}  // namespace brachium::emg
