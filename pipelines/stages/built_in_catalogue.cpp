#include "pipelines/stage.hpp"

namespace brachium::pipelines {

Catalogue built_in_catalogue() {
  Catalogue catalogue;
  add_session_stages(catalogue);
  add_emg_stages(catalogue);
  add_limb_stages(catalogue);
  add_hill_stages(catalogue);
  add_fem_stages(catalogue);
  add_optimise_stages(catalogue);
  add_compare_stages(catalogue);
  return catalogue;
}

}  // namespace brachium::pipelines
