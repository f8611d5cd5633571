#include "boxgrasp/store/experience_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>

#include "error_of.h"
#include "experience_examples.h"

namespace boxgrasp {
namespace {

using test::awkward;
using test::dumpOf;
using test::errorOf;
using test::kSettings;
using test::someHypotheses;
using test::someHypothesis;
using test::someLabel;
using test::someLabels;
using test::someModel;
using test::TemporaryFolder;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr GraspSource kPlanner = GraspSource::planner, kRandom = GraspSource::random;

// Bits; all NaNs are one.
std::uint64_t bitsOf(double x) { return std::isnan(x) ? 1 : std::bit_cast<std::uint64_t>(x); }

void expectSame(const Vector3d& a, const Vector3d& b) {
  for (int i = 0; i < 3; ++i) EXPECT_EQ(bitsOf(a[i]), bitsOf(b[i]));
}

// Field by field, so that nothing of the store's own code is trusted.
void expectSame(const HypothesisRecord& a, const HypothesisRecord& b) {
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.index, b.index);
  for (int i = 0; i < 12; ++i) EXPECT_EQ(bitsOf(a.X_OP(i / 4, i % 4)), bitsOf(b.X_OP(i / 4, i % 4)));
  EXPECT_EQ(bitsOf(a.joints.spread), bitsOf(b.joints.spread));
  EXPECT_EQ(bitsOf(a.pregrasp.spread), bitsOf(b.pregrasp.spread));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(bitsOf(a.joints.inner[i]), bitsOf(b.joints.inner[i]));
  EXPECT_EQ(bitsOf(a.approach_m), bitsOf(b.approach_m));
  for (int i = 0; i < 9; ++i) EXPECT_EQ(bitsOf(a.quality[i]), bitsOf(b.quality[i])) << "q" << i + 1;
  EXPECT_EQ(a.box, b.box);
  EXPECT_EQ(a.face, b.face);
}

void expectSame(const TrialContact& a, const TrialContact& b) {
  EXPECT_EQ(a.link, b.link);
  EXPECT_EQ(a.finger, b.finger);
  expectSame(a.p_O, b.p_O);
  expectSame(a.normal_O, b.normal_O);
  expectSame(a.force_O, b.force_O);
}

void expectSame(const GraspLabel& a, const GraspLabel& b) {
  EXPECT_EQ(a.perturbation, b.perturbation);
  EXPECT_EQ(a.seed, b.seed);
  EXPECT_EQ(bitsOf(a.friction), bitsOf(b.friction));
  EXPECT_EQ(bitsOf(a.mass_factor), bitsOf(b.mass_factor));
  EXPECT_EQ(a.outcome, b.outcome);
  EXPECT_EQ(a.force_closure, b.force_closure);
  EXPECT_EQ(bitsOf(a.epsilon), bitsOf(b.epsilon));
  EXPECT_EQ(bitsOf(a.nu), bitsOf(b.nu));
  EXPECT_EQ(bitsOf(a.lift_slip_m), bitsOf(b.lift_slip_m));
  EXPECT_EQ(bitsOf(a.lift_rotation_rad), bitsOf(b.lift_rotation_rad));
  EXPECT_EQ(bitsOf(a.push_force_n), bitsOf(b.push_force_n));
  EXPECT_EQ(bitsOf(a.six_push_displacement_m), bitsOf(b.six_push_displacement_m));
  EXPECT_EQ(a.gravities_held, b.gravities_held);
  ASSERT_EQ(a.contacts.size(), b.contacts.size());
  for (std::size_t i = 0; i < a.contacts.size(); ++i) expectSame(a.contacts[i], b.contacts[i]);
}

class ExperienceStoreTest : public ::testing::Test {
 protected:
  ExperienceStore writer(const std::string& name = "e.db", const std::string& settings = kSettings) const {
    return ExperienceStore::openForWriting(folder_ / name, settings);
  }
  ExperienceStore reader(const std::string& name = "e.db") const {
    return ExperienceStore::openForReading(folder_ / name);
  }

  // One object in two sizes, each with six planned and four random grasps, all labelled.
  void fill(ExperienceStore& store, bool labels_too = true) {
    for (const ModelRecord& model : models_) {
      store.addModel(model, planned_);
      store.addModel(model, random_);
      if (!labels_too) continue;
      store.addLabels(model.key, kPlanner, labels_);
      store.addLabels(model.key, kRandom, random_labels_);
    }
  }

