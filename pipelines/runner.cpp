#include "pipelines/runner.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <mutex>
#include <set>
#include <stdexcept>

#include "data/io/atomic_file.hpp"
#include "data/io/scene_file.hpp"
#include "data/io/stage_file.hpp"
#include "data/model/parallel.hpp"
#include "pipelines/assemble_report.hpp"
#include "pipelines/exports.hpp"
#include "pipelines/guarded_sink.hpp"
#include "pipelines/options.hpp"
#include "pipelines/report/html.hpp"
#include "pipelines/run_folder.hpp"
#include "pipelines/run_log.hpp"
#include "pipelines/run_records.hpp"
#include "pipelines/run_stage.hpp"
#include "pipelines/session_import.hpp"
#include "pipelines/sha256.hpp"
#include "pipelines/version.hpp"

namespace brachium::pipelines {
namespace {

namespace fs = std::filesystem;
using data::Diagnostic;
using data::InputError;
using data::Severity;

/// A stage that kept what it reached, and failed all the same (StageOutput::failure).
struct FailedWithOutput : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class Run {
 public:
  Run(const Catalogue& catalogue, const RunRequest& request, RunObserver& observer)
      : request_(request),
        definition_(std::make_shared<Definition>(
            read_definition(request.definition, request.settings, catalogue, StageChecks::run))),
        folder_(request.out.empty() ? fs::path("runs") / definition_->file.stem() : request.out),
        observer_(folder_.path() / "log.txt", observer),
        digests_(folder_.path() / "digests.json") {
    check_stage_choice();
    result_.definition = definition_;
    result_.folder = folder_.path();
    result_.command_line = request.command_line;
    result_.started = utc_now();
    threads_ = data::thread_count(request.threads > 0 ? request.threads : definition_->threads);
    if (definition_->session_is_description()) session_import_ = make_session_import(*definition_);
    // The geometry and parameters as read, not the file's text: a comment does not make results stale.
    if (definition_->scene) scene_digest_ = sha256(io::write_scene(*definition_->scene));
  }

  RunResult execute() {
    io::write_text_atomically(folder_.path() / "definition.toml", resolved_text(*definition_));
    folder_.tidy(*definition_);
    if (folder_.left_behind()) observer_.message(*folder_.left_behind());
    remember_earlier_times();
    const std::vector<const StageDefinition*> stages = stages_in_order();
    choose_stages(stages);
    std::size_t place = 0;
    for (const StageDefinition* stage : stages) {
      StageRecord record;
      record.name = stage->name;
      record.run = stage->spec->name;
      record.output = output_file(folder_.path(), stage->number, stage->name);
      for (const auto& [port, wires] : stage->inputs) {
        for (const Wire& wire : wires)
          record.reads.push_back(wire.stage.empty() ? "file:" + wire.file.string() : wire.stage);
      }
      result_.stages.push_back(std::move(record));
      if (result_.outcome != Outcome::done) {
        result_.stages.back().reason = "the run ended before";
      } else {
        guarded(*stage, ++place, stages.size());
      }
    }
    finish();
    return std::move(result_);
  }

 private:
  // ---------------------------------------------------------------- which stages

  void check_stage_choice() const {
    if (int{request_.only.has_value()} + int{request_.from.has_value()} + int{request_.until.has_value()} >
        1) {
      throw InputError("bad-setting", "--only, --from and --until exclude each other");
    }
    std::vector<std::string> known;
    for (const StageDefinition& s : definition_->stages) known.push_back(s.name);
    if (definition_->session_is_description()) known.push_back(session_stage);
    for (const auto& choice : {request_.only, request_.from, request_.until}) {
      if (choice && std::find(known.begin(), known.end(), *choice) == known.end()) {
        throw InputError("unknown-stage", fmt::format("the pipeline has no stage `{}`", *choice),
                         data::suggest(*choice, known));
      }
    }
  }

  std::vector<const StageDefinition*> stages_in_order() const {
    std::vector<const StageDefinition*> stages;
    if (session_import_) stages.push_back(&session_import_->stage);
    for (const std::size_t i : definition_->order) stages.push_back(&definition_->stages[i]);
    return stages;
  }

