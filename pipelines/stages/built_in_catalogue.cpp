#include "pipelines/stage.hpp"

namespace brachium::pipelines {

Catalogue built_in_catalogue() {
  Catalogue catalogue;
  return catalogue;
}

}  // namespace brachium::pipelines
