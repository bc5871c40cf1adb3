#include <fmt/format.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <tuple>

#include "data/io/atomic_file.hpp"
#include "data/io/hdf5_support.hpp"
#include "data/io/session_file.hpp"
#include "data/io/session_layout.hpp"
#include "data/model/error.hpp"

namespace brachium::io {
namespace {

using data::InputError;
using data::SignalInfo;
using hdf5::Handle;

struct OpenSignal {
  SignalInfo info;
  Handle dataset;  // closed once all samples are there
  std::size_t written = 0;
};

struct OpenTrial {
  Handle group;
  std::map<std::string, OpenSignal> signals;
  std::map<std::tuple<double, double, std::size_t>, std::string> scales;  // (rate, start, count) -> time_<n>
};

}  // namespace

struct SessionFileWriter::Impl {
  AtomicFile target;
  Options options;
  Handle file, trials_group;
  std::map<std::string, OpenTrial> trials;
  bool committed = false;

  Impl(const std::filesystem::path& path, const Options& o) : target(path), options(o) {}
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    if (!committed) hdf5::divert(file.get());
  }

  void need(bool done, const std::string& what) const {
    if (!done) hdf5::fail_write(file.get(), target.target(), what);
  }

  // Flushing first: a close that fails would free the dataset and leave the file in a state HDF5 cannot
  // close.
  void close(Handle& dataset, const std::string& what) const {
    need(H5Dflush(dataset.get()) >= 0 && dataset.close(), what);
  }

  OpenTrial& trial(const std::string& name) {
    const auto at = trials.find(name);
    if (at == trials.end()) throw std::logic_error("SessionFileWriter: trial `" + name + "` was not begun");
    return at->second;
  }

  void write_texts(hid_t object, const std::map<std::string, std::string>& texts) const {
    for (const auto& [name, value] : texts)
      need(hdf5::write_attribute(object, layout::attribute + name, value), "an attribute");
  }

  void write_numbers(hid_t object, const std::string& prefix,
                     const std::map<std::string, double>& numbers) const {
    for (const auto& [name, value] : numbers)
      need(hdf5::write_attribute(object, prefix + name, value), "an attribute");
  }

  Handle create_dataset(hid_t group, const std::string& name, std::size_t count) const {
    const hsize_t size = count, chunk = std::min(count, options.chunk_samples);
    const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
    const Handle plan(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_chunk(plan.get(), 1, &chunk);
    if (options.deflate_level > 0) {
      H5Pset_shuffle(plan.get());
      H5Pset_deflate(plan.get(), static_cast<unsigned>(options.deflate_level));
    }
    H5Pset_fletcher32(plan.get());
    // Every sample is written by us: no fill values first.
    H5Pset_fill_time(plan.get(), H5D_FILL_TIME_NEVER);
    return {
        H5Dcreate2(group, name.c_str(), H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, plan.get(), H5P_DEFAULT),
        H5Dclose};
  }

  bool write_slab(hid_t dataset, std::size_t first, std::span<const double> samples) const {
    const hsize_t start = first, count = samples.size();
    const Handle stored(H5Dget_space(dataset), H5Sclose);
    const Handle memory(H5Screate_simple(1, &count, nullptr), H5Sclose);
    return H5Sselect_hyperslab(stored.get(), H5S_SELECT_SET, &start, nullptr, &count, nullptr) >= 0 &&
           H5Dwrite(dataset, H5T_NATIVE_DOUBLE, memory.get(), stored.get(), H5P_DEFAULT, samples.data()) >= 0;
  }

  // The dimension scale of these time stamps; made, chunk by chunk, when they are new in the trial.
  std::string scale_of(OpenTrial& trial, const SignalInfo& info) {
    const auto key = std::tuple(info.rate_hz, info.start_time_s, info.count);
    if (const auto at = trial.scales.find(key); at != trial.scales.end()) return at->second;
    const std::string name = fmt::format("time_{}", trial.scales.size());
    Handle scale = create_dataset(trial.group.get(), name, info.count);
    need(static_cast<bool>(scale), "time stamps");
    std::vector<double> times(std::min(info.count, options.chunk_samples));
    for (std::size_t first = 0; first < info.count; first += times.size()) {
      const std::size_t n = std::min(times.size(), info.count - first);
      for (std::size_t i = 0; i < n; ++i) times[i] = info.time_s(first + i);
      need(write_slab(scale.get(), first, std::span(times).first(n)), "time stamps");
    }
    need(hdf5::write_attribute(scale.get(), "units", std::string("s")) &&
             hdf5::write_attribute(scale.get(), "unit", std::string("s")) &&
             H5DSset_scale(scale.get(), name.c_str()) >= 0,
         "time stamps");
    close(scale, "time stamps");
    trial.scales.emplace(key, name);
    return name;
  }
};

SessionFileWriter::SessionFileWriter(const std::filesystem::path& file)
    : SessionFileWriter(file, Options{}) {}

SessionFileWriter::SessionFileWriter(const std::filesystem::path& file, const Options& options) {
  if (options.deflate_level < 0 || options.deflate_level > 9 || options.chunk_samples == 0) {
    throw std::logic_error(
        "SessionFileWriter: deflate_level must lie in [0, 9], chunk_samples must be positive");
  }
  const hdf5::Lock lock;
  auto impl = std::make_unique<Impl>(file, options);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG);
  impl->file =
      Handle(H5Fcreate(impl->target.temporary().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), H5Fclose);
  impl->need(static_cast<bool>(impl->file), "a new file");
  const hid_t root = impl->file.get();
  impl->trials_group = hdf5::create_group(root, "trials");
  impl->need(static_cast<bool>(impl->trials_group) &&
                 hdf5::write_attribute(root, "format", std::string(layout::format)) &&
                 hdf5::write_attribute(root, "format_version", static_cast<long long>(layout::version)),
             "a new file");
  impl_ = std::move(impl);
}

