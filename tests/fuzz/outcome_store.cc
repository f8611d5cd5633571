// The store of robots' outcomes: a file of SQLite's that anything may have happened to.
#include "boxgrasp/store/outcome_store.h"

#include "fuzz_target.h"
#include "small_pages.h"

namespace boxgrasp::fuzz {
namespace {

RobotOutcome outcome(int grasp_index) {
  RobotOutcome outcome;
  outcome.request_id = "plan";
  outcome.grasp_index = grasp_index;
  outcome.robot = "robot";
  outcome.forces_n = {1.5, 2.5};
  return outcome;
}

void useAll(OutcomeStore store) {
  for (const StoredOutcome& one : store.outcomesAfter(0)) promise(one.id > 0);
  store.countAfter(0);
  store.answers();
  store.progress("learnt");
  store.addOutcome(outcome(1));
}

}  // namespace

void feed(Bytes bytes) {
  static const Folder folder;
  for (const char* beside : {"fuzz.db-wal", "fuzz.db-shm"}) std::filesystem::remove(folder.path() / beside);
  const auto file = folder.file("fuzz.db", bytes);
  accepts([&] { useAll(OutcomeStore(file)); });
}

std::vector<std::string> seeds() {
  const Folder folder;
  {
    OutcomeStore store(folder.path() / "store.db");
    store.rememberAnswer(
        {"plan", 1, {"0badc0de", "q1 q2", "hand", "cup"}, {{{0.5, NAN}, 0.25}, {{0.1, 0.2}, 0.5}}});
    store.addOutcome(outcome(0));
    store.setProgress("learnt", "1");
  }
  makeSmall(folder.path() / "store.db");
  return {folder.read("store.db")};
}

}  // namespace boxgrasp::fuzz
