#include "pipelines/report/chain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pipelines/report/chain_layout.hpp"

namespace brachium::pipelines::report {
namespace {

using testing::HasSubstr;

ChainNode node(const std::string& name, std::vector<std::string> from) {
  return {.name = name, .run = "emg.envelope", .seconds = 1.0, .status = "done", .from = std::move(from)};
}

std::string numbered(int i) {
  std::string name = "s";
  name += std::to_string(i);
  return name;
}

void expect_sound(const ChainLayout& layout) {
  for (const ChainEdge& edge : layout.edges) {
    EXPECT_LT(layout.boxes[edge.from].layer, layout.boxes[edge.to].layer);
    EXPECT_EQ(edge.positions.size(),
              static_cast<std::size_t>(layout.boxes[edge.to].layer - layout.boxes[edge.from].layer + 1));
    // An arrow that passes a layer keeps clear of its boxes.
    for (std::size_t k = 1; k + 1 < edge.positions.size(); ++k) {
      for (const ChainBox& box : layout.boxes) {
        if (box.layer != layout.boxes[edge.from].layer + static_cast<int>(k)) continue;
        EXPECT_GE(std::abs(box.position - edge.positions[k]), 0.67);
      }
    }
  }
  for (std::size_t a = 0; a < layout.boxes.size(); ++a) {
    EXPECT_GE(layout.boxes[a].position, -1e-12);
    EXPECT_LE(layout.boxes[a].position, layout.extent + 1e-12);
    for (std::size_t b = a + 1; b < layout.boxes.size(); ++b) {
      if (layout.boxes[a].layer == layout.boxes[b].layer) {
        EXPECT_GE(std::abs(layout.boxes[a].position - layout.boxes[b].position), 1.0 - 1e-9)
            << layout.boxes[a].name << " over " << layout.boxes[b].name;
      }
    }
  }
}

TEST(ReportChain, AStageStandsBehindEverythingItReads) {
  const std::vector<ChainNode> nodes = {
      node("excitation", {"session"}), node("moment", {"session"}), node("subject", {"excitation", "moment"}),
      node("activation", {"excitation", "subject"}), node("verdict", {"moment", "activation"})};
  const ChainLayout layout = layout_chain(nodes);
  expect_sound(layout);
  EXPECT_EQ(layout.boxes.size(), 6u) << "the recordings are a box of their own";
  EXPECT_EQ(layout.boxes.back().name, "session");
  EXPECT_EQ(layout.boxes.back().node, nullptr);
  EXPECT_EQ(layout.layers, 5);
}

TEST(ReportChain, NoBoxesOverlapInAnyOfManyChains) {
  std::mt19937 generator(5);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<ChainNode> nodes;
    const int count = 1 + static_cast<int>(generator() % 14);
    for (int i = 0; i < count; ++i) {
      std::vector<std::string> from;
      for (int j = 0; j < i; ++j) {
        if (generator() % 4 == 0) from.push_back(numbered(j));
      }
      nodes.push_back(node(numbered(i), from));
    }
    expect_sound(layout_chain(nodes));
  }
}

TEST(ReportChain, AChainWithoutBranchesIsAStraightLine) {
  const std::vector<ChainNode> nodes = {node("a", {}), node("b", {"a"}), node("c", {"b"})};
  for (const ChainBox& box : layout_chain(nodes).boxes) EXPECT_NEAR(box.position, 0.0, 1e-12);
}

TEST(ReportChain, CirclesAndNamesakesAreRefused) {
  const auto message = [](const std::vector<ChainNode>& nodes) -> std::string {
    try {
      layout_chain(nodes);
    } catch (const std::logic_error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message({node("a", {"b"}), node("b", {"a"})}), "chain: stages read each other in a circle");
  EXPECT_EQ(message({node("a", {"a"})}), "chain: stages read each other in a circle");
  EXPECT_EQ(message({node("a", {}), node("a", {})}), "chain: two stages have the name `a`");
}

TEST(ReportChain, StatusIsSaidInWordsNotInColourAlone) {
  std::vector<ChainNode> nodes = {node("a", {}), node("b", {"a"}), node("c", {"a"}), node("<d>", {"a"})};
  nodes[1].status = "reused";
  nodes[2].status = "failed";
  nodes[3].status = "skipped";
  const std::string picture = draw_chain(nodes);
  EXPECT_THAT(picture, HasSubstr("✓ 1.0\u202Fs"));
  EXPECT_THAT(picture, HasSubstr("↺ reused"));
  EXPECT_THAT(picture, HasSubstr("✗ failed after 1.0\u202Fs"));
  EXPECT_THAT(picture, HasSubstr("– skipped"));
  EXPECT_THAT(picture, HasSubstr("&lt;d&gt;"));
  EXPECT_EQ(draw_chain({}), "");
}

}  // namespace
}  // namespace brachium::pipelines::report
