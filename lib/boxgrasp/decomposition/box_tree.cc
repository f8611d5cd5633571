#include "boxgrasp/decomposition/box_tree.h"

namespace boxgrasp {

std::vector<int> BoxTree::leaves() const {
  std::vector<int> indices;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].leaf()) indices.push_back(static_cast<int>(i));
  }
  return indices;
}

double BoxTree::leafVolume() const {
  double volume = 0.0;
  for (const BoxNode& node : nodes) volume += node.leaf() ? node.box.volume() : 0.0;
  return volume;
}

}  // namespace boxgrasp
