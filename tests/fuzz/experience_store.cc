// The store of labels: a file of SQLite's that anything may have happened to.
#include "boxgrasp/store/experience_store.h"

#include "experience_examples.h"
#include "fuzz_target.h"
#include "small_pages.h"

namespace boxgrasp::fuzz {
namespace {

void readAll(const ExperienceStore& store) {
  for (const ModelRecord& model : store.models()) {
    for (const GraspSource source : {GraspSource::planner, GraspSource::random, GraspSource::approach}) {
      store.hypotheses(model.key, source);
      store.labelled(model.key, source);
      store.missing(model.key, source, 2);
    }
  }
  store.counts();
  store.contentHash();
}

}  // namespace

void feed(Bytes bytes) {
  static const Folder folder;
  const auto file = folder.file("fuzz.db", bytes);
  accepts([&] { readAll(ExperienceStore::openForReading(file)); });
}

std::vector<std::string> seeds() {
  const Folder folder;
  std::mt19937_64 random(1);
  {
    auto store = ExperienceStore::openForWriting(folder.path() / "store.db", test::kSettings);
    const ModelRecord model = test::someModel("cup", 1.0, random);
    store.addModel(model, test::someHypotheses(GraspSource::planner, 2, random));
    store.addLabels(model.key, GraspSource::planner, test::someLabels(2, 1, random));
  }
  makeSmall(folder.path() / "store.db");
  return {folder.read("store.db")};
}

}  // namespace boxgrasp::fuzz