  void choose_stages(const std::vector<const StageDefinition*>& stages) {
    const auto reads = [](const StageDefinition& stage, const std::set<std::string>& names) {
      for (const auto& [port, wires] : stage.inputs) {
        for (const Wire& wire : wires) {
          if (names.contains(wire.stage)) return true;
        }
      }
      return false;
    };
    for (const StageDefinition* stage : stages) chosen_.insert(stage->name);
    if (request_.only) chosen_ = forced_ = {*request_.only};
    if (request_.from) {
      forced_ = {*request_.from};
      for (const StageDefinition* stage : stages) {
        if (reads(*stage, forced_)) forced_.insert(stage->name);
      }
    }
    if (request_.until) {
      chosen_ = {*request_.until};
      for (auto stage = stages.rbegin(); stage != stages.rend(); ++stage) {
        if (!chosen_.contains((*stage)->name)) continue;
        for (const auto& [port, wires] : (*stage)->inputs) {
          for (const Wire& wire : wires) chosen_.insert(wire.stage);
        }
      }
    }
  }

  void remember_earlier_times() {
    try {
      for (StageRecord& record : read_stage_records(folder_.path()))
        earlier_[record.name] = std::move(record);
    } catch (const InputError&) {
      earlier_.clear();  // a first run, or one that was killed: times of reused stages are then unknown
    }
  }

  // ---------------------------------------------------------------- one stage

  /// Runs or reuses a stage; whatever goes wrong ends up in the result.
  void guarded(const StageDefinition& stage, std::size_t place, std::size_t count) {
    try {
      process(stage, place, count);
      return;
    } catch (const Interrupted&) {
      result_.outcome = Outcome::interrupted;
      result_.errors.push_back({Severity::error, "interrupted",
                                fmt::format("the run was stopped in stage `{}`", stage.name), std::nullopt,
                                "run it again to go on"});
    } catch (const InputError& error) {
      result_.outcome = Outcome::input_error;
      result_.errors = error.diagnostics();
    } catch (const FailedWithOutput& failure) {
      result_.outcome = Outcome::numerical_failure;
      result_.errors.push_back({Severity::error, "no-convergence", failure.what(), std::nullopt,
                                "what was reached until then is stored, and shown in the report"});
    } catch (const data::ConvergenceFailure& failure) {
      result_.outcome = Outcome::numerical_failure;
      result_.errors.push_back({Severity::error, "no-convergence", failure.what(), std::nullopt, {}});
    } catch (const std::bad_alloc&) {
      result_.outcome = Outcome::numerical_failure;
      result_.errors.push_back({Severity::error,
                                "out-of-memory",
                                fmt::format("stage `{}` ran out of memory", stage.name),
                                std::nullopt,
                                {}});
    } catch (const std::exception& defect) {
      result_.outcome = Outcome::numerical_failure;
      result_.errors.push_back({Severity::error, "internal-error",
                                fmt::format("stage `{}` broke down: {}", stage.name, defect.what()),
                                std::nullopt, "this is a defect of the program, not of your input"});
    }
    StageRecord& record = result_.stages.back();
    record.status = StageStatus::failed;
    result_.failed_stage = record.name;
    observer_.stage_ends(record, result_.errors);
  }

  void process(const StageDefinition& stage, std::size_t place, std::size_t count) {
    StageRecord& record = result_.stages.back();
    if (!chosen_.contains(stage.name)) return skip(stage, record);
    record.fingerprint = wanted_fingerprint(stage);
    const std::string difference = difference_from_stored(record);
    if (!forced_.contains(stage.name) && difference.empty()) {
      try {
        data_[stage.name] = load_stage(record.output, stage.name);
        record.status = StageStatus::reused;
        record.reason = "its output stands";
      } catch (const InputError&) {
        record.reason = "its output is damaged";
      }
    } else {
      record.reason = !difference.empty() ? difference
                      : request_.only     ? "asked for with --only"
                                          : "asked for with --from";
    }
    if (record.status == StageStatus::reused) {
      if (const auto before = earlier_.find(stage.name); before != earlier_.end()) {
        record.seconds = before->second.seconds;
        record.started = before->second.started;
        record.ended = before->second.ended;
      }
    } else {
      run(stage, record, place, count);
    }
    write_exports(stage, record, data_.at(stage.name));
    record.findings = data_.at(stage.name).diagnostics;
    observer_.stage_ends(record, record.findings);
  }

