/// A limb's options judged before anything runs.

#include <fmt/format.h>

#include "pipelines/stages/fem_muscle_map.hpp"
#include "pipelines/stages/fem_option_kinds.hpp"
#include "pipelines/stages/fem_options.hpp"
#include "pipelines/stages/model_options.hpp"

namespace brachium::pipelines {
namespace {

/// Their muscles. Whether a body can be built with them is known when it runs: it may be scaled or fitted first.
void check_parameters(const Options& options, const LimbScene& limb, Mistakes& mistakes) {
  for (const std::string key : {"pre_stretch", "max_stress_Pa"}) {
    for (const auto& [name, value] : options.number_map(key)) {
      try {
        if (name != "*") limb.muscle(name);
      } catch (const data::InputError& e) {
        const auto where = options.where(key + "." + name);
        std::vector<data::Diagnostic> found = e.diagnostics();
        if (!where.file.empty())
          for (data::Diagnostic& d : found) d.where = where;
        mistakes.take(found, options);
      }
    }
  }
}

}  // namespace

std::optional<LimbScene> check_limb(const CheckContext& context, Mistakes& mistakes) {
  const Options& options = *context.options;
  mistakes.guarded(options, {}, [&] { solve_options(options, 1); });
  std::optional<LimbScene> limb;
  if (!mistakes.guarded(options, {}, [&] { limb = limb_of_options(options); })) return limb;
  check_parameters(options, *limb, mistakes);
  if (options.text("scale_to") == "none") return limb;
  if (!context.scene) {
    mistakes.error(options, "missing-scene", "`scale_to` needs the subject's muscles: a scene",
                   "add `scene = \"...\"` to [pipeline]");
    return limb;
  }
  check_groups(context, *limb, mistakes);
  return limb;
}

void check_groups(const CheckContext& context, const LimbScene& limb, Mistakes& mistakes) {
  const Options& options = *context.options;
  mistakes.guarded(options, {}, [&] {
    const data::Coordinate& coordinate =
        coordinate_of(*context.scene, options.maybe_text("coordinate").value_or(""));
    group_muscles(options, *context.scene, coordinate, nullptr, limb.muscle_names());
  });
}

std::vector<std::string> chosen_muscles(const Options& options, const LimbScene& limb) {
  const std::vector<std::string>& only = options.texts("muscles");
  return only.empty() ? limb.muscle_names() : data::match_names(only, limb.muscle_names(), "muscle");
}

}  // namespace brachium::pipelines
