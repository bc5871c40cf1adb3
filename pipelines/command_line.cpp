#include "pipelines/command_line.hpp"

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "data/io/atomic_file.hpp"
#include "data/io/session_description.hpp"
#include "data/io/session_file.hpp"
#include "pipelines/definition.hpp"
#include "pipelines/describe.hpp"
#include "pipelines/error_codes.hpp"
#include "pipelines/inspect.hpp"
#include "pipelines/progress.hpp"
#include "pipelines/run_records.hpp"
#include "pipelines/runner.hpp"
#include "pipelines/version.hpp"

namespace brachium::pipelines {
namespace {

namespace fs = std::filesystem;
using data::InputError;
using nlohmann::json;

/// What the user gave, for all commands.
struct Arguments {
  std::string file, second, only, from, until, out;
  std::vector<std::string> settings;
  std::size_t threads = 0;
  bool quiet = false, as_json = false, markdown = false;
};

std::optional<std::string> given(const std::string& text) {
  return text.empty() ? std::nullopt : std::optional(text);
}

json errors_json(const std::vector<data::Diagnostic>& errors, const std::string& outcome, int code) {
  json out{{"outcome", outcome}, {"exit_code", code}, {"errors", json::array()}};
  for (const data::Diagnostic& d : errors) {
    json entry{{"code", d.code}, {"message", d.message}, {"help", d.help}};
    if (d.where)
      entry["where"] = {{"file", d.where->file}, {"line", d.where->line}, {"column", d.where->column}};
    out["errors"].push_back(std::move(entry));
  }
  return out;
}

std::string dump(const json& value) {
  return value.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

int run(const Arguments& a, const Catalogue& catalogue, const Console& console,
        std::vector<std::string> command_line) {
  RunRequest request;
  request.definition = a.file;
  request.settings = a.settings;
  request.only = given(a.only);
  request.from = given(a.from);
  request.until = given(a.until);
  request.out = a.out;
  request.threads = a.threads;
  request.command_line = std::move(command_line);
  request.stop = console.stop;
  ProgressPrinter progress(console.err, console.err_is_terminal, a.quiet);
  const RunResult result = run_pipeline(catalogue, request, progress);
  if (a.as_json) console.out << dump(result_json(result));
  if (!result.errors.empty()) {
    if (!result.failed_stage.empty()) console.err << fmt::format("stage `{}` failed\n", result.failed_stage);
    console.err << data::render(result.errors);
  }
  if (!result.expectations.empty() && (!a.quiet || result.outcome == Outcome::expectation_failed))
    console.err << expectation_table(result.expectations);
  if (!a.as_json) {
    if (!result.verdict.empty()) console.out << result.verdict << "\n";
    console.out << "report: " << (result.folder / "report.html").string() << "\n";
  }
  return exit_code(result.outcome);
}

int check(const Arguments& a, const Catalogue& catalogue, const Console& console) {
  const Definition definition = read_definition(a.file, a.settings, catalogue, StageChecks::run);
  if (!a.quiet) console.err << data::render(definition.warnings);
  if (a.as_json) {
    console.out << dump(errors_json({}, "done", 0));
  } else {
    console.out << fmt::format("{}: {} stages, no mistakes\n", a.file, definition.stages.size());
  }
  return 0;
}

int explain(const Arguments& a, const Catalogue& catalogue, const Console& console) {
  if (const StageSpec* stage = catalogue.find(a.file)) {
    console.out << explain_stage(*stage);
    return 0;
  }
  if (const auto meaning = explain_error(a.file)) {
    console.out << fmt::format("{}: {}\n", a.file, *meaning);
    return 0;
  }
  std::vector<std::string> known = catalogue.names();
  for (const ErrorCode& code : error_codes()) known.push_back(code.code);
  throw InputError("unknown-stage", fmt::format("`{}` is neither a stage nor the code of a finding", a.file),
                   data::suggest(a.file, known));
}

int create(const Arguments& a, const Catalogue& catalogue, const Console& console) {
  const fs::path file = (a.second.empty() ? a.file : a.second) + ".toml";
  const std::string text = render_template(a.file, file.stem().string(), catalogue);
  std::error_code ignored;
  if (fs::exists(file, ignored))
    throw InputError("file-exists", fmt::format("`{}` exists already", file.string()), "give another name");
  io::write_text_atomically(file, text);
  console.out << file.string() << "\n";
  return 0;
}

int import(const Arguments& a, const Console& console) {
  std::map<std::string, std::string> overrides;
  for (const std::string& setting : a.settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos || equals == 0)
      throw InputError("bad-setting", fmt::format("`{}` is not of the form KEY=VALUE", setting),
                       "for example --set recordings=folder");
    overrides[setting.substr(0, equals)] = setting.substr(equals + 1);
  }
  const io::SessionDescription description = io::read_session_description(a.file, overrides);
  ProgressPrinter progress(console.err, console.err_is_terminal, a.quiet);
  StageRecord record;
  record.name = "import";
  record.run = "session.import";
  record.reason = a.file;
  progress.stage_begins(record, 1, 1);
  io::SessionFileWriter writer(a.out);
  const auto findings =
      io::import_session(description, writer, [&](double fraction, const std::string& what) {
        if (console.stop && *console.stop) throw Interrupted();
        progress.stage_progress(record, fraction, what);
      });
  writer.commit();
  progress.stage_ends(record, findings);
  console.out << a.out << "\n";
  return 0;
}

int compare(const Arguments& a, const Console& console) {
  const std::string differences = compare_runs(a.file, a.second);
  console.out << (differences.empty() ? "no differences\n" : differences);
  return 0;
}

/// Runs what was asked for; every failure becomes an exit code and a text.
int guarded(const std::function<int()>& command, const Arguments& a, const Console& console) {
  const auto fail = [&](const std::vector<data::Diagnostic>& errors, const std::string& outcome, int code) {
    if (a.as_json) console.out << dump(errors_json(errors, outcome, code));
    console.err << data::render(errors);
    return code;
  };
  try {
    return command();
  } catch (const InputError& error) {
    return fail(error.diagnostics(), "input error", 2);
  } catch (const data::ConvergenceFailure& failure) {
    return fail({{data::Severity::error, "no-convergence", failure.what(), std::nullopt, {}}},
                "numerical failure", 1);
  } catch (const Interrupted&) {
    return fail({{data::Severity::error, "interrupted", "stopped", std::nullopt, {}}}, "interrupted", 130);
  } catch (const std::exception& defect) {
    return fail({{data::Severity::error, "internal-error", defect.what(), std::nullopt,
                  "this is a defect of the program, not of your input"}},
                "numerical failure", 1);
  }
}

}  // namespace

int command_line(int argc, const char* const* argv, const Catalogue& catalogue, Console console) {
  Arguments a;
  CLI::App app{"Brachium: from recorded EMG of the upper limb to joint moments, stage by stage"};
  app.set_version_flag("--version", program_version());
  app.require_subcommand(1);
  std::function<int()> command;

  const auto settings = [&](CLI::App* sub) {
    sub->add_option("--set", a.settings,
                    "change a key: stage.option=value, pipeline.key=value, variable=value")
        ->allow_extra_args(false);
  };
  CLI::App* sub = app.add_subcommand("run", "run a pipeline");
  sub->add_option("FILE", a.file, "definition")->required();
  sub->add_option("--only", a.only, "run this stage alone, from stored inputs");
  sub->add_option("--from", a.from, "run this stage and all that depends on it again");
  sub->add_option("--until", a.until, "run only this stage and what it needs");
  settings(sub);
  sub->add_option("--out", a.out, "run folder (default: runs/<name of the definition>)");
  sub->add_option("--threads", a.threads, "number of threads (0: all cores)")->check(CLI::Range(0, 1024));
  sub->add_flag("--quiet", a.quiet, "no progress");
  sub->add_flag("--json", a.as_json, "the result as JSON on standard output");
  sub->callback([&] { command = [&] { return run(a, catalogue, console, {argv, argv + argc}); }; });

  sub = app.add_subcommand("check", "find every mistake of a definition without running it");
  sub->add_option("FILE", a.file, "definition")->required();
  settings(sub);
  sub->add_flag("--quiet", a.quiet, "no warnings");
  sub->add_flag("--json", a.as_json, "the result as JSON on standard output");
  sub->callback([&] { command = [&] { return check(a, catalogue, console); }; });

  sub = app.add_subcommand("new", "write a definition to start from");
  sub->add_option("TEMPLATE", a.file, "template")->required()->check(CLI::IsMember(template_names()));
  sub->add_option("NAME", a.second, "name of the new definition");
  sub->callback([&] { command = [&] { return create(a, catalogue, console); }; });

  sub = app.add_subcommand("explain", "a stage with its options, or the code of an error");
  sub->add_option("STAGE|CODE", a.file, "for example emg.envelope or unknown-key")->required();
  sub->callback([&] { command = [&] { return explain(a, catalogue, console); }; });

  sub = app.add_subcommand("stages", "list all stages");
  sub->callback([&] { command = [&] { return console.out << stage_list(catalogue), 0; }; });

  sub = app.add_subcommand("manual", "all stages with all options, as Markdown");
  sub->callback([&] { command = [&] { return console.out << manual(catalogue), 0; }; });

  sub = app.add_subcommand("import", "bring recordings into a session file");
  sub->add_option("DESCRIPTION", a.file, "session description")->required();
  sub->add_option("-o,--output", a.out, "session file")->required();
  settings(sub);
  sub->add_flag("--quiet", a.quiet, "no progress");
  sub->callback([&] { command = [&] { return import(a, console); }; });

  sub = app.add_subcommand("inspect", "what a file or run folder holds");
  sub->add_option("FILE", a.file, "session, output, subject, scene, description, definition or run folder")
      ->required();
  sub->callback([&] { command = [&] { return console.out << inspect(a.file, catalogue), 0; }; });

  sub = app.add_subcommand("report", "write the report of a run again");
  sub->add_option("RUN", a.file, "run folder")->required();
  sub->callback([&] {
    command = [&] { return console.out << write_report_again(catalogue, a.file).string() << "\n", 0; };
  });

  sub = app.add_subcommand("compare", "differences of two runs");
  sub->add_option("RUN", a.file, "first run folder")->required();
  sub->add_option("OTHER", a.second, "second run folder")->required();
  sub->callback([&] { command = [&] { return compare(a, console); }; });

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error, console.out, console.err) == 0 ? 0 : 2;
  }
  return guarded(command, a, console);
}

}  // namespace brachium::pipelines
