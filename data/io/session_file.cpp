#include "data/io/session_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "data/io/hdf5_support.hpp"
#include "data/io/session_layout.hpp"
#include "data/model/error.hpp"

namespace brachium::io {
namespace {

using data::InputError;
using data::SignalInfo;
using data::TrialInfo;
using hdf5::Handle;

constexpr std::size_t most_open_datasets = 32;  // each may keep a chunk in memory

/// Reads the descriptive part of a session file.
struct InfoReader {
  const std::filesystem::path& file;

  [[noreturn]] void fail(const std::string& code, const std::string& message, const std::string& help) const {
    throw InputError(code, fmt::format("`{}`: {}", file.string(), message), help);
  }

  std::string text(hid_t object, const std::string& name, const std::string& of) const {
    if (auto value = hdf5::text_attribute(object, name)) return *value;
    missing(object, name, of, "a text");
  }

  double number(hid_t object, const std::string& name, const std::string& of) const {
    if (auto value = hdf5::number_attribute(object, name)) {
      if (!std::isfinite(*value))
        fail("wrong-type", fmt::format("attribute `{}` of {} is not finite", name, of), layout::help);
      return *value;
    }
    missing(object, name, of, "a number");
  }

  [[noreturn]] void missing(hid_t object, const std::string& name, const std::string& of,
                            const std::string& kind) const {
    if (hdf5::has_attribute(object, name)) {
      fail("wrong-type", fmt::format("attribute `{}` of {} is not {}", name, of, kind), layout::help);
    }
    fail("missing-attribute", fmt::format("{} has no attribute `{}`", of, name), layout::help);
  }

  std::map<std::string, double> numbers(hid_t object, const std::string& prefix,
                                        const std::string& of) const {
    std::map<std::string, double> values;
    for (const std::string& name : hdf5::attribute_names(object)) {
      if (name.starts_with(prefix)) values[name.substr(prefix.size())] = number(object, name, of);
    }
    return values;
  }

  std::map<std::string, std::string> texts(hid_t object, const std::string& of) const {
    std::map<std::string, std::string> values;
    for (const std::string& name : hdf5::attribute_names(object)) {
      if (name.starts_with(layout::attribute))
        values[name.substr(layout::attribute.size())] = text(object, name, of);
    }
    return values;
  }

  SignalInfo signal(hid_t group, const std::string& trial, const std::string& name, double& order) const {
    const std::string of = fmt::format("signal `{}` of trial `{}`", name, trial);
    const Handle dataset(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose);
    const Handle space(dataset ? H5Dget_space(dataset.get()) : -1, H5Sclose);
    const Handle type(dataset ? H5Dget_type(dataset.get()) : -1, H5Tclose);
    if (!dataset || !space || !type) fail("damaged-file", of + " cannot be opened", "make the file again");
    const H5T_class_t kind = H5Tget_class(type.get());
    if (H5Sget_simple_extent_ndims(space.get()) != 1 || (kind != H5T_FLOAT && kind != H5T_INTEGER)) {
      fail("wrong-type", of + " is not a one-dimensional list of numbers", layout::help);
    }
    SignalInfo info;
    info.name = name;
    info.count = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space.get()));
    info.unit = hdf5::has_attribute(dataset.get(), "unit") ? text(dataset.get(), "unit", of)
                                                           : text(dataset.get(), "units", of);
    info.rate_hz = number(dataset.get(), "rate_hz", of);
    if (!(info.rate_hz > 0.0))
      fail("wrong-type", fmt::format("`rate_hz` of {} must be greater than 0", of), layout::help);
    info.start_time_s = number(dataset.get(), "start_time_s", of);
    try {
      info.quantity = data::parse_quantity(text(dataset.get(), "quantity", of));
    } catch (const InputError& e) {
      if (e.diagnostics().front().code != "unknown-quantity") throw;
      fail("unknown-quantity", fmt::format("{}: {}", of, e.what()), e.diagnostics().front().help);
    }
    info.muscle = hdf5::text_attribute(dataset.get(), "muscle").value_or("");
    info.coordinate = hdf5::text_attribute(dataset.get(), "coordinate").value_or("");
    info.attributes = texts(dataset.get(), of);
    order = hdf5::number_attribute(dataset.get(), "index").value_or(0.0);
    return info;
  }

