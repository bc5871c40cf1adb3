#include <array>
#include <utility>

#include "emg/butterworth.hpp"
#include "emg/names.hpp"

namespace brachium::emg {
namespace {

constexpr std::array<std::pair<FilterKind, const char*>, 4> kinds{{{FilterKind::low_pass, "low_pass"},
                                                                   {FilterKind::high_pass, "high_pass"},
                                                                   {FilterKind::band_pass, "band_pass"},
                                                                   {FilterKind::notch, "notch"}}};
constexpr std::array<std::pair<CutoffConvention, const char*>, 2> conventions{
    {{CutoffConvention::after_all_passes, "after_all_passes"}, {CutoffConvention::per_pass, "per_pass"}}};
constexpr std::array<std::pair<Phase, const char*>, 2> phases{
    {{Phase::zero_lag, "zero_lag"}, {Phase::causal, "causal"}}};

}  // namespace

std::string to_string(FilterKind kind) {
  return name_of(kinds, kind);
}
std::string to_string(CutoffConvention convention) {
  return name_of(conventions, convention);
}
std::string to_string(Phase phase) {
  return name_of(phases, phase);
}

FilterKind parse_filter_kind(const std::string& name) {
  return parse_name(kinds, name, "unknown-filter", "a kind of filter");
}
CutoffConvention parse_cutoff_convention(const std::string& name) {
  return parse_name(conventions, name, "unknown-cutoff", "a cut-off convention");
}
Phase parse_phase(const std::string& name) {
  return parse_name(phases, name, "unknown-phase", "a phase");
}

}  // namespace brachium::emg
