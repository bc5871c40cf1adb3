#pragma once
/// How things go wrong in Brachium: what the user can mend (InputError, exit code 2) and what the numbers
/// could not do (ConvergenceFailure, exit code 1). Libraries throw these; they never print and never exit.

#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace brachium::data {

enum class Severity { note, warning, error };

/// A place in a text the user wrote or recorded. Lines and columns count from 1; 0 means "not known".
struct SourceSpan {
  std::string file;
  int line = 0;
  int column = 0;
  int length = 1;    ///< characters to underline
  std::string text;  ///< the offending line itself, may be empty
};

/// One finding: what, where, and what to do about it.
struct Diagnostic {
  Severity severity = Severity::error;
  std::string code;  ///< stable kebab-case identifier, e.g. "unknown-key"; `brachium explain CODE` tells more
  std::string message;  ///< one sentence, names the offending thing in backticks
  std::optional<SourceSpan> where;
  std::string help;  ///< what to do, e.g. "did you mean `lowpass_hz`?"; may be empty
};

/// The finding as a terminal shows it: code and message, `--> file:line:column`, the line underlined, the help.
std::string render(const Diagnostic& diagnostic);
std::string render(std::span<const Diagnostic> diagnostics);

/// The user's input is wrong. Carries every mistake found, not only the first.
class InputError : public std::runtime_error {
 public:
  explicit InputError(Diagnostic diagnostic);
  explicit InputError(std::vector<Diagnostic> diagnostics);
  InputError(std::string code, std::string message, std::string help = {});

  const std::vector<Diagnostic>& diagnostics() const noexcept { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

/// A computation did not reach its tolerance.
class ConvergenceFailure : public std::runtime_error {
 public:
  struct Details {
    std::string where;   ///< step, muscle, frame or element
    std::string reason;  ///< what was tried and why it stopped
    int iterations = 0;
    double residual_norm = 0.0;
    double step_norm = 0.0;
    std::string worst;  ///< the worst muscle, parameter or element
  };
  explicit ConvergenceFailure(Details details);
  const Details& details() const noexcept { return details_; }

 private:
  Details details_;
};

/// The candidate closest to `word` by edit distance, if it is close enough to be a likely misspelling.
std::optional<std::string> nearest_name(std::string_view word, std::span<const std::string> candidates);

/// "did you mean `x`?" for the nearest candidate, else "known: a, b, c" (shortened when long).
std::string suggest(std::string_view word, std::span<const std::string> candidates);

}  // namespace brachium::data
