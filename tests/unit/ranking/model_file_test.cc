#include "boxgrasp/ranking/model_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>

#include "boxgrasp/base/error.h"
#include "random_network.h"

namespace boxgrasp {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

// A folder that is gone with the test.
class ModelFile : public ::testing::Test {
 protected:
  ModelFile() {
    std::string pattern = (fs::temp_directory_path() / "boxgrasp-model-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
  }
  ~ModelFile() override { fs::remove_all(folder_); }
  fs::path path() const { return folder_ / "model.json"; }

  fs::path folder_;
};

Model sample(const std::vector<int>& widths = {2, 2}) {
  Model model;
  model.name = "analytic-s";
  model.trained_on = "labels by formula, not by \"grasping\"; naïve\n";
  model.command = "boxgrasp-train --seed 7";
  model.data_hash = blake2bHex("data");
  model.seed = std::numeric_limits<std::uint64_t>::max();
  model.created = "2026-01-02T03:04:05Z";
  model.ensemble.networks = {test::randomNetwork(widths, 11), test::randomNetwork(widths, 12)};
  model.ensemble.calibration = {2.5, -0.1};
  for (int i = 0; i < widths.front(); ++i) model.features.push_back(fmt::format("q{}", i + 1));
  model.metrics = {{"s_net", 0.078}, {"s_net_fraction", 0.61}};
  return model;
}

Model withRecollections() {
  Model model = sample();
  std::mt19937 random(3);
  for (int i = 0; i < 2; ++i) {
    Recollection recollection{{0.1 + 0.1 * i, {}}, {}, VectorXd{{0.25, -0.5}}};
    for (std::size_t k = 0; k < recollection.constellation.cells.size(); ++k)
      recollection.constellation.cells[k] = random() % 2;
    recollection.places = {{{0.1, 0.2 * i, 0.3}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ()},
                           {{-0.1, 0.0, 1.0 / 3}, Eigen::Vector3d::UnitY(), -Eigen::Vector3d::UnitX()}};
    model.recollections.push_back(recollection);
  }
  return model;
}

std::string textOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::string errorOf(const std::string& json) {
  try {
    parseModel(json, "somewhere.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from << " is not in the model file";
  return text.replace(at, from.size(), to);
}

template <typename A, typename B>
bool sameBits(const A& a, const B& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

void expectSame(const Network& a, const Network& b) {
  for (const auto n : {&Network::input, &Network::output}) {
    EXPECT_TRUE(sameBits((a.*n).min, (b.*n).min));
    EXPECT_TRUE(sameBits((a.*n).max, (b.*n).max));
  }
  ASSERT_EQ(a.layers.size(), b.layers.size());
  for (std::size_t l = 0; l < a.layers.size(); ++l) {
    EXPECT_TRUE(sameBits(a.layers[l].weights, b.layers[l].weights)) << "layer " << l;
    EXPECT_TRUE(sameBits(a.layers[l].bias, b.layers[l].bias)) << "layer " << l;
  }
}

void expectSame(const Model& a, const Model& b) {
  EXPECT_EQ(a.version, b.version);
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.trained_on, b.trained_on);
  EXPECT_EQ(a.command, b.command);
  EXPECT_EQ(a.data_hash, b.data_hash);
  EXPECT_EQ(a.seed, b.seed);
  EXPECT_EQ(a.created, b.created);
  EXPECT_EQ(a.features, b.features);
  EXPECT_EQ(a.metrics, b.metrics);
  ASSERT_EQ(a.ensemble.networks.size(), b.ensemble.networks.size());
  for (std::size_t i = 0; i < a.ensemble.networks.size(); ++i)
    expectSame(a.ensemble.networks[i], b.ensemble.networks[i]);
  ASSERT_EQ(a.ensemble.calibration.has_value(), b.ensemble.calibration.has_value());
  if (!a.ensemble.calibration) return;
  EXPECT_EQ(a.ensemble.calibration->slope, b.ensemble.calibration->slope);
  EXPECT_EQ(a.ensemble.calibration->offset, b.ensemble.calibration->offset);
}

TEST_F(ModelFile, ReadsBackToTheBit) {
  for (const auto& widths :
       std::vector<std::vector<int>>{{1}, {9, 8}, {3, 4, 5, 6}, {1, 2, 3, 4, 5, 6, 7, 8}}) {
    const Model written = writeModel(sample(widths), path());
    expectSame(readModel(path()), written);
  }
}

TEST_F(ModelFile, ReadsBackAModelWithoutCalibration) {
  Model model = sample();
  model.ensemble.calibration.reset();
  const Model written = writeModel(model, path());
  expectSame(readModel(path()), written);
  EXPECT_NE(written.version, modelVersion(sample())) << "the calibration is content";
}

TEST_F(ModelFile, ReadsBackWhatTheModelRemembers) {
  const Model written = writeModel(withRecollections(), path());
  const Model read = readModel(path());
  EXPECT_NE(written.version, writeModel(sample(), folder_ / "without.json").version);
  ASSERT_EQ(read.recollections.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const Recollection &a = read.recollections[i], &b = written.recollections[i];
    EXPECT_EQ(a.constellation.cells, b.constellation.cells);
    EXPECT_EQ(a.constellation.unit_m, b.constellation.unit_m);
    EXPECT_TRUE(sameBits(a.surprises, b.surprises));
    ASSERT_EQ(a.places.size(), b.places.size());
    for (std::size_t k = 0; k < a.places.size(); ++k) {
      EXPECT_TRUE(sameBits(a.places[k].contacts, b.places[k].contacts));
      EXPECT_TRUE(sameBits(a.places[k].approach, b.places[k].approach));
      EXPECT_TRUE(sameBits(a.places[k].thumb, b.places[k].thumb));
    }
  }
}

TEST_F(ModelFile, RefusesRecollectionsThatAreNone) {
  writeModel(withRecollections(), path());
  const std::string text = textOf(path());
  const auto error = [&](const char* from, const char* to) { return errorOf(replaced(text, from, to)); };
  EXPECT_THAT(error("\"cells\": \"", "\"cells\": \"x"),
              AllOf(HasSubstr("recollections[0].cells"), HasSubstr("1024 hexadecimal digits")));
  EXPECT_THAT(error("\"unit_m\": 0.1", "\"unit_m\": -0.1"), HasSubstr("'unit_m' is -0.1"));
  EXPECT_THAT(error("\"unit_m\": 0.1", "\"unit\": 0.1"), HasSubstr("lacks the key 'unit_m'"));
  EXPECT_THAT(error("0.25,", ""), HasSubstr("'the number of surprises' is 1"));
  EXPECT_THAT(error("0.25,", "\"a\","), HasSubstr("recollections[0].surprises[0]"));
}

TEST_F(ModelFile, KeepsExtremeNumbersToTheBit) {
  Model model = sample();
  auto& weights = model.ensemble.networks[0].layers[0].weights;
  weights << -0.0, std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::max(), 0.1 + 0.2;
  const Model written = writeModel(model, path());
  expectSame(readModel(path()), written);
  EXPECT_TRUE(std::signbit(readModel(path()).ensemble.networks[0].layers[0].weights(0, 0)));
}

TEST_F(ModelFile, HasTheVersionOfItsContent) {
  const Model written = writeModel(sample(), path());
  EXPECT_THAT(written.version, ::testing::MatchesRegex("[0-9a-f]{8}"));
  EXPECT_EQ(written.version, modelVersion(sample()));
  Model other = sample();
  other.ensemble.networks[0].layers[0].bias[0] =
      std::nextafter(other.ensemble.networks[0].layers[0].bias[0], 1e9);
  EXPECT_NE(modelVersion(other), written.version) << "the last bit of a weight is content";
  other = written;
  other.version = "whatever";
  EXPECT_EQ(modelVersion(other), written.version) << "the version itself is not content";
}

TEST_F(ModelFile, IsTheSameWhenWrittenAgain) {
  writeModel(sample(), path());
  const std::string first = textOf(path());
  writeModel(readModel(path()), path());
  EXPECT_EQ(textOf(path()), first);
}

TEST_F(ModelFile, RefusesEveryTruncation) {
  writeModel(sample(), path());
  const std::string text = textOf(path());
  ASSERT_EQ(text.back(), '\n');
  for (std::size_t n = 0; n + 1 < text.size(); ++n) {
    EXPECT_THAT(errorOf(text.substr(0, n)), HasSubstr("somewhere.json")) << "cut to " << n << " bytes";
  }
}

// A changed byte is either refused or, as in white space or the last digits of a number, changes nothing.
TEST_F(ModelFile, RefusesEveryChangedByteOrReadsTheSame) {
  const Model written = writeModel(sample({1, 1}), path());
  const std::string text = textOf(path());
  std::size_t refused = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    for (const char change : {'\x01', '\x04', '\x20', '\x80', '\xff'}) {
      std::string changed = text;
      changed[i] = static_cast<char>(changed[i] ^ change);
      try {
        expectSame(parseModel(changed, "x"), written);
      } catch (const InputError&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 4 * text.size()) << "of " << 5 * text.size() << " changes nearly all matter";
}

TEST_F(ModelFile, NamesFileAndKeyOfWhatIsWrong) {
  writeModel(sample(), path());
  const std::string text = textOf(path());
  const auto error = [&](const std::string& from, const std::string& to) {
    return errorOf(replaced(text, from, to));
  };
  EXPECT_EQ(errorOf(text), "accepted");
  EXPECT_THAT(
      error("\"format_version\": 2", "\"format_version\": 1"),
      AllOf(HasSubstr("somewhere.json"), HasSubstr("'format_version' is 1, but this program knows 2")));
  EXPECT_THAT(error("\"format_version\": 2", "\"format_version\": -1"), HasSubstr("format_version"));
  EXPECT_THAT(error("\"format_version\"", "\"formatversion\""), HasSubstr("lacks the key 'format_version'"));
  EXPECT_THAT(error("boxgrasp-model", "boxgrasp-other"), HasSubstr("is not a model"));
  EXPECT_THAT(error("\"seed\": ", "\"seed\": -"), HasSubstr("seed"));
  EXPECT_THAT(error("\"trained_on\"", "\"trained-on\""), HasSubstr("lacks the key 'trained_on'"));
  EXPECT_THAT(error("\"bias\"", "\"extra\": 1, \"bias\""),
              HasSubstr("'networks[0].layers[0]' has the unknown key 'extra'"));
  EXPECT_THAT(error("\"s_net\": 0.078", "\"s_net\": \"high\""),
              HasSubstr("'metrics.s_net' must be a number, but is string"));
  EXPECT_THAT(error("\"s_net\": 0.078", "\"s_net\": 0.079"), HasSubstr("it was changed"));
  EXPECT_THAT(error("\"s_net\": 0.078", "\"s_net\": 1e999"), HasSubstr("somewhere.json"));
  EXPECT_THAT(error("\"s_net\": 0.078", "\"s_net\": NaN"), HasSubstr("not valid JSON"));
  EXPECT_THAT(error("\"q1\",", ""), HasSubstr("'features' has 1 names for 2 inputs"));
  EXPECT_THAT(error("\"weights\": [\n", "\"weights\": [[1.0],\n"),
              HasSubstr("'networks[0].layers[0].weights[1]' has 2 entries"));
  EXPECT_THAT(error("\"weights\": [\n", "\"weights\": [null,\n"), HasSubstr("must be an array, but is null"));
}

TEST(ModelText, RefusesHostileContent) {
  EXPECT_THAT(errorOf(""), HasSubstr("not valid JSON"));
  EXPECT_THAT(errorOf("null"), HasSubstr("is not a model"));
  EXPECT_THAT(errorOf("[]"), HasSubstr("is not a model"));
  EXPECT_THAT(errorOf("{}"), HasSubstr("is not a model"));
  EXPECT_THAT(errorOf(std::string(1'000'000, '[')), HasSubstr("nested deeper"));
  EXPECT_THAT(errorOf(std::string("\0\0\0", 3)), HasSubstr("not valid JSON"));
  EXPECT_THAT(errorOf("{\"format\":\"boxgrasp-model\",\"format_version\":2}"), HasSubstr("lacks the key"));
}

std::string withLayers(const std::string& layers) {
  return R"({"format":"boxgrasp-model","format_version":2,"version":"0","name":"","trained_on":"","command":"",)"
         R"("data_hash":"","seed":0,"created":"","features":["a"],"metrics":{},"calibration":null,"networks":[{"input":{"min":[0],"max":[1]},)"
         R"("output":{"min":[0],"max":[1]},"layers":)" +
         layers + "}]}";
}

TEST(ModelText, RefusesImpossibleSizes) {
  const std::string layer = R"({"weights":[[1]],"bias":[0]})";
  std::string nine = layer, wide = "0";
  for (int i = 0; i < 8; ++i) nine += "," + layer;
  for (int i = 0; i < 1024; ++i) wide += ",0";
  EXPECT_THAT(errorOf(withLayers("[" + layer + "]")), HasSubstr("it was changed"))
      << "sizes are fine, only the version is not";
  EXPECT_THAT(errorOf(withLayers("[" + nine + "]")),
              HasSubstr("'networks[0].layers' has 9 entries, but at most 8"));
  EXPECT_THAT(errorOf(withLayers(R"([{"weights":[[1]],"bias":[)" + wide + "]}]")), HasSubstr("at most 1024"));
  EXPECT_THAT(errorOf(withLayers(R"([{"weights":[)" + wide + R"(],"bias":[0]}])")),
              HasSubstr("at most 1024"));
  EXPECT_THAT(errorOf(withLayers("[]")), HasSubstr("networks[0]: network: layers are 0"));
  EXPECT_THAT(errorOf(withLayers(R"([{"weights":[],"bias":[]}])")), HasSubstr("layers[0] takes 0 inputs"));
  EXPECT_THAT(errorOf(withLayers(R"([{"weights":[[]],"bias":[0]}])")), HasSubstr("layers[0] takes 0 inputs"));
  EXPECT_THAT(errorOf(withLayers(R"([{"weights":[[1]],"bias":[0,0]}])")),
              HasSubstr("layers[0] has 2 biases"));
}

TEST_F(ModelFile, RefusesToReadWhatIsNotAFile) {
  EXPECT_THROW(readModel(folder_ / "absent.json"), InputError);
  EXPECT_THROW(readModel(folder_), InputError);
  EXPECT_THROW(readModel("/dev/zero"), InputError);
  std::ofstream(path()).close();
  fs::resize_file(path(), 33u << 20);
  EXPECT_THROW(readModel(path()), InputError) << "larger than any model";
}

TEST_F(ModelFile, RefusesToWriteWhatCouldNotBeRead) {
  Model model = sample();
  model.ensemble.networks[0].layers[0].weights(0, 0) = NAN;
  EXPECT_THROW(writeModel(model, path()), InputError);
  model = sample();
  model.ensemble.networks.clear();
  EXPECT_THROW(writeModel(model, path()), InputError);
  model = sample();
  model.ensemble.networks[1] = test::randomNetwork({3, 2}, 1);
  EXPECT_THROW(writeModel(model, path()), InputError);
  model = sample();
  model.ensemble.calibration->slope = -1.0;
  EXPECT_THROW(writeModel(model, path()), InputError);
  model = sample();
  model.metrics["s_net"] = INFINITY;
  EXPECT_THROW(writeModel(model, path()), InputError);
  model = sample();
  model.features.push_back("one too many");
  EXPECT_THROW(writeModel(model, path()), InputError);
  model = sample();
  model.name = "\xff\xfe";
  EXPECT_THROW(writeModel(model, path()), InputError);
  EXPECT_FALSE(fs::exists(path()));
}

TEST_F(ModelFile, LeavesTheOldFileAloneWhenWritingFails) {
  const Model old = writeModel(sample(), path());
  Model broken = sample();
  broken.ensemble.networks[0].layers.clear();
  EXPECT_THROW(writeModel(broken, path()), InputError);
  EXPECT_THROW(writeModel(sample(), folder_ / "absent" / "model.json"), InputError);
  fs::create_directory(folder_ / "taken");
  EXPECT_THROW(writeModel(sample(), folder_ / "taken"), InputError);
  expectSame(readModel(path()), old);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 2) << "no temporary file stays behind";
}

TEST_F(ModelFile, IsReadableByAll) {
  writeModel(sample(), path());
  struct stat status {};
  ASSERT_EQ(::stat(path().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0644u);
}

// Computed with another implementation of BLAKE2b (RFC 7693), digest of 32 bytes, no key.
TEST(Blake2b, AgreesWithKnownDigests) {
  EXPECT_EQ(blake2bHex("abc"), "bddd813c634239723171ef3fee98579b94964e3bb1cb3e427262c8c068d52319");
  EXPECT_EQ(blake2bHex(""), "0e5751c026e543b2e8ab2eb06099daa1d1e5df47778f7787faab45cdf12fe3a8");
}

}  // namespace
}  // namespace boxgrasp