SessionFileWriter::~SessionFileWriter() {
  const hdf5::Lock lock;
  impl_.reset();
}

std::int64_t SessionFileWriter::hdf5_id() const {
  return impl_->file.get();
}
const std::filesystem::path& SessionFileWriter::target() const {
  return impl_->target.target();
}

void SessionFileWriter::begin(const data::SessionInfo& session) {
  const hdf5::Lock lock;
  const hid_t root = impl_->file.get();
  impl_->need(hdf5::write_attribute(root, "subject", session.subject), "the subject's name");
  impl_->write_numbers(root, layout::anthropometry, session.anthropometry);
  impl_->write_texts(root, session.attributes);
}

void SessionFileWriter::begin_trial(const data::TrialInfo& trial) {
  hdf5::check_name(trial.name, "trial");
  const hdf5::Lock lock;
  if (impl_->trials.contains(trial.name)) {
    throw InputError("duplicate-trial", fmt::format("there are two trials `{}`", trial.name),
                     "give each trial a name of its own");
  }
  Handle group = hdf5::create_group(impl_->trials_group.get(), trial.name.c_str());
  impl_->need(group && hdf5::write_attribute(group.get(), "name", trial.name) &&
                  hdf5::write_attribute(group.get(), "index", static_cast<long long>(impl_->trials.size())) &&
                  hdf5::write_attribute(group.get(), "kind", data::to_string(trial.kind)),
              "a trial");
  impl_->write_numbers(group.get(), layout::condition, trial.conditions);
  impl_->write_texts(group.get(), trial.attributes);
  impl_->trials[trial.name].group = std::move(group);
}

