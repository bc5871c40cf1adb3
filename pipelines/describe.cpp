#include "pipelines/describe.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>

#include "pipelines/definition.hpp"
#include "pipelines/options.hpp"

namespace brachium::pipelines {
namespace {

/// Text broken into lines of at most `width` characters, each after `indent`; paragraphs are kept.
std::string wrapped(const std::string& text, const std::string& indent, std::size_t width = 96) {
  std::string out, line;
  std::istringstream lines(text);
  for (std::string paragraph; std::getline(lines, paragraph);) {
    std::istringstream words(paragraph);
    line.clear();
    for (std::string word; words >> word;) {
      if (!line.empty() && indent.size() + line.size() + 1 + word.size() > width) {
        out += indent + line + "\n";
        line.clear();
      }
      line += (line.empty() ? "" : " ") + word;
    }
    out += line.empty() ? "\n" : indent + line + "\n";
  }
  return out;
}

std::string default_text(const OptionSpec& option) {
  if (option.fallback) return value_text(*option.fallback);
  return option.optional ? "none" : "required";
}

std::string kind_text(const OptionSpec& option) {
  std::string text = to_string(option.type);
  if (!option.unit.empty() && option.unit != "1") text += " [" + option.unit + "]";
  if (const std::string range = range_text(option); !range.empty()) text += ", " + range;
  if (!option.allowed.empty()) text += fmt::format(", one of {}", fmt::join(option.allowed, ", "));
  return text;
}

std::string need_text(const InputSpec& port) {
  std::string text = to_string(port.type);
  if (port.many) text += " of one or more stages";
  if (port.defaults_to_session) text += "; the session where not wired";
  if (port.optional) text += "; optional";
  return text;
}

std::string escaped_cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

void option_lines(const std::vector<OptionSpec>& options, const std::string& indent, std::string& out) {
  for (const OptionSpec& option : options) {
    out += fmt::format("{}{} = {}\n", indent, option.key, default_text(option));
    out += wrapped(fmt::format("{}. {}", kind_text(option), option.doc), indent + "    ");
    option_lines(option.fields, indent + "      ", out);
  }
}

void option_rows(const std::vector<OptionSpec>& options, const std::string& prefix, std::string& out) {
  for (const OptionSpec& option : options) {
    out += fmt::format("| `{}{}` | {} | `{}` | {} |\n", prefix, option.key, escaped_cell(kind_text(option)),
                       escaped_cell(default_text(option)), escaped_cell(option.doc));
    option_rows(option.fields, prefix + option.key + ".", out);
  }
}

}  // namespace

std::string explain_stage(const StageSpec& stage) {
  std::string out = fmt::format("{}: {}\n\n", stage.name, stage.summary);
  if (!stage.doc.empty()) out += wrapped(stage.doc, "") + "\n";
  out += fmt::format("gives {}{}\n\n", to_string(stage.output), stage.needs_scene ? "; needs a scene" : "");
  if (!stage.inputs.empty()) out += "inputs\n";
  for (const InputSpec& port : stage.inputs) {
    out += fmt::format("  {}  ({})\n", port.name, need_text(port)) + wrapped(port.doc, "      ");
  }
  if (!stage.options.empty()) out += fmt::format("{}options\n", stage.inputs.empty() ? "" : "\n");
  option_lines(stage.options, "  ", out);
  return out;
}

std::string stage_list(const Catalogue& catalogue) {
  std::size_t width = 0;
  for (const StageSpec& stage : catalogue.stages()) width = std::max(width, stage.name.size());
  std::string out;
  for (const StageSpec& stage : catalogue.stages())
    out += fmt::format("{:<{}}  {}\n", stage.name, width, stage.summary);
  return out;
}

std::string manual(const Catalogue& catalogue) {
  std::string out = "# Stages\n";
  for (const StageSpec& stage : catalogue.stages()) {
    out += fmt::format("\n## {}\n\n{}\n\n", stage.name, stage.summary);
    if (!stage.doc.empty()) out += stage.doc + "\n\n";
    out += fmt::format("Gives {}.{}\n", to_string(stage.output), stage.needs_scene ? " Needs a scene." : "");
    if (!stage.inputs.empty()) out += "\n| input | takes | meaning |\n|---|---|---|\n";
    for (const InputSpec& port : stage.inputs) {
      out += fmt::format("| `{}` | {} | {} |\n", port.name, escaped_cell(need_text(port)),
                         escaped_cell(port.doc));
    }
    if (!stage.options.empty()) out += "\n| option | value | default | meaning |\n|---|---|---|---|\n";
    option_rows(stage.options, "", out);
  }
  return out;
}

}  // namespace brachium::pipelines
