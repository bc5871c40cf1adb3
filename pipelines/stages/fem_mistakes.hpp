#pragma once
/// Mistakes of a definition of fem.solve, each with the place where it was written.

#include <string>
#include <vector>

#include "pipelines/stage.hpp"

namespace brachium::pipelines {

/// Findings name things in backticks. Where in `entry` the last of them stands that is a text, a name or a
/// key there; the entry itself where none does.
data::SourceSpan place_in(const Options& entry, const std::string& message);

/// Where in the options of fem.solve a finding of fem::check belongs: in the condition, contact, phase or
/// material that it names first.
data::SourceSpan place_of(const data::Diagnostic& finding, const Options& options);

class Mistakes {
 public:
  /// In `entry`, at place_in(entry, message).
  void error(const Options& entry, std::string code, std::string message, std::string help = {});
  /// Findings of a library; those without a place get that of what they name in `entry`.
  void take(const std::vector<data::Diagnostic>& found, const Options& entry, const std::string& prefix = {});
  void take(const data::InputError& found, const Options& entry, const std::string& prefix = {}) {
    take(found.diagnostics(), entry, prefix);
  }
  /// Those at place_of(finding, options); errors only.
  void take_checked(const std::vector<data::Diagnostic>& found, const Options& options);
  /// Keys of `entry` beside `allowed`: unused-option.
  void only_keys(const Options& entry, const std::vector<std::string>& allowed, const std::string& owner);
  /// false where `entry` lacks the key: missing-option.
  bool need(const Options& entry, const std::string& key, const std::string& owner,
            const std::string& help = {});

  /// Runs `work`; what it throws is taken. Whether nothing was thrown.
  template <class Work>
  bool guarded(const Options& entry, const std::string& prefix, const Work& work) {
    try {
      work();
      return true;
    } catch (const data::InputError& e) {
      take(e, entry, prefix);
      return false;
    }
  }

  std::size_t size() const { return list_.size(); }
  bool empty() const { return list_.empty(); }
  std::vector<data::Diagnostic> list() && { return std::move(list_); }

 private:
  std::vector<data::Diagnostic> list_;
};

}  // namespace brachium::pipelines
