#include "pipelines/report/findings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>

#include "pipelines/report/build.hpp"

namespace brachium::pipelines::report {
namespace {

using data::Diagnostic;

/// A message taken apart: "without `fold`: " + text, and the first thing in backticks of the text.
struct Message {
  const Diagnostic* diagnostic;
  std::string fold, text, about;
};

Message take_apart(const Diagnostic& diagnostic) {
  Message message{&diagnostic, "", diagnostic.message, ""};
  if (const std::size_t colon = message.text.find("`: ");
      message.text.starts_with("without `") && colon != std::string::npos) {
    message.fold = message.text.substr(8, colon - 7);
    message.text = message.text.substr(colon + 3);
  }
  if (const std::size_t open = message.text.find('`'); open != std::string::npos) {
    const std::size_t close = message.text.find('`', open + 1);
    if (close != std::string::npos) message.about = message.text.substr(open, close - open + 1);
  }
  return message;
}

/// The part of a message that its twins share: up to the first colon, bracket or semicolon.
std::string head_of(const std::string& text) {
  const std::string head = text.substr(0, text.find_first_of(":(;"));
  return head.substr(0, head.find_last_not_of(' ') + 1);
}

/// What is said of the thing: "is AT LOWER BOUND" of "`biceps gain` is AT LOWER BOUND: ...".
std::string said_of(const Message& message) {
  if (message.about.empty()) return "";
  const std::string head = head_of(message.text);
  const std::size_t at = head.find(message.about);
  const std::size_t end = at + message.about.size();
  return at == 0 && end < head.size() ? head.substr(end + 1) : "";
}

struct Thing {
  std::string about;
  std::vector<const Message*> messages;
};

std::vector<Thing> things_of(const std::vector<Message>& messages) {
  std::vector<Thing> things;
  for (const Message& m : messages) {
    auto found =
        std::find_if(things.begin(), things.end(), [&](const Thing& t) { return t.about == m.about; });
    if (found == things.end()) found = things.insert(things.end(), Thing{m.about, {}});
    found->messages.push_back(&m);
  }
  return things;
}

std::string summary_of(const std::string& code, const std::vector<Thing>& things, std::size_t folds) {
  std::vector<std::string> names;
  for (const Thing& t : things) {
    names.push_back(t.messages.size() == 1 ? t.about
                    : folds > 0            ? fmt::format("{} ({} folds)", t.about, t.messages.size())
                                           : fmt::format("{} ({} times)", t.about, t.messages.size()));
  }
  const std::string list = fmt::format("{}", fmt::join(names, ", "));
  const std::string where = folds > 0 ? fmt::format(" in one or more of {} folds", folds) : "";
  const std::size_t n = things.size();
  const bool one = n == 1;
  if (code == "not-identified")
    return fmt::format("{} parameter{} NOT IDENTIFIED{}: {}", n, one ? " is" : "s are", where, list);
  if (code == "at-bound")
    return fmt::format("{} parameter{} AT A BOUND{}: {}", n, one ? " is" : "s are", where, list);
  if (code == "bad-channel") {
    for (std::size_t i = 0; i < n; ++i)
      names[i] = fmt::format("{} ({} trial{})", things[i].about, things[i].messages.size(),
                             things[i].messages.size() == 1 ? "" : "s");
    return fmt::format("{} channel{} bad: {}", n, one ? " is" : "s are", fmt::join(names, ", "));
  }
  const Message& first = *things.front().messages.front();
  std::size_t count = 0;
  for (const Thing& t : things) count += t.messages.size();
  return folds > 0 ? fmt::format("{}, in {} folds", head_of(first.text), folds)
                   : fmt::format("{}, and {} more like it", head_of(first.text), count - 1);
}

/// One line for each thing; over folds only what is said of it, with the trials left out.
std::vector<std::string> details_of(const std::vector<Thing>& things) {
  std::vector<std::string> lines;
  for (const Thing& thing : things) {
    std::vector<std::pair<std::string, std::string>> said;  // what, folds
    for (const Message* m : thing.messages) {
      const std::string what = said_of(*m);
      if (m->fold.empty() || what.empty()) {
        lines.push_back(m->diagnostic->message);
        continue;
      }
      auto found = std::find_if(said.begin(), said.end(), [&](const auto& s) { return s.first == what; });
      if (found == said.end()) {
        said.emplace_back(what, m->fold);
      } else {
        found->second += ", " + m->fold;
      }
    }
    for (const auto& [what, folds] : said)
      lines.push_back(fmt::format("{} {} without {}", thing.about, what, folds));
  }
  return lines;
}

std::size_t folds_of(const std::vector<Message>& messages) {
  std::vector<std::string> folds;
  for (const Message& m : messages) {
    if (m.fold.empty()) return 0;  // mixed: not a matter of folds
    if (std::find(folds.begin(), folds.end(), m.fold) == folds.end()) folds.push_back(m.fold);
  }
  return folds.size();
}

Paragraph single(const std::string& stage, Diagnostic diagnostic) {
  diagnostic.message = fmt::format("`{}`: {}", stage, diagnostic.message);
  return make_finding(diagnostic);
}

}  // namespace

std::vector<Paragraph> make_findings(const std::string& stage, std::span<const Diagnostic> diagnostics) {
  std::vector<std::vector<Message>> groups;
  for (const Diagnostic& d : diagnostics) {
    auto group = std::find_if(groups.begin(), groups.end(), [&](const std::vector<Message>& g) {
      const Diagnostic& first = *g.front().diagnostic;
      return !d.code.empty() && first.code == d.code && first.severity == d.severity;
    });
    if (group == groups.end()) group = groups.insert(groups.end(), std::vector<Message>{});
    group->push_back(take_apart(d));
  }
  std::vector<Paragraph> findings;
  for (const std::vector<Message>& group : groups) {
    const std::size_t folds = folds_of(group);
    if (group.size() < (folds > 0 ? 2u : 3u)) {
      for (const Message& m : group) findings.push_back(single(stage, *m.diagnostic));
      continue;
    }
    const std::vector<Thing> things = things_of(group);
    Diagnostic all = *group.front().diagnostic;
    all.message = summary_of(all.code, things, folds);
    all.where.reset();
    Paragraph finding = single(stage, all);
    finding.details = details_of(things);
    findings.push_back(std::move(finding));
  }
  return findings;
}

}  // namespace brachium::pipelines::report
