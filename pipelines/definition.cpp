#include "pipelines/definition.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "data/io/scene_file.hpp"
#include "data/io/session_description.hpp"
#include "data/io/session_file.hpp"
#include "data/io/subject_file.hpp"
#include "pipelines/options.hpp"
#include "pipelines/settings.hpp"

namespace brachium::pipelines {
namespace {

using data::Diagnostic;
using data::InputError;
using data::Severity;
using io::TomlNode;
namespace fs = std::filesystem;

/// Keys of [[stage]] that belong to the pipeline, not to the stage's options.
const std::array<std::string, 5> stage_keys{"name", "run", "input", "trials", "export_sto"};

class Reader {
 public:
  Reader(const fs::path& file, std::span<const std::string> settings, const Catalogue& catalogue,
         StageChecks checks)
      : catalogue_(catalogue), checks_(checks), root_(io::read_toml(file)) {
    definition_.file = fs::absolute(file).lexically_normal();
    folder_ = definition_.file.parent_path();
    definition_.settings.assign(settings.begin(), settings.end());
  }

  Definition read() {
    AppliedSettings applied =
        apply_settings(root_, definition_.settings, folder_, fs::current_path(), diagnostics_);
    definition_.variables = std::move(applied.variables);
    definition_.session_overrides = std::move(applied.session_overrides);
    io::TomlTable root(root_, diagnostics_, "a pipeline definition");
    read_pipeline(root);
    read_stages(root);
    definition_.expectations = parse_expectations(root, diagnostics_);
    if (root.has("variables")) root.table("variables");
    root.finish();
    read_session();
    read_scene();
    for (std::size_t i = 0; i < definition_.stages.size(); ++i) check_inputs(i);
    for (const StageDefinition& stage : definition_.stages) check_trials(stage);
    if (checks_ == StageChecks::run) {
      for (const StageDefinition& stage : definition_.stages) check_stage(stage);
    }
    for (const Expectation& e : definition_.expectations)
      check_stage_name(e.stage, "expected number", e.place);
    definition_.order = topological_order(definition_.stages, diagnostics_);
    io::raise_if_errors(diagnostics_);
    for (const Diagnostic& d : diagnostics_) definition_.warnings.push_back(d);
    return std::move(definition_);
  }

 private:
  void error(const char* code, std::string message, const data::SourceSpan& where, std::string help = {}) {
    diagnostics_.push_back({Severity::error, code, std::move(message), where, std::move(help)});
  }

  fs::path resolve(const std::string& path) const {
    return fs::path(path).is_absolute() ? fs::path(path) : (folder_ / path).lexically_normal();
  }

  bool file_exists(const fs::path& path, const data::SourceSpan& where, const std::string& what) {
    std::error_code ignored;
    if (fs::is_regular_file(path, ignored)) return true;
    error("missing-file", fmt::format("the {} `{}` does not exist", what, path.string()), where,
          fmt::format("paths in a definition are relative to its folder, `{}`", folder_.string()));
    return false;
  }

  void read_pipeline(io::TomlTable& root) {
    auto pipeline = root.table("pipeline");
    if (!pipeline) {
      if (!root.has("pipeline"))
        error("missing-key", "the definition has no table [pipeline]", root_.where,
              "start it with [pipeline] and a title");
      return;
    }
    definition_.title = pipeline->require_text("title");
    if (const auto session = pipeline->text("session")) {
      session_where_ = pipeline->span_of("session");
      if (file_exists(resolve(*session), session_where_, "session")) definition_.session = resolve(*session);
      names_session_ = true;
    }
    if (const auto scene = pipeline->text("scene")) {
      scene_where_ = pipeline->span_of("scene");
      if (file_exists(resolve(*scene), scene_where_, "scene")) definition_.scene_file = resolve(*scene);
      names_scene_ = true;
    }
    if (auto given = pipeline->table("session_settings")) {
      // What the command line gave to the session description comes after what the definition gives.
      for (const auto& [key, value] : given->node().members) {
        std::string text = node_text(value);
        if (key == "recordings" && value.kind == TomlNode::Kind::text)
          text = node_text(TomlNode::of(resolve(value.text).string()));
        definition_.session_overrides.emplace(key, std::move(text));
      }
    }
    if (const auto threads = pipeline->integer("threads")) {
      if (*threads < 0 || *threads > 1024)
        pipeline->error("out-of-range", "`threads` must lie in 0 (all cores) to 1024", "threads");
      definition_.threads = static_cast<std::size_t>(std::clamp<std::int64_t>(*threads, 0, 1024));
    }
    pipeline->finish();
  }

