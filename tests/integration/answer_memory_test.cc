// What the daemon remembers: bounded, and the least recently asked for goes first.
#include "answer_memory.h"

#include <gtest/gtest.h>

#include <cmath>

#include "latencies.h"

namespace boxgrasp {
namespace {

AnswerMemory::Entry entry(const std::string& id, std::size_t bytes) {
  return {id, "digest of " + id, std::make_shared<const std::vector<std::uint8_t>>(bytes)};
}

TEST(AnswerMemory, ForgetsTheLeastRecentlyAskedFor) {
  AnswerMemory memory(2, 1000);
  memory.keep(entry("a", 1));
  memory.keep(entry("b", 1));
  ASSERT_TRUE(memory.find("a"));
  memory.keep(entry("c", 1));
  EXPECT_TRUE(memory.find("a"));
  EXPECT_FALSE(memory.find("b"));
  ASSERT_TRUE(memory.find("c"));
  EXPECT_EQ(memory.find("c")->digest, "digest of c");
}

TEST(AnswerMemory, StaysWithinItsBytes) {
  AnswerMemory memory(100, 10);
  for (const char* id : {"a", "b", "c"}) memory.keep(entry(id, 4));
  EXPECT_EQ(memory.count(), 2u);
  EXPECT_EQ(memory.bytes(), 8u);
  memory.keep(entry("more than all", 11));
  EXPECT_EQ(memory.count(), 0u);
  EXPECT_EQ(memory.bytes(), 0u);
}

TEST(Latencies, QuantilesOfTheLastThousand) {
  Latencies latencies;
  EXPECT_TRUE(std::isnan(latencies.quantile(0.5)));
  for (int i = 0; i < 500; ++i) latencies.add(1e6);  // long forgotten
  for (int i = 1; i <= 1000; ++i) latencies.add(i);
  EXPECT_EQ(latencies.quantile(0.50), 500);
  EXPECT_EQ(latencies.quantile(0.99), 990);
  EXPECT_EQ(latencies.quantile(1.0), 1000);
}

}  // namespace
}  // namespace boxgrasp
