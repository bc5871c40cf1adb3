#pragma once
/// The stage `session` that comes before all others where a pipeline names a session description: it imports
/// the recordings once into a session file of the run folder.

#include <memory>

#include "data/io/session_description.hpp"
#include "pipelines/definition.hpp"
#include "pipelines/fingerprint.hpp"

namespace brachium::pipelines {

struct SessionImport {
  std::shared_ptr<const StageSpec> spec;
  StageDefinition stage;  ///< number 0, named "session", without inputs
  std::shared_ptr<const io::SessionDescription> description;
  std::map<std::string, std::string> overrides;

  /// Description, overrides and the content of every recording, and the program.
  Fingerprint fingerprint(FileDigests& digests) const;
};

/// Throws InputError with the mistakes of the description.
SessionImport make_session_import(const Definition& definition);

}  // namespace brachium::pipelines
