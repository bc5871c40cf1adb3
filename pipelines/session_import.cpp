#include "pipelines/session_import.hpp"

#include <fmt/format.h>

#include "pipelines/version.hpp"

namespace brachium::pipelines {

Fingerprint SessionImport::fingerprint(FileDigests& digests) const {
  Fingerprint parts{{"stage", fmt::format("{} (version {})", spec->name, spec->version)},
                    {"program", program_version()}};
  for (const auto& [key, value] : overrides) parts["option." + key] = value;
  parts["file." + description->file.filename().string()] = digests.of(description->file);
  for (const io::ResolvedFile& file : io::resolve_files(*description)) {
    parts["file." + file.path.lexically_relative(description->recordings).string()] = digests.of(file.path);
  }
  return parts;
}

SessionImport make_session_import(const Definition& definition) {
  SessionImport import;
  import.overrides = definition.session_overrides;
  import.description = std::make_shared<io::SessionDescription>(
      io::read_session_description(definition.session, import.overrides));
  auto spec = std::make_shared<StageSpec>();
  spec->name = "session.import";
  spec->summary = "reads the recordings that a session description names";
  spec->run = [description = import.description](const StageContext& context, StageOutput& output) {
    for (data::Diagnostic& d : io::import_session(*description, *output.signals, context.progress)) {
      output.diagnostics.push_back(std::move(d));
    }
  };
  import.stage.name = session_stage;
  import.stage.spec = spec.get();
  import.stage.where.file = definition.session.string();
  import.spec = std::move(spec);
  return import;
}

}  // namespace brachium::pipelines
