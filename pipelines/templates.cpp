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
  bool session = true;
  std::vector<TemplateStage> stages;
};

const std::vector<Template>& templates() {
  static const std::vector<Template> all{
      {"emg",
       "From raw EMG to normalised excitations, with the quality of every channel.",
       false,
       true,
       {{"quality", "emg.quality", ""},
        {"excitation", "emg.envelope", "input = { quality = \"quality\" }\n"},
        {"onset", "emg.onset", ""}}},
      {"calibration",
       "From raw EMG and motion to a calibrated joint moment, its error on trials that the calibration never "
       "saw, and a subject to reuse.",
       true,
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
         "input = { activation = \"activation\", kinematics = \"kinematics\", subject = \"subject\" }\n"}}},
      {"continuum",
       "A continuum muscle with tendons that is stretched, then activated: its force, and its shape to look "
       "at.",
       false,
       false,
       {{"muscle", "fem.solve",
         R"toml(mesh = { spindle = { belly_m = 0.12, belly_radius_m = 0.016, tendon_radius_m = 0.005, origin_tendon_m = 0.03, insertion_tendon_m = 0.03, transition_m = 0.02 } }
# mesh = { file = "muscle.msh", length_unit = "mm", elevate = true }  # your own: Gmsh, VTU, VTK or FEBio
material = [
  { set = "sprenger", incompressible = true },   # of all regions; `regions = ["muscle"]` for one of several
]
fibre = [
  { kind = "harmonic", origin = "origin", insertion = "insertion" },
]
blend = [
  { of = "muscle", field = "gamma_M" },          # 1 muscle, 0 tendon; a field of the mesh, or `value`
]
boundary = [
  { name = "held", surface = "origin", kind = "fixed" },
  { name = "pull", surface = "insertion", kind = "displacement", x_m = 0.0, y_m = 0.0, z_m = 0.012 },
]
phase = [
  { name = "stretch", amplitude = { pull = 1.0 }, steps = 4 },
  { name = "activate", activation = 0.5, steps = 4 },
]
output = [
  { name = "insertion", kind = "reaction", surface = "insertion" },
  { name = "stretch", kind = "fibre_stretch", regions = ["muscle"] },
]
)toml"}}}};
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
  out += fmt::format("[pipeline]\ntitle = {}\n", node_text(io::TomlNode::of(title)));
  if (chosen->session) out += "session = \"session.h5\"  # or a session description, session.toml\n";
  if (chosen->scene) out += "scene = \"scene.toml\"\n";
  out += "# threads = 0  # 0: all cores\n";
  for (const TemplateStage& stage : chosen->stages) {
    const StageSpec* spec = catalogue.find(stage.run);
    if (!spec) throw std::logic_error(fmt::format("template `{}` needs the stage `{}`", name, stage.run));
    out += fmt::format("\n# {}\n[[stage]]\nname = \"{}\"\nrun = \"{}\"\n{}", spec->summary, stage.name,
                       stage.run, chosen->session ? "# trials = [\"*\"]\n" : "");
    out += stage.lines + comment_lines(*spec, stage.lines);
  }
  return out +
         "\n# Expected numbers, checked at the end of a run:\n# [[expect]]\n# stage = \"...\"\n# table = "
         "\"...\"\n# where = {}\n"
         "# column = \"...\"\n# value = 0.0\n# tolerance = 0.0  # or min = ..., max = ...\n";
}

}  // namespace brachium::pipelines