  /// A stage that was not asked for: its stored output is shown in the report if it stands.
  void skip(const StageDefinition& stage, StageRecord& record) {
    record.reason = "not asked for";
    try {
      record.fingerprint = wanted_fingerprint(stage);
      const std::string difference = difference_from_stored(record);
      if (difference.empty()) {
        data_[stage.name] = load_stage(record.output, stage.name);
      } else {
        record.reason += "; its stored output is out of date: " + difference;
      }
    } catch (const InputError&) {
      record.reason += "; it has no usable stored output";
    }
  }

  void run(const StageDefinition& stage, StageRecord& record, std::size_t place, std::size_t count) {
    observer_.stage_begins(record, place, count);
    record.started = utc_now();
    const auto begin = std::chrono::steady_clock::now();
    StageContext context;
    context.name = stage.name;
    context.options = &stage.options;
    context.scene = definition_->scene ? &*definition_->scene : nullptr;
    context.threads = threads_;
    for (const auto& [port, wires] : stage.inputs) {
      for (const Wire& wire : wires) context.inputs[port].push_back(&input(wire));
    }
    try {
      context.trials = select_trials(*stage.spec, context.inputs, stage.trials);
    } catch (const InputError& mistakes) {
      std::vector<Diagnostic> placed = mistakes.diagnostics();
      for (Diagnostic& d : placed) d.where = stage.trials_where;
      throw InputError(std::move(placed));
    }
    std::mutex mutex;
    context.progress = [&](double fraction, const std::string& what) {
      if (request_.stop && *request_.stop) throw Interrupted();
      const std::lock_guard lock(mutex);
      observer_.stage_progress(record, fraction, what);
    };
    context.say = [&](const std::string& line) {
      observer_.message(fmt::format("{}: {}", stage.name, line));
    };
    context.made_from = record.fingerprint;
    context.beside = record.output.parent_path() / record.output.stem();
    context.progress(0.0, "");
    io::StageFileWriter writer(record.output);
    GuardedSink sink(writer, request_.stop);
    StageOutput output;
    output.signals = &sink;
    stage.spec->run(context, output);
    if (stage.spec->output == PortType::subject && !output.subject) {
      throw std::logic_error(fmt::format("`{}` gives a subject, but left none", stage.spec->name));
    }
    if (!sink.begun()) writer.begin({});
    const std::optional<std::string> failure = output.failure;
    if (!output.files.empty()) output.attributes["files"] = fmt::format("{}", fmt::join(output.files, "\n"));
    if (failure) record.fingerprint["failed"] = *failure;
    writer.finish({std::move(output.tables), std::move(output.attributes), std::move(output.diagnostics),
                   std::move(output.subject), record.fingerprint});
    data_[stage.name] = load_stage(record.output, stage.name);
    record.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    record.ended = utc_now();
    if (failure) {
      record.findings = data_.at(stage.name).diagnostics;
      throw FailedWithOutput(*failure);
    }
    record.status = StageStatus::done;
  }

  // ---------------------------------------------------------------- inputs

  fs::path stored_output(const std::string& stage) const {
    if (stage == session_stage && session_import_) return output_file(folder_.path(), 0, stage);
    return output_file(folder_.path(), definition_->find(stage)->number, stage);
  }

  bool is_session_file(const std::string& stage) const {
    return stage == session_stage && !session_import_ && !definition_->session.empty();
  }

  const StageData& input(const Wire& wire) {
    const std::string key = wire.stage.empty() ? "file:" + wire.file.string() : wire.stage;
    if (const auto found = data_.find(key); found != data_.end()) return found->second;
    if (wire.stage.empty()) return data_[key] = load_subject(wire.file);
    if (is_session_file(wire.stage)) return data_[key] = load_session(definition_->session);
    return data_[key] = load_stage(stored_output(wire.stage), wire.stage);
  }

  /// "<source> <digest>" of what a wire brings.
  std::string source_text(const Wire& wire) {
    if (wire.stage.empty())
      return fmt::format("file:{} {}", wire.file.filename().string(), digests_.of(wire.file));
    if (is_session_file(wire.stage)) {
      return fmt::format("recordings:{} {}", definition_->session.filename().string(),
                         digests_.of(definition_->session));
    }
    if (const StageRecord* record = result_.find(wire.stage);
        record && (record->status == StageStatus::done || record->status == StageStatus::reused)) {
      return fmt::format("{} {}", wire.stage, digest(record->fingerprint));
    }
    const auto stored = io::read_fingerprint(stored_output(wire.stage));
    if (!stored) {
      throw InputError(
          "no-stored-output",
          fmt::format("stage `{}` has no stored output in `{}`", wire.stage, folder_.path().string()),
          fmt::format("run it first: --until {}", wire.stage));
    }
    return fmt::format("{} {}", wire.stage, digest(*stored));
  }