  void read_stages(io::TomlTable& root) {
    if (!root.has("stage")) {
      error("missing-key", "the definition has no [[stage]]", root_.where,
            "`brachium stages` lists what there is");
      return;
    }
    for (io::TomlTable entry : root.tables("stage")) {
      StageDefinition stage;
      stage.number = definition_.stages.size() + 1;
      stage.where = entry.node().where;
      stage.name = entry.require_text("name");
      if (!stage.name.empty()) check_new_name(stage.name, entry.span_of("name"));
      const std::string run = entry.require_text("run");
      stage.spec = catalogue_.find(run);
      if (!run.empty() && !stage.spec) {
        entry.error("unknown-stage", fmt::format("there is no stage `{}`", run), "run",
                    data::suggest(run, catalogue_.names()));
      }
      if (const auto trials = entry.texts("trials")) {
        stage.trials = *trials;
        stage.trials_where = entry.span_of("trials");
        if (trials->empty())
          entry.error("out-of-range", fmt::format("`trials` of stage `{}` is an empty list", stage.name),
                      "trials", "leave it out for all trials");
      }
      stage.export_sto = entry.boolean("export_sto").value_or(false);
      if (auto input = entry.table("input")) read_wires(*input, stage);
      if (stage.spec) {
        const std::size_t before = diagnostics_.size();
        stage.options = parse_options(entry.node(), stage.spec->options, fmt::format("stage `{}`", run),
                                      stage_keys, diagnostics_);
        for_each_file(stage.options, stage.spec->options,
                      [&](const OptionSpec& option, std::string& path, const data::SourceSpan& where) {
                        path = resolve(path).string();
                        file_exists(path, where, fmt::format("file of option `{}`", option.key));
                      });
        // A key too many leaves the others as they are; what else is wrong leaves options without a value.
        stage_sound_.push_back(std::all_of(diagnostics_.begin() + static_cast<std::ptrdiff_t>(before),
                                           diagnostics_.end(),
                                           [](const Diagnostic& d) { return d.code == "unknown-key"; }));
      } else {
        stage_sound_.push_back(false);
      }
      definition_.stages.push_back(std::move(stage));
    }
  }

  void check_new_name(const std::string& name, const data::SourceSpan& where) {
    const auto good = [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
             c == '-';
    };
    if (!std::all_of(name.begin(), name.end(), good)) {
      error("bad-name", fmt::format("`{}` cannot name a stage", name), where,
            "use letters, digits, `_` and `-`: the name becomes part of a file name");
    }
    if (name == session_stage && names_session_) {
      error("duplicate-stage", "a stage is called `session`, and the pipeline names a session", where,
            "that name stands for the pipeline's own recordings; rename the stage or drop `session` from "
            "[pipeline]");
    }
    if (const StageDefinition* other = definition_.find(name)) {
      error("duplicate-stage", fmt::format("two stages are called `{}`", name), where,
            fmt::format("the other one starts in line {}", other->where.line));
    }
  }

  void read_wires(io::TomlTable& input, StageDefinition& stage) {
    for (const auto& [port, node] : input.node().members) {
      const auto names = input.texts(port);
      if (!names) continue;
      for (std::size_t i = 0; i < names->size(); ++i) {
        const data::SourceSpan& where = node.kind == TomlNode::Kind::array ? node.items[i].where : node.where;
        const std::string& name = (*names)[i];
        Wire wire{name, {}, where};
        if (name.starts_with("file:")) wire = {{}, resolve(name.substr(5)), where};
        stage.inputs[port].push_back(std::move(wire));
      }
    }
  }

