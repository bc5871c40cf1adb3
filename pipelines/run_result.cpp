#include "pipelines/runner.hpp"

namespace brachium::pipelines {

std::string to_string(StageStatus status) {
  switch (status) {
    case StageStatus::done:
      return "done";
    case StageStatus::reused:
      return "reused";
    case StageStatus::failed:
      return "failed";
    case StageStatus::skipped:
      return "skipped";
  }
  return "skipped";
}

int exit_code(Outcome outcome) {
  switch (outcome) {
    case Outcome::done:
      return 0;
    case Outcome::expectation_failed:
    case Outcome::numerical_failure:
      return 1;
    case Outcome::input_error:
      return 2;
    case Outcome::interrupted:
      return 130;
  }
  return 1;
}

std::string to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::done:
      return "done";
    case Outcome::expectation_failed:
      return "expectation failed";
    case Outcome::numerical_failure:
      return "numerical failure";
    case Outcome::input_error:
      return "input error";
    case Outcome::interrupted:
      return "interrupted";
  }
  return "done";
}

const StageRecord* RunResult::find(const std::string& stage) const {
  for (const StageRecord& record : stages) {
    if (record.name == stage) return &record;
  }
  return nullptr;
}

}  // namespace brachium::pipelines