  TemporaryFolder folder_;
  std::mt19937_64 generator_{1};
  std::vector<ModelRecord> models_{someModel("mug", 1.0, generator_), someModel("mug", 0.75, generator_)};
  std::vector<HypothesisRecord> planned_ = someHypotheses(kPlanner, 6, generator_);
  std::vector<HypothesisRecord> random_ = someHypotheses(kRandom, 4, generator_);
  std::vector<IndexedLabel> labels_ = someLabels(6, 2, generator_);
  std::vector<IndexedLabel> random_labels_ = someLabels(4, 0, generator_);
};

TEST_F(ExperienceStoreTest, EverythingReadsBackToTheBit) {
  auto store = writer();
  for (int round = 0; round < 20; ++round) {
    ModelRecord model = someModel(fmt::format("o{}", round), 1.0 / (round + 3), generator_);
    const auto grasps = someHypotheses(kPlanner, 5, generator_);
    const auto labels = someLabels(5, 1, generator_);
    store.addModel(model, grasps);
    store.addLabels(model.key, kPlanner, labels);

    const auto stored = reader().model(model.key);
    ASSERT_TRUE(stored);
    EXPECT_EQ(stored->key, model.key);
    EXPECT_EQ(bitsOf(stored->mass_kg), bitsOf(model.mass_kg));
    EXPECT_EQ(bitsOf(stored->size_m), bitsOf(model.size_m));
    EXPECT_EQ(stored->boxes, 7);
    EXPECT_EQ(stored->triplets, model.triplets);
    EXPECT_EQ(stored->message, model.message);
    const auto labelled = store.labelled(model.key, kPlanner);
    ASSERT_EQ(labelled.size(), 5u);
    for (int i = 0; i < 5; ++i) {
      expectSame(labelled[i].hypothesis, grasps[i]);
      ASSERT_EQ(labelled[i].labels.size(), 2u);
      for (int k = 0; k < 2; ++k) expectSame(labelled[i].labels[k], labels[2 * i + k].label);
    }
  }
}

TEST_F(ExperienceStoreTest, AddingAgainChangesNothing) {
  auto store = writer();
  fill(store);
  const std::string once = dumpOf(store);
  fill(store);
  EXPECT_EQ(dumpOf(store), once);
}

TEST_F(ExperienceStoreTest, TheOrderOfAddingDoesNotShow) {
  auto store = writer("a.db"), other = writer("b.db");
  fill(store);
  std::swap(models_[0], models_[1]);
  std::reverse(random_.begin(), random_.end());
  std::shuffle(labels_.begin(), labels_.end(), generator_);
  fill(other);
  EXPECT_EQ(dumpOf(store), dumpOf(other));
  EXPECT_EQ(store.contentHash(), other.contentHash());
}

TEST_F(ExperienceStoreTest, TheDumpSeesEveryBit) {
  auto store = writer("a.db"), other = writer("b.db");
  fill(store);
  labels_[3].label.push_force_n = -0.0;
  labels_[3].label.nu = 0.1;
  auto third = writer("c.db");
  fill(other);
  labels_[3].label.nu = std::nextafter(0.1, 1.0);
  fill(third);
  EXPECT_NE(store.contentHash(), other.contentHash());
  EXPECT_NE(third.contentHash(), other.contentHash());
}

TEST_F(ExperienceStoreTest, OtherContentIsRefusedByNameAndNothingOfTheBatchStays) {
  auto store = writer();
  fill(store);
  const std::string before = dumpOf(store);
  labels_[4].label.nu = 0.25;
  labels_.insert(labels_.begin(), {0, someLabel(9, generator_)});
  EXPECT_THAT(
      errorOf([&] { store.addLabels(models_[0].key, kPlanner, labels_); }),
      AllOf(HasSubstr("label 1 of mug@1.00/whole/planner/1"), HasSubstr("nu is nan there, and 0.25 here")));
  planned_[2].box = 99;
  EXPECT_THAT(errorOf([&] { store.addModel(models_[0], planned_); }),
              AllOf(HasSubstr("mug@1.00/whole/planner/2"), HasSubstr("box is 3 there, and 99 here")));
  models_[0].leaves = 5;
  EXPECT_THAT(errorOf([&] { store.addModel(models_[0], {}); }), HasSubstr("leaves is 0 there, and 5 here"));
  EXPECT_EQ(dumpOf(store), before);
}

TEST_F(ExperienceStoreTest, KnowsWhatIsMissing) {
  auto store = writer();
  fill(store, false);
  const ModelKey& key = models_[0].key;
  EXPECT_EQ(store.missing(key, kPlanner, 2).size(), 18u);
  EXPECT_EQ(store.missing(key, kRandom, 0).size(), 4u);
  std::erase_if(labels_, [](const IndexedLabel& label) {
    return (label.index == 1 && label.label.perturbation == 2) || label.index == 4;
  });
  store.addLabels(key, kPlanner, labels_);
  EXPECT_THAT(store.missing(key, kPlanner, 2),
              ElementsAre(LabelSlot{1, 2}, LabelSlot{4, 0}, LabelSlot{4, 1}, LabelSlot{4, 2}));
  EXPECT_THAT(store.missing(key, kPlanner, 0), ElementsAre(LabelSlot{4, 0}));
  EXPECT_EQ(store.missing(models_[1].key, kPlanner, 2).size(), 18u);
  EXPECT_EQ(store.labelled(key, kPlanner).size(), 5u);
}

TEST_F(ExperienceStoreTest, CountsByModelAndSource) {
  auto store = writer();
  fill(store);
  const auto counts = store.counts();
  ASSERT_EQ(counts.size(), 4u);
  EXPECT_EQ(counts[0].model, models_[1].key);
  EXPECT_EQ(counts[2].model, models_[0].key);
  EXPECT_EQ(counts[2].source, kPlanner);
  EXPECT_EQ(counts[2].hypotheses, 6);
  EXPECT_EQ(counts[2].labels, 18);
  EXPECT_EQ(counts[3].hypotheses, 4);
  for (int outcome = 0; outcome < 6; ++outcome) {
    const auto expected = std::ranges::count_if(labels_, [&](const IndexedLabel& label) {
      return label.label.perturbation == 0 && label.label.outcome == static_cast<TrialOutcome>(outcome);
    });
    EXPECT_EQ(counts[2].outcomes[outcome], expected) << describe(static_cast<TrialOutcome>(outcome));
  }
}

TEST_F(ExperienceStoreTest, ShardsMergeIntoTheWhole) {
  auto whole = writer("whole.db"), merged = writer("merged.db");
  fill(whole);
  const auto models = models_;
  for (const ModelRecord& model : models) {
    auto shard = writer("shard.db");
    models_ = {model};
    fill(shard);
    merged.merge(shard);
    merged.merge(reader("shard.db"));
  }
  EXPECT_EQ(dumpOf(merged), dumpOf(whole));
  EXPECT_EQ(merged.merge(whole).labels, 0);
}

TEST_F(ExperienceStoreTest, MergingFillsGapsAndRefusesOtherContent) {
  auto store = writer("a.db"), other = writer("b.db");
  fill(other);
  labels_.resize(5);
  random_labels_.clear();
  fill(store);
  const MergeCounts added = store.merge(other);
  EXPECT_EQ(added.models, 0);
  EXPECT_EQ(added.labels, 2 * (13 + 4));
  EXPECT_EQ(dumpOf(store), dumpOf(other));

  auto third = writer("c.db");
  labels_[2].label.gravities_held = 4;
  fill(third);
  EXPECT_THAT(errorOf([&] { store.merge(third); }), HasSubstr("label 2 of mug@0.75/whole/planner/0"));
  EXPECT_EQ(dumpOf(store), dumpOf(other));
}

TEST_F(ExperienceStoreTest, SettingsNeverMix) {
  { auto store = writer(); }
  EXPECT_EQ(reader().settings(), kSettings);
  EXPECT_THAT(errorOf([&] { writer("e.db", "hand = barrett\nseed = 2\nversion = 0.1.0\n"); }),
              AllOf(HasSubstr("e.db"), HasSubstr("line 2 is 'seed = 1' there, and 'seed = 2' here")));
  EXPECT_THAT(errorOf([&] { writer("e.db", std::string(kSettings) + "cone = 8\n"); }),
              HasSubstr("line 4 is '' there, and 'cone = 8' here"));
  EXPECT_THAT(errorOf([&] { writer("e.db", "hand = barrett\n"); }), HasSubstr("line 2 is 'seed = 1' there"));
  auto other = writer("o.db", "seed = 2");
  EXPECT_THAT(errorOf([&] { writer().merge(other); }), HasSubstr("other settings"));
}

TEST_F(ExperienceStoreTest, OneWriterAndReadersBesideIt) {
  auto store = writer();
  EXPECT_THAT(errorOf([&] { writer(); }),
              AllOf(HasSubstr("e.db"), HasSubstr("another process"), HasSubstr("merge")));
  const auto early = reader();
  fill(store);
  EXPECT_EQ(dumpOf(early), dumpOf(store));
}

TEST_F(ExperienceStoreTest, RefusesWhatHasNoPlace) {
  auto store = writer();
  fill(store);
  const ModelKey stranger{"cup", 1.0, "whole"};
  EXPECT_THAT(errorOf([&] { store.addLabels(stranger, kPlanner, labels_); }),
              HasSubstr("no model 'cup@1.00/whole'"));
  EXPECT_THAT(errorOf([&] { store.labelled(stranger, kPlanner); }), HasSubstr("no model 'cup@1.00/whole'"));
  EXPECT_FALSE(store.model(stranger));
  EXPECT_THAT(errorOf([&] {
                store.addLabels(models_[0].key, kPlanner, {{77, someLabel(0, generator_)}});
              }),
              HasSubstr("no grasp 'mug@1.00/whole/planner/77'"));
  for (const ModelKey& key : {ModelKey{"a", 1.0, "le/ft"}, ModelKey{"", 1.0, "x"}, ModelKey{"a", NAN, "x"},
                              ModelKey{"a", 1.0, ""}, ModelKey{"a\nb", 1.0, "x"}}) {
    ModelRecord model = models_[0];
    model.key = key;
    EXPECT_NE(errorOf([&] { store.addModel(model, {}); }), "accepted") << formatModelKey(key);
  }
  EXPECT_NE(errorOf([&] { store.addModel(models_[0], {someHypothesis(kPlanner, -1, generator_)}); }),
            "accepted");
}

}  // namespace
}  // namespace boxgrasp
