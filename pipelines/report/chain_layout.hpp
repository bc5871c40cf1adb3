#pragma once
/// Where the boxes of a chain stand: layers by dependency, few crossings, edges around boxes.
///
/// The method of Sugiyama, Tagawa & Toda 1981 (doi:10.1109/TSMC.1981.4308636): layer = longest path from a
/// source, edges over several layers get a bend in each, layers are ordered by barycentres, then positions
/// are averaged.

#include <cstddef>
#include <string>
#include <vector>

#include "pipelines/report/document.hpp"

namespace brachium::pipelines::report {

/// One box: a node of the chain, or an input that a node reads and that is no node itself (recordings).
struct ChainBox {
  std::string name{};
  const ChainNode* node = nullptr;  ///< null: an input from outside
  int layer = 0;
  double position = 0.0;  ///< of the centre across the layer, in widths of a box and its gap; leftmost is 0
};

/// An edge through the points (position, layer), from the box read to the box that reads it.
struct ChainEdge {
  std::size_t from = 0, to = 0;   ///< indices of boxes
  std::vector<double> positions;  ///< one for each layer from `from` to `to`, both ends included
};

struct ChainLayout {
  std::vector<ChainBox> boxes;
  std::vector<ChainEdge> edges;
  int layers = 0;
  double extent = 0.0;  ///< largest position
};

/// Throws std::logic_error where two nodes have one name or nodes read each other in a circle. The layout
/// points into `nodes`, which must outlive it.
ChainLayout layout_chain(const std::vector<ChainNode>& nodes);

}  // namespace brachium::pipelines::report
