#include "data/model/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>

namespace brachium::data {
namespace {

std::string_view name_of(Severity severity) {
  switch (severity) {
    case Severity::note:
      return "note";
    case Severity::warning:
      return "warning";
    case Severity::error:
      return "error";
  }
  return "error";
}

// Damerau-Levenshtein distance with adjacent transpositions, case-insensitive.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t cost = lower(a[i - 1]) == lower(b[j - 1]) ? 0 : 1;
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + cost});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1])) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

std::string summary(std::span<const Diagnostic> diagnostics) {
  if (diagnostics.size() == 1) return diagnostics.front().message;
  std::string text = fmt::format("{} mistakes", diagnostics.size());
  for (const Diagnostic& d : diagnostics) text += "\n  " + d.message;
  return text;
}

}  // namespace

std::string render(const Diagnostic& d) {
  std::string text = fmt::format("{}[{}]: {}\n", name_of(d.severity), d.code, d.message);
  if (d.where) {
    const SourceSpan& w = *d.where;
    if (w.line <= 0) {
      text += fmt::format("  --> {}\n", w.file);
    } else {
      text += w.column > 0 ? fmt::format("  --> {}:{}:{}\n", w.file, w.line, w.column)
                           : fmt::format("  --> {}:{}\n", w.file, w.line);
      if (!w.text.empty()) {
        const std::string number = std::to_string(w.line);
        const std::string pad(number.size(), ' ');
        text += fmt::format("{} |\n{} | {}\n", pad, number, w.text);
        if (w.column > 0) {
          // Tabs are kept in the margin so that the marks stand under the text they mean.
          std::string margin;
          for (int i = 0; i + 1 < w.column; ++i) {
            const auto at = static_cast<std::size_t>(i);
            margin += at < w.text.size() && w.text[at] == '\t' ? '\t' : ' ';
          }
          text += fmt::format("{} | {}{}", pad, margin,
                              std::string(static_cast<std::size_t>(std::max(1, w.length)), '^'));
          text += d.help.empty() ? "\n" : " " + d.help + "\n";
          return text;
        }
      }
    }
  }
  if (!d.help.empty()) text += fmt::format("  help: {}\n", d.help);
  return text;
}

std::string render(std::span<const Diagnostic> diagnostics) {
  std::string text;
  for (const Diagnostic& d : diagnostics) text += render(d);
  return text;
}

InputError::InputError(Diagnostic diagnostic) : InputError(std::vector<Diagnostic>{std::move(diagnostic)}) {}

InputError::InputError(std::vector<Diagnostic> diagnostics)
    : std::runtime_error(summary(diagnostics)), diagnostics_(std::move(diagnostics)) {}

InputError::InputError(std::string code, std::string message, std::string help)
    : InputError(
          Diagnostic{Severity::error, std::move(code), std::move(message), std::nullopt, std::move(help)}) {}

ConvergenceFailure::ConvergenceFailure(Details details)
    : std::runtime_error(fmt::format("{}: {} (after {} iterations, residual {:.3g}, step {:.3g}{}{})",
                                     details.where, details.reason, details.iterations, details.residual_norm,
                                     details.step_norm,
                                     details.worst.empty() ? "" : ", worst: ", details.worst)),
      details_(std::move(details)) {}

std::optional<std::string> nearest_name(std::string_view word, std::span<const std::string> candidates) {
  std::optional<std::string> best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

std::string suggest(std::string_view word, std::span<const std::string> candidates) {
  if (const auto nearest = nearest_name(word, candidates)) return fmt::format("did you mean `{}`?", *nearest);
  if (candidates.empty()) return {};
  const std::size_t shown = std::min<std::size_t>(candidates.size(), 12);
  return fmt::format(
      "known: {}{}",
      fmt::join(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(shown), ", "),
      shown < candidates.size() ? ", ..." : "");
}

}  // namespace brachium::data