void SessionFileWriter::begin_signal(const std::string& trial, const SignalInfo& info) {
  hdf5::check_name(info.name, "signal");
  if (layout::is_time_name(info.name)) {
    throw InputError("bad-name", fmt::format("`{}` cannot be the name of a signal", info.name),
                     "names time_<number> are kept for time stamps");
  }
  if (!(info.rate_hz > 0.0) || !std::isfinite(info.rate_hz) || !std::isfinite(info.start_time_s) ||
      info.count == 0 || info.unit.empty()) {
    throw InputError(
        "bad-signal",
        fmt::format("signal `{}` of trial `{}` needs a rate above 0, a start time, a unit and samples "
                    "(rate {} Hz, start {} s, unit `{}`, {} samples)",
                    info.name, trial, info.rate_hz, info.start_time_s, info.unit, info.count));
  }
  const hdf5::Lock lock;
  OpenTrial& open = impl_->trial(trial);
  if (open.signals.contains(info.name)) {
    throw InputError("duplicate-signal", fmt::format("trial `{}` has two signals `{}`", trial, info.name),
                     "give each signal of a trial a name of its own");
  }
  const std::string scale_name = impl_->scale_of(open, info);
  Handle dataset = impl_->create_dataset(open.group.get(), info.name, info.count);
  impl_->need(static_cast<bool>(dataset), fmt::format("signal `{}`", info.name));
  const hid_t id = dataset.get();
  const Handle scale(H5Dopen2(open.group.get(), scale_name.c_str(), H5P_DEFAULT), H5Dclose);
  impl_->need(H5DSattach_scale(id, scale.get(), 0) >= 0 && hdf5::write_attribute(id, "units", info.unit) &&
                  hdf5::write_attribute(id, "unit", info.unit) &&
                  hdf5::write_attribute(id, "quantity", data::to_string(info.quantity)) &&
                  hdf5::write_attribute(id, "rate_hz", info.rate_hz) &&
                  hdf5::write_attribute(id, "start_time_s", info.start_time_s) &&
                  hdf5::write_attribute(id, "index", static_cast<long long>(open.signals.size())) &&
                  (info.muscle.empty() || hdf5::write_attribute(id, "muscle", info.muscle)) &&
                  (info.coordinate.empty() || hdf5::write_attribute(id, "coordinate", info.coordinate)),
              fmt::format("signal `{}`", info.name));
  impl_->write_texts(id, info.attributes);
  open.signals[info.name] = {info, std::move(dataset), 0};
}

void SessionFileWriter::write_samples(const std::string& trial, const std::string& signal, std::size_t first,
                                      std::span<const double> samples) {
  const auto bad = std::find_if(samples.begin(), samples.end(), [](double v) { return !std::isfinite(v); });
  const hdf5::Lock lock;
  OpenTrial& open = impl_->trial(trial);
  const auto at = open.signals.find(signal);
  if (at == open.signals.end())
    throw std::logic_error("SessionFileWriter: signal `" + signal + "` was not begun");
  OpenSignal& out = at->second;
  if (bad != samples.end()) {
    throw InputError("non-finite-sample",
                     fmt::format("signal `{}` of trial `{}` has {} at {:.6g} s", signal, trial, *bad,
                                 out.info.time_s(first + static_cast<std::size_t>(bad - samples.begin()))));
  }
  if (first > out.info.count || samples.size() > out.info.count - first) {
    throw std::out_of_range("SessionFileWriter::write_samples past the end of signal `" + signal + "`");
  }
  if (samples.empty()) return;
  if (!out.dataset)
    throw std::logic_error("SessionFileWriter: samples of signal `" + signal + "` written twice");
  impl_->need(impl_->write_slab(out.dataset.get(), first, samples),
              fmt::format("signal `{}` of trial `{}`", signal, trial));
  out.written += samples.size();
  if (out.written >= out.info.count)
    impl_->close(out.dataset, fmt::format("signal `{}` of trial `{}`", signal, trial));
}

void SessionFileWriter::commit() {
  const hdf5::Lock lock;
  if (impl_->committed) throw std::logic_error("SessionFileWriter: committed twice");
  for (const auto& [trial, open] : impl_->trials) {
    for (const auto& [name, signal] : open.signals) {
      if (signal.written != signal.info.count) {
        throw std::logic_error(
            fmt::format("SessionFileWriter: {} of {} samples of signal `{}` of trial `{}` were written",
                        signal.written, signal.info.count, name, trial));
      }
    }
  }
  impl_->trials.clear();
  impl_->trials_group.close();
  impl_->need(H5Fflush(impl_->file.get(), H5F_SCOPE_LOCAL) >= 0, "the file");
  impl_->need(impl_->file.close(), "the file");
  impl_->target.commit();
  impl_->committed = true;
}

}  // namespace brachium::io
