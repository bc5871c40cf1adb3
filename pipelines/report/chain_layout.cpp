#include "pipelines/report/chain_layout.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <stdexcept>

namespace brachium::pipelines::report {
namespace {

constexpr int kSweeps = 12;

/// A box, or the bend of an edge in a layer that it passes.
struct Point {
  int layer = 0;
  double position = 0.0;
  double room = 1.0;  // across the layer: a bend needs less than a box
  bool is_bend() const { return room < 1.0; }
  std::vector<std::size_t> before{}, after{};  // neighbours in the layers before and after it
};

class Graph {
 public:
  explicit Graph(ChainLayout& layout);
  void order();
  void place();
  void write_back(ChainLayout& layout) const;

 private:
  double barycentre(std::size_t i, bool before, bool after) const;
  void sort_layer(std::vector<std::size_t>& layer, bool downwards);
  void separate(const std::vector<std::size_t>& layer, const std::vector<double>& wanted);

  std::vector<Point> points_;  // the boxes first, then the bends
  std::vector<std::vector<std::size_t>> layers_;
  std::vector<std::vector<std::size_t>> through_;  // of each edge: its points
};

Graph::Graph(ChainLayout& layout) : layers_(static_cast<std::size_t>(layout.layers)) {
  for (const ChainBox& box : layout.boxes) points_.push_back({.layer = box.layer});
  for (const ChainEdge& edge : layout.edges) {
    std::vector<std::size_t> path = {edge.from};
    for (int layer = points_[edge.from].layer + 1; layer < points_[edge.to].layer; ++layer) {
      points_.push_back({.layer = layer, .room = 0.35});
      path.push_back(points_.size() - 1);
    }
    path.push_back(edge.to);
    for (std::size_t k = 1; k < path.size(); ++k) {
      points_[path[k - 1]].after.push_back(path[k]);
      points_[path[k]].before.push_back(path[k - 1]);
    }
    through_.push_back(std::move(path));
  }
  for (std::size_t i = 0; i < points_.size(); ++i)
    layers_[static_cast<std::size_t>(points_[i].layer)].push_back(i);
  for (auto& layer : layers_) {
    for (std::size_t k = 0; k < layer.size(); ++k) points_[layer[k]].position = static_cast<double>(k);
  }
}

/// Weighted mean position of the neighbours; long arrows pull hardest so that they run straight.
double Graph::barycentre(std::size_t i, bool before, bool after) const {
  double sum = 0.0;
  double weights = 0.0;
  const auto add = [&](const std::vector<std::size_t>& neighbours) {
    for (const std::size_t k : neighbours) {
      const int bends = static_cast<int>(points_[i].is_bend()) + static_cast<int>(points_[k].is_bend());
      const double weight = bends == 2 ? 8.0 : bends == 1 ? 2.0 : 1.0;
      sum += weight * points_[k].position;
      weights += weight;
    }
  };
  if (before) add(points_[i].before);
  if (after) add(points_[i].after);
  return weights > 0.0 ? sum / weights : points_[i].position;
}

void Graph::sort_layer(std::vector<std::size_t>& layer, bool downwards) {
  std::map<std::size_t, double> key;
  for (const std::size_t i : layer) key[i] = barycentre(i, downwards, !downwards);
  std::stable_sort(layer.begin(), layer.end(), [&](std::size_t a, std::size_t b) { return key[a] < key[b]; });
  for (std::size_t k = 0; k < layer.size(); ++k) points_[layer[k]].position = static_cast<double>(k);
}

void Graph::order() {
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (auto& layer : layers_) sort_layer(layer, true);
    for (auto layer = layers_.rbegin(); layer != layers_.rend(); ++layer) sort_layer(*layer, false);
  }
  for (auto& layer : layers_) sort_layer(layer, true);
}

/// Positions closest to the wanted ones, in least squares, that keep order and distance: pooling of
/// neighbours that would come too close (isotonic regression, pool adjacent violators).
void Graph::separate(const std::vector<std::size_t>& layer, const std::vector<double>& wanted) {
  struct Block {
    double sum;
    std::size_t count;
    double mean() const { return sum / static_cast<double>(count); }
  };
  std::vector<double> offset(layer.size(), 0.0);
  for (std::size_t k = 1; k < layer.size(); ++k) {
    offset[k] = offset[k - 1] + 0.5 * (points_[layer[k - 1]].room + points_[layer[k]].room);
  }
  std::vector<Block> blocks;
  for (std::size_t k = 0; k < layer.size(); ++k) {
    blocks.push_back({wanted[k] - offset[k], 1});
    while (blocks.size() > 1 && blocks[blocks.size() - 2].mean() > blocks.back().mean()) {
      blocks[blocks.size() - 2].sum += blocks.back().sum;
      blocks[blocks.size() - 2].count += blocks.back().count;
      blocks.pop_back();
    }
  }
  std::size_t k = 0;
  for (const Block& block : blocks) {
    for (std::size_t n = 0; n < block.count; ++n, ++k) points_[layer[k]].position = block.mean() + offset[k];
  }
}

void Graph::place() {
  const auto pass = [&](const std::vector<std::size_t>& layer, bool before, bool after) {
    std::vector<double> wanted;
    for (const std::size_t i : layer) wanted.push_back(barycentre(i, before, after));
    separate(layer, wanted);
  };
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const auto& layer : layers_) pass(layer, true, false);
    for (auto layer = layers_.rbegin(); layer != layers_.rend(); ++layer) pass(*layer, false, true);
  }
  for (int sweep = 0; sweep < 2 * kSweeps; ++sweep) {
    for (const auto& layer : layers_) pass(layer, true, true);
  }
}

