#include "answer_memory.h"

namespace boxgrasp {

const AnswerMemory::Entry* AnswerMemory::find(const std::string& request_id) {
  const auto found = by_id_.find(request_id);
  if (found == by_id_.end()) return nullptr;
  entries_.splice(entries_.begin(), entries_, found->second);
  return &*found->second;
}

void AnswerMemory::keep(Entry entry) {
  bytes_ += entry.answer->size();
  entries_.push_front(std::move(entry));
  by_id_[entries_.front().request_id] = entries_.begin();
  while (!entries_.empty() && (entries_.size() > max_count_ || bytes_ > max_bytes_)) {
    bytes_ -= entries_.back().answer->size();
    by_id_.erase(entries_.back().request_id);
    entries_.pop_back();
  }
}

}  // namespace boxgrasp