  Fingerprint wanted_fingerprint(const StageDefinition& stage) {
    if (session_import_ && &stage == &session_import_->stage) return session_import_->fingerprint(digests_);
    Fingerprint parts = stage_fingerprint(stage);
    parts["program"] = program_version();
    if (!scene_digest_.empty()) parts["scene"] = scene_digest_;
    Options options = stage.options;
    for_each_file(options, stage.spec->options,
                  [&](const OptionSpec& option, std::string& path, const data::SourceSpan&) {
                    const auto add = [&](const fs::path& file) {
                      std::string& part = parts[fmt::format("asset.{}", file.filename().string())];
                      part += fmt::format("{}{} {}", part.empty() ? "" : ", ", option.key,
                                          digests_.of(file));  // files of one name
                    };
                    add(path);
                    if (!option.files_within) return;
                    for (const fs::path& file : option.files_within(path)) add(file);
                  });
    for (const auto& [port, wires] : stage.inputs) {
      for (std::size_t i = 0; i < wires.size(); ++i)
        parts[fmt::format("input.{}.{}", port, i)] = source_text(wires[i]);
    }
    return parts;
  }

  /// Why the stored output does not do; empty if it does.
  static std::string difference_from_stored(const StageRecord& record) {
    std::error_code ignored;
    if (!fs::exists(record.output, ignored)) return "no output yet";
    const auto stored = io::read_fingerprint(record.output);
    return stored ? difference_text(*stored, record.fingerprint) : "its output is unreadable";
  }

  // ---------------------------------------------------------------- the end

  void finish() {
    for (const Expectation& expectation : definition_->expectations) {
      const auto found = data_.find(expectation.stage);
      const StageRecord* record = result_.find(expectation.stage);
      const bool ran =
          record && (record->status == StageStatus::done || record->status == StageStatus::reused);
      result_.expectations.push_back(
          check_expectation(expectation, ran && found != data_.end() ? &found->second : nullptr));
      const ExpectationResult& last = result_.expectations.back();
      if (last.checked && !last.passed && result_.outcome == Outcome::done)
        result_.outcome = Outcome::expectation_failed;
    }
    result_.files = digests_.used();
    result_.ended = utc_now();
    result_.verdict = verdict_of(result_, data_);
    saving([&] {
      for (const StageDefinition& stage : definition_->stages) {
        if (!data_.contains(stage.name)) continue;
        for (const auto& [port, wires] : stage.inputs) {
          for (const Wire& wire : wires)
            input(wire);  // chapters draw what a stage read, also where it was reused
        }
      }
      io::write_text_atomically(folder_.path() / "report.html",
                                report::render_html(assemble_report(result_, data_)));
    });
    saving([&] { digests_.save(); });
    saving([&] { write_records(result_); });
  }

  /// Writes a part of what a run leaves; a failure changes the outcome, but the other parts are written all
  /// the same.
  template <class F>
  void saving(F write) {
    const bool good = result_.outcome == Outcome::done || result_.outcome == Outcome::expectation_failed;
    try {
      write();
    } catch (const InputError& error) {
      for (const Diagnostic& d : error.diagnostics()) result_.errors.push_back(d);
      if (good) result_.outcome = Outcome::input_error;
    } catch (const std::exception& defect) {
      result_.errors.push_back({Severity::error, "internal-error",
                                fmt::format("the report could not be written: {}", defect.what()),
                                std::nullopt,
                                "this is a defect of the program; the outputs of the stages are whole"});
      if (good) result_.outcome = Outcome::numerical_failure;
    }
  }

  const RunRequest request_;
  const std::shared_ptr<const Definition> definition_;
  const RunFolder folder_;
  RunLog observer_;
  FileDigests digests_;
  std::optional<SessionImport> session_import_;
  std::string scene_digest_;
  std::size_t threads_ = 1;
  std::set<std::string> chosen_, forced_;
  std::map<std::string, StageRecord> earlier_;
  RunData data_;
  RunResult result_;
};

}  // namespace

RunResult run_pipeline(const Catalogue& catalogue, const RunRequest& request, RunObserver& observer) {
  return Run(catalogue, request, observer).execute();
}

}  // namespace brachium::pipelines