void Graph::write_back(ChainLayout& layout) const {
  double least = 0.0;
  double largest = 0.0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    least = i == 0 ? points_[i].position : std::min(least, points_[i].position);
    largest = i == 0 ? points_[i].position : std::max(largest, points_[i].position);
  }
  for (std::size_t i = 0; i < layout.boxes.size(); ++i)
    layout.boxes[i].position = points_[i].position - least;
  for (std::size_t e = 0; e < layout.edges.size(); ++e) {
    for (const std::size_t i : through_[e]) layout.edges[e].positions.push_back(points_[i].position - least);
  }
  layout.extent = largest - least;
}

/// Longest path from a source, by repeated relaxation; more rounds than boxes means a circle.
void assign_layers(ChainLayout& layout) {
  for (std::size_t round = 0; round <= layout.boxes.size(); ++round) {
    bool changed = false;
    for (const ChainEdge& edge : layout.edges) {
      const int needed = layout.boxes[edge.from].layer + 1;
      if (layout.boxes[edge.to].layer < needed) {
        layout.boxes[edge.to].layer = needed;
        changed = true;
      }
    }
    if (!changed) {
      for (const ChainBox& box : layout.boxes) layout.layers = std::max(layout.layers, box.layer + 1);
      return;
    }
  }
  throw std::logic_error("chain: stages read each other in a circle");
}

}  // namespace

ChainLayout layout_chain(const std::vector<ChainNode>& nodes) {
  ChainLayout layout;
  std::map<std::string, std::size_t> index;
  for (const ChainNode& node : nodes) {
    if (!index.emplace(node.name, layout.boxes.size()).second) {
      throw std::logic_error("chain: two stages have the name `" + node.name + "`");
    }
    layout.boxes.push_back({.name = node.name, .node = &node});
  }
  for (const ChainNode& node : nodes) {
    std::vector<std::string> seen;
    for (const std::string& source : node.from) {
      if (std::find(seen.begin(), seen.end(), source) != seen.end()) continue;  // read twice is one arrow
      seen.push_back(source);
      const auto [entry, is_new] = index.emplace(source, layout.boxes.size());
      if (is_new) layout.boxes.push_back({.name = source});
      layout.edges.push_back({.from = entry->second, .to = index.at(node.name), .positions = {}});
    }
  }
  if (layout.boxes.empty()) return layout;
  assign_layers(layout);
  // A source stands right above its first reader, not in the first layer with a long arrow.
  for (std::size_t i = 0; i < layout.boxes.size(); ++i) {
    const bool is_source =
        std::none_of(layout.edges.begin(), layout.edges.end(), [&](const ChainEdge& e) { return e.to == i; });
    int first_reader = layout.layers;
    for (const ChainEdge& edge : layout.edges) {
      if (edge.from == i) first_reader = std::min(first_reader, layout.boxes[edge.to].layer);
    }
    if (is_source && first_reader < layout.layers) layout.boxes[i].layer = first_reader - 1;
  }
  Graph graph(layout);
  graph.order();
  graph.place();
  graph.write_back(layout);
  return layout;
}

}  // namespace brachium::pipelines::report