  void check_stage_name(const std::string& name, const std::string& what, const data::SourceSpan& where) {
    if (name.empty() || definition_.find(name)) return;
    std::vector<std::string> known;
    for (const StageDefinition& s : definition_.stages) known.push_back(s.name);
    error("unknown-stage",
          fmt::format("{} names the stage `{}`, which the pipeline does not have", what, name), where,
          data::suggest(name, known));
  }

  void check_inputs(std::size_t index) {
    StageDefinition& stage = definition_.stages[index];
    if (!stage.spec) return;
    std::vector<std::string> ports;
    for (const InputSpec& port : stage.spec->inputs) ports.push_back(port.name);
    for (const auto& [port, wires] : stage.inputs) {
      if (std::find(ports.begin(), ports.end(), port) == ports.end()) {
        error(
            "unknown-input", fmt::format("stage `{}` has no input `{}`", stage.name, port),
            wires.empty() ? stage.where : wires.front().where,
            ports.empty() ? fmt::format("`{}` reads nothing", stage.spec->name) : data::suggest(port, ports));
      }
    }
    for (const InputSpec& port : stage.spec->inputs) {
      const bool session_at_hand = names_session_ || definition_.find(session_stage);
      if (!stage.inputs.contains(port.name) && port.defaults_to_session && session_at_hand &&
          stage.name != session_stage) {
        stage.inputs[port.name] = {{session_stage, {}, stage.where}};
      }
      const auto wired = stage.inputs.find(port.name);
      if (wired == stage.inputs.end() || wired->second.empty()) {
        if (!port.optional) {
          error("missing-input",
                fmt::format("stage `{}` (`{}`) needs the input `{}`: {}", stage.name, stage.spec->name,
                            port.name, port.doc),
                stage.where,
                port.defaults_to_session ? "add `session = \"...\"` to [pipeline]"
                                         : fmt::format("add input = {{ {} = \"...\" }}", port.name));
        }
        continue;
      }
      if (!port.many && wired->second.size() > 1) {
        error("too-many-inputs",
              fmt::format("input `{}` of stage `{}` takes one stage, not {}", port.name, stage.name,
                          wired->second.size()),
              wired->second[1].where);
      }
      for (const Wire& wire : wired->second) check_wire(stage, port, wire);
    }
    if (stage.spec->needs_scene && !names_scene_) {
      error("missing-scene",
            fmt::format("stage `{}` (`{}`) needs a scene, and the pipeline names none", stage.name,
                        stage.spec->name),
            stage.where, "add `scene = \"...\"` to [pipeline]");
    }
  }

  void check_wire(const StageDefinition& stage, const InputSpec& port, const Wire& wire) {
    const auto wrong_port = [&](const std::string& what) {
      error("wrong-port",
            fmt::format("input `{}` of stage `{}` takes {}, but {}", port.name, stage.name,
                        to_string(port.type), what),
            wire.where);
    };
    if (wire.stage.empty()) {
      if (port.type != PortType::subject) {
        wrong_port("only a subject can be read from a file");
      } else if (file_exists(wire.file, wire.where, "subject")) {
        try {
          io::read_subject(wire.file);
        } catch (const InputError& mistakes) {
          take(mistakes, wire.where);
        }
      }
      return;
    }
    if (wire.stage == session_stage && names_session_) {
      if (port.type != PortType::signals) wrong_port("the session gives signals");
      return;
    }
    const StageDefinition* source = definition_.find(wire.stage);
    if (!source)
      return check_stage_name(wire.stage, fmt::format("input `{}` of stage `{}`", port.name, stage.name),
                              wire.where);
    // Every stage may leave tables; signals and subjects are what a stage is for.
    if (source->spec && port.type != PortType::tables && source->spec->output != port.type) {
      wrong_port(fmt::format("stage `{}` gives {}", source->name, to_string(source->spec->output)));
    }
  }

