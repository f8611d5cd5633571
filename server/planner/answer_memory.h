// The answers given lately, to repeat them for requests that come again.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

namespace boxgrasp {

using EncodedAnswer = std::shared_ptr<const std::vector<std::uint8_t>>;

// Bounded by count and bytes; the answers that were asked for least recently go first.
class AnswerMemory {
 public:
  struct Entry {
    std::string request_id;
    std::string digest;  // of the request's content
    EncodedAnswer answer;
  };

  AnswerMemory(std::uint64_t max_count, std::uint64_t max_bytes)
      : max_count_(max_count), max_bytes_(max_bytes) {}

  // Null where there is none. Valid until the next call of keep().
  const Entry* find(const std::string& request_id);
  // Pre: there is none for this request id.
  void keep(Entry entry);

  std::size_t count() const { return entries_.size(); }
  std::uint64_t bytes() const { return bytes_; }

 private:
  std::uint64_t max_count_, max_bytes_, bytes_ = 0;
  std::list<Entry> entries_;  // the most recently asked for first
  std::unordered_map<std::string, std::list<Entry>::iterator> by_id_;
};

}  // namespace boxgrasp
