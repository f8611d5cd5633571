// Marks of things in a row, a byte each: what a pass over many of them leaves for a loop over the few that
// matter.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>

namespace boxgrasp {

// Calls the function with the place of each mark that is not 0, in ascending order. Made for few marks.
template <typename Function>
void forEachMarked(std::span<const std::uint8_t> marks, const Function& function) {
  const auto look = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (marks[i]) function(i);
    }
  };
  constexpr std::size_t kWord = sizeof(std::uint64_t);
  const std::size_t whole = marks.size() - marks.size() % kWord;
  for (std::size_t i = 0; i < whole; i += kWord) {
    std::uint64_t any;
    std::memcpy(&any, &marks[i], kWord);
    if (any != 0) look(i, i + kWord);
  }
  look(whole, marks.size());
}

}  // namespace boxgrasp