  void take(const InputError& mistakes, const data::SourceSpan& where) {
    for (Diagnostic d : mistakes.diagnostics()) {
      if (!d.where) d.where = where;
      diagnostics_.push_back(std::move(d));
    }
  }

  void read_session() {
    if (definition_.session.empty()) return;
    try {
      if (definition_.session_is_description()) {
        const io::SessionDescription description =
            io::read_session_description(definition_.session, definition_.session_overrides);
        for (const io::TrialDescription& trial : description.trials) trials_.push_back(trial.info.name);
        for (Diagnostic& d : io::check_session(description)) diagnostics_.push_back(std::move(d));
      } else {
        const io::SessionFile session(definition_.session);
        for (const data::TrialInfo& trial : session.info().trials) {
          trials_.push_back(trial.name);
          for (const data::SignalInfo& signal : trial.signals) {
            if (signal.quantity == data::Quantity::emg &&
                std::find(channels_.begin(), channels_.end(), signal.name) == channels_.end()) {
              channels_.push_back(signal.name);
            }
          }
        }
      }
    } catch (const InputError& mistakes) {
      take(mistakes, session_where_);
    }
  }

  void read_scene() {
    if (definition_.scene_file.empty()) return;
    try {
      definition_.scene = io::read_scene(definition_.scene_file, channels_);
      for (const Diagnostic& d : definition_.scene->notes) definition_.warnings.push_back(d);
    } catch (const InputError& mistakes) {
      take(mistakes, scene_where_);
    }
  }

  void check_stage(const StageDefinition& stage) {
    if (!stage.spec || !stage.spec->check || !stage_sound_[stage.number - 1]) return;
    const data::Scene* scene = definition_.scene ? &*definition_.scene : nullptr;
    if (stage.spec->needs_scene && !scene) return;
    for (Diagnostic d : stage.spec->check({stage.name, &stage.options, scene})) {
      if (!d.where) d.where = stage.where;
      diagnostics_.push_back(std::move(d));
    }
  }

  /// Patterns can be checked now where the stage works on the session itself; others are checked when it
  /// runs.
  void check_trials(const StageDefinition& stage) {
    if (!stage.spec || stage.trials.empty()) return;
    const auto first =
        std::find_if(stage.spec->inputs.begin(), stage.spec->inputs.end(), [&](const InputSpec& port) {
          return port.type == PortType::signals && stage.inputs.contains(port.name);
        });
    if (first == stage.spec->inputs.end()) {
      error("no-match", fmt::format("stage `{}` has `trials`, but reads no signals", stage.name),
            stage.trials_where);
      return;
    }
    const auto& wires = stage.inputs.at(first->name);
    if (trials_.empty() || wires.empty() || wires.front().stage != session_stage) return;
    try {
      data::match_names(stage.trials, trials_, "trial of the session");
    } catch (const InputError& mistakes) {
      take(mistakes, stage.trials_where);
    }
  }

  const Catalogue& catalogue_;
  const StageChecks checks_;
  TomlNode root_;
  fs::path folder_;
  std::vector<Diagnostic> diagnostics_;
  Definition definition_;
  std::vector<bool> stage_sound_;  ///< by stage: its options can be used
  bool names_session_ = false, names_scene_ = false;
  data::SourceSpan session_where_, scene_where_;
  std::vector<std::string> trials_, channels_;  ///< of the session, where known
};

}  // namespace

const StageDefinition* Definition::find(const std::string& stage) const {
  for (const StageDefinition& s : stages) {
    if (s.name == stage) return &s;
  }
  return nullptr;
}

std::string to_string(PortType type) {
  switch (type) {
    case PortType::signals:
      return "signals";
    case PortType::subject:
      return "a subject";
    case PortType::tables:
      return "tables";
  }
  return "signals";
}

Definition read_definition(const fs::path& file, std::span<const std::string> settings,
                           const Catalogue& catalogue, StageChecks checks) {
  return Reader(file, settings, catalogue, checks).read();
}

}  // namespace brachium::pipelines
