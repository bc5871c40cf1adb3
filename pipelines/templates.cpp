#include <fmt/format.h>

#include <stdexcept>

#include "pipelines/definition.hpp"
#include "pipelines/describe.hpp"
#include "pipelines/options.hpp"

namespace brachium::pipelines {
namespace {

struct TemplateStage {
  std::string name, run;
  std::string lines;  ///< input, trials and options that the template gives
};

struct Template {
  std::string name, summary;
  bool scene = false;
  std::vector<TemplateStage> stages;
};

const std::vector<Template>& templates() {
  static const std::vector<Template> all{
      {"emg",
       "From raw EMG to normalised excitations, with the quality of every channel.",
       false,
       {{"quality", "emg.quality", ""},
        {"excitation", "emg.envelope", "input = { quality = \"quality\" }\n"},
        {"onset", "emg.onset", ""}}},
      {"calibration",
       "From raw EMG and motion to a calibrated joint moment, its error on trials that the calibration never "
       "saw, and a subject to reuse.",
       true,
       {{"quality", "emg.quality", ""},
        {"excitation", "emg.envelope", "input = { quality = \"quality\" }\n"},
        {"kinematics", "limb.kinematics", ""},
        {"moment", "limb.inverse_dynamics", ""},
        {"validation", "optimise.cross_validate",
         "input = { excitation = \"excitation\", kinematics = \"kinematics\", moment = \"moment\" }\n"},
        {"subject", "optimise.calibrate",
         "input = { excitation = \"excitation\", kinematics = \"kinematics\", moment = \"moment\" }\n"},
        {"activation", "emg.activation", "input = { excitation = \"excitation\", subject = \"subject\" }\n"},
        {"fim", "hill.moment",
         "input = { activation = \"activation\", kinematics = \"kinematics\", subject = \"subject\" }\n"}}}};
  return all;
}

std::string comment_lines(const StageSpec& spec, const std::string& given) {
  std::string out;
  for (const OptionSpec& option : spec.options) {
    if (given.find(option.key + " = ") != std::string::npos) continue;
    const std::string value = option.fallback ? value_text(*option.fallback) : "...";
    const std::string range = range_text(option);
    out += fmt::format("{}{} = {}  # {}{}\n", option.fallback || option.optional ? "# " : "", option.key,
                       option.fallback || option.optional ? value : "\"\"", option.doc,
                       range.empty() ? "" : " (" + range + ")");
  }
  return out;
}

}  // namespace

std::vector<std::string> template_names() {
  std::vector<std::string> names;
  for (const Template& t : templates()) names.push_back(t.name);
  return names;
}

std::string render_template(const std::string& name, const std::string& title, const Catalogue& catalogue) {
  const Template* chosen = nullptr;
  for (const Template& t : templates()) {
    if (t.name == name) chosen = &t;
  }
  if (!chosen)
    throw data::InputError("unknown-template", fmt::format("there is no template `{}`", name),
                           data::suggest(name, template_names()));
  std::string out = fmt::format(
      "# {}\n# Lines that start with `# ` show defaults: change them by removing the `# `. Paths are "
      "relative to this file.\n"
      "# `brachium check FILE` says what is missing, `brachium explain STAGE` tells more of a stage.\n\n",
      chosen->summary);
  out += fmt::format(
      "[pipeline]\ntitle = {}\nsession = \"session.h5\"  # or a session description, session.toml\n",
      node_text(io::TomlNode::of(title)));
  if (chosen->scene) out += "scene = \"scene.toml\"\n";
  out += "# threads = 0  # 0: all cores\n";
  for (const TemplateStage& stage : chosen->stages) {
    const StageSpec* spec = catalogue.find(stage.run);
    if (!spec) throw std::logic_error(fmt::format("template `{}` needs the stage `{}`", name, stage.run));
    out += fmt::format("\n# {}\n[[stage]]\nname = \"{}\"\nrun = \"{}\"\n# trials = [\"*\"]\n", spec->summary,
                       stage.name, stage.run);
    out += stage.lines + comment_lines(*spec, stage.lines);
  }
  return out +
         "\n# Expected numbers, checked at the end of a run:\n# [[expect]]\n# stage = \"...\"\n# table = "
         "\"...\"\n# where = {}\n"
         "# column = \"...\"\n# value = 0.0\n# tolerance = 0.0  # or min = ..., max = ...\n";
}

}  // namespace brachium::pipelines