  TrialInfo trial(hid_t trials, const std::string& name, double& order) const {
    const std::string of = fmt::format("trial `{}`", name);
    const Handle group(H5Gopen2(trials, name.c_str(), H5P_DEFAULT), H5Gclose);
    if (!group) fail("damaged-file", of + " cannot be opened", "make the file again");
    TrialInfo info;
    info.name = name;
    info.kind = data::parse_trial_kind(text(group.get(), "kind", of));
    info.conditions = numbers(group.get(), layout::condition, of);
    info.attributes = texts(group.get(), of);
    order = hdf5::number_attribute(group.get(), "index").value_or(0.0);
    std::vector<std::pair<double, SignalInfo>> signals;
    for (const std::string& child : hdf5::children(group.get(), H5O_TYPE_DATASET)) {
      if (layout::is_time_name(child)) continue;
      double at = 0.0;
      SignalInfo one = signal(group.get(), name, child, at);
      signals.emplace_back(at, std::move(one));
    }
    std::stable_sort(signals.begin(), signals.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (auto& [at, one] : signals) info.signals.push_back(std::move(one));
    return info;
  }

  data::SessionInfo session(hid_t root) const {
    const std::string of = "the file";
    const std::string format = hdf5::text_attribute(root, "format").value_or("");
    if (format != layout::format) {
      fail("wrong-format",
           "this HDF5 file is not a Brachium session (no attribute `format` = `brachium-session`)",
           "import the recordings with a session description (.toml) first");
    }
    const double version = number(root, "format_version", of);
    if (version != layout::version) {
      fail("wrong-version",
           fmt::format("format version {} cannot be read, only version {}", version, layout::version),
           "import the recordings again with this version of the program");
    }
    data::SessionInfo info;
    info.subject = hdf5::text_attribute(root, "subject").value_or("");
    info.anthropometry = numbers(root, layout::anthropometry, of);
    info.attributes = texts(root, of);
    const Handle trials(H5Gopen2(root, "trials", H5P_DEFAULT), H5Gclose);
    if (!trials) fail("missing-group", "there is no group `trials`", layout::help);
    std::vector<std::pair<double, TrialInfo>> found;
    for (const std::string& name : hdf5::children(trials.get(), H5O_TYPE_GROUP)) {
      double at = 0.0;
      TrialInfo one = trial(trials.get(), name, at);
      found.emplace_back(at, std::move(one));
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (auto& [at, one] : found) info.trials.push_back(std::move(one));
    return info;
  }
};

}  // namespace

struct SessionFile::Impl {
  std::filesystem::path path;
  Handle file;
  data::SessionInfo info;
  std::map<std::pair<std::size_t, std::size_t>, Handle> open;  // datasets lately read

  hid_t dataset(std::size_t trial, std::size_t signal) {
    const auto key = std::pair(trial, signal);
    if (const auto at = open.find(key); at != open.end()) return at->second.get();
    if (open.size() >= most_open_datasets) open.clear();
    const std::string name =
        fmt::format("/trials/{}/{}", info.trials[trial].name, info.trials[trial].signals[signal].name);
    Handle handle(H5Dopen2(file.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
    const hid_t id = handle.get();
    if (handle) open.emplace(key, std::move(handle));
    return id;
  }
};

SessionFile::SessionFile(const std::filesystem::path& file) : impl_(std::make_unique<Impl>()) {
  const hdf5::Lock lock;
  impl_->path = file;
  Handle handle = hdf5::open_for_reading(file);
  impl_->info = InfoReader{impl_->path}.session(handle.get());
  impl_->file = std::move(handle);
}

SessionFile::~SessionFile() {
  const hdf5::Lock lock;
  impl_.reset();
}

const data::SessionInfo& SessionFile::info() const {
  return impl_->info;
}

void SessionFile::read(std::size_t trial, std::size_t signal, std::size_t first,
                       std::span<double> out) const {
  const SignalInfo& info = impl_->info.trials.at(trial).signals.at(signal);
  if (first > info.count || out.size() > info.count - first) {
    throw std::out_of_range("SessionFile::read past the end of a signal");
  }
  if (out.empty()) return;
  {
    const hdf5::Lock lock;
    const hid_t dataset = impl_->dataset(trial, signal);
    const hsize_t start = first, count = out.size();
    const Handle stored(dataset >= 0 ? H5Dget_space(dataset) : -1, H5Sclose);
    const Handle memory(H5Screate_simple(1, &count, nullptr), H5Sclose);
    if (!stored || H5Sselect_hyperslab(stored.get(), H5S_SELECT_SET, &start, nullptr, &count, nullptr) < 0 ||
        H5Dread(dataset, H5T_NATIVE_DOUBLE, memory.get(), stored.get(), H5P_DEFAULT, out.data()) < 0) {
      throw InputError(
          "damaged-data",
          fmt::format(
              "`{}`: samples of signal `{}` of trial `{}` cannot be read; the file is cut off or damaged",
              impl_->path.string(), info.name, impl_->info.trials[trial].name),
          "make the file again, or fetch a complete copy");
    }
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (std::isfinite(out[i])) continue;
    throw InputError("non-finite-sample",
                     fmt::format("`{}`: signal `{}` of trial `{}` has {} at {:.6g} s", impl_->path.string(),
                                 info.name, impl_->info.trials[trial].name, out[i], info.time_s(first + i)),
                     "mend or cut the recording; Brachium does not replace samples");
  }
}

void write_session(const data::Session& session, const std::filesystem::path& file) {
  SessionFileWriter writer(file);
  data::store(session, writer);
  writer.commit();
}

data::Session read_session(const std::filesystem::path& file) {
  return data::load(SessionFile(file));
}

}  // namespace brachium::io
