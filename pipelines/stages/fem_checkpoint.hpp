#pragma once
/// Accepted states of a solve, each in a file of its own, so that a solve that was killed or failed goes on
/// from the last.
///
/// A folder holds 0001.h5, 0002.h5, ... Each is a stage file (data/io/stage_file.hpp), written atomically:
/// the state (everything of fem::SolveState), and the rows that it adds to the tables of the stage. `problem`
/// is a digest of what was solved: files of another problem are not used.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "data/model/table.hpp"
#include "fem/solve/solve.hpp"

namespace brachium::pipelines {

using FemTables = std::map<std::string, data::Table>;

class FemCheckpoints {
 public:
  /// `folder` empty: nothing is kept (a stage run in memory). Files of another problem are removed.
  FemCheckpoints(std::filesystem::path folder, std::string problem);

  /// What earlier runs left, in order: the rows of each accepted state. A damaged file ends the list.
  const std::vector<FemTables>& rows() const { return rows_; }
  /// The last of them; nothing to go on from: none.
  const std::optional<fem::SolveState>& last() const { return last_; }

  /// Throws InputError("write-failed", ...).
  void keep(const fem::SolveState& state, const FemTables& rows);
  /// The solve is complete: the files have served.
  void remove();

 private:
  std::filesystem::path folder_;
  std::string problem_;
  std::vector<FemTables> rows_;
  std::optional<fem::SolveState> last_;
  std::size_t count_ = 0;
};

}  // namespace brachium::pipelines
