#include "boxgrasp/ranking/model_file.h"

#include <sodium.h>

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "boxgrasp/base/durable_file.h"
#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

using Eigen::Index;
using nlohmann::json;

constexpr const char* kFormat = "boxgrasp-model";
constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{32} << 20;
constexpr int kMaxDepth = 8;  // of nested arrays and objects; a model has 6
constexpr const char* kRemedy = "restore the file or train the model again";

// --- to JSON

json toJson(const VectorXd& v) { return std::vector<double>(v.begin(), v.end()); }

json toJson(const MatrixXd& m) {
  json rows = json::array();
  for (const auto& row : m.rowwise()) rows.push_back(toJson(VectorXd(row)));
  return rows;
}

json toJson(const Normalisation& n) { return {{"min", toJson(n.min)}, {"max", toJson(n.max)}}; }

json toJson(const Network& network) {
  json layers = json::array();
  for (const Layer& layer : network.layers) {
    layers.push_back({{"weights", toJson(layer.weights)}, {"bias", toJson(layer.bias)}});
  }
  return {{"input", toJson(network.input)}, {"output", toJson(network.output)}, {"layers", layers}};
}

json toJson(const std::vector<Network>& networks) {
  json list = json::array();
  for (const Network& network : networks) list.push_back(toJson(network));
  return list;
}

// null: none.
json toJson(const std::optional<Calibration>& calibration) {
  if (!calibration) return nullptr;
  return {{"slope", calibration->slope}, {"offset", calibration->offset}};
}

std::string toHex(const Constellation::Cells& cells) {
  std::string hex;
  for (std::size_t i = 0; i < cells.size(); i += 4)
    hex += "0123456789abcdef"[cells[i] + 2 * cells[i + 1] + 4 * cells[i + 2] + 8 * cells[i + 3]];
  return hex;
}

json toJson(const Recollection& recollection) {
  json places = json::array();
  for (const GraspPlace& place : recollection.places) {
    VectorXd row(9);
    row << place.contacts, place.approach, place.thumb;
    places.push_back(toJson(row));
  }
  return {{"unit_m", recollection.constellation.unit_m},
          {"cells", toHex(recollection.constellation.cells)},
          {"places", places},
          {"surprises", toJson(recollection.surprises)}};
}

json contentOf(const Model& model) {
  json content{{"format", kFormat},
               {"format_version", Model::kFormatVersion},
               {"name", model.name},
               {"trained_on", model.trained_on},
               {"command", model.command},
               {"data_hash", model.data_hash},
               {"seed", model.seed},
               {"created", model.created},
               {"features", model.features},
               {"metrics", model.metrics},
               {"networks", toJson(model.ensemble.networks)},
               {"calibration", toJson(model.ensemble.calibration)}};
  for (const Recollection& recollection : model.recollections)
    content["recollections"].push_back(toJson(recollection));
  return content;
}

// --- from JSON

// A JSON value with its place, for messages: every mismatch throws InputError naming file and key.
class Node {
 public:
  Node(const json& value, const std::string& file, std::string key)
      : value_(value), file_(file), key_(std::move(key)) {}

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("model file '{}': {} {}; {}", file_,
                                 key_.empty() ? "the content" : "key '" + key_ + "'", what, kRemedy));
  }

  // This object's member, which must be there.
  Node at(const char* key) const { return {value_.at(key), file_, key_.empty() ? key : key_ + "." + key}; }

  bool has(const char* key) const { return value_.contains(key); }

  void requireKeys(const std::set<std::string>& all, const std::set<std::string>& optional = {}) const {
    if (!value_.is_object()) fail(fmt::format("must be an object, but is {}", value_.type_name()));
    for (const auto& key : all) {
      if (!value_.contains(key)) fail(fmt::format("lacks the key '{}'", key));
    }
    for (const auto& item : value_.items()) {
      if (!all.contains(item.key()) && !optional.contains(item.key()))
        fail(fmt::format("has the unknown key '{}'", item.key()));
    }
  }

  std::vector<Node> items(std::size_t most) const {
    if (!value_.is_array()) fail(fmt::format("must be an array, but is {}", value_.type_name()));
    if (value_.size() > most)
      fail(fmt::format("has {} entries, but at most {} are allowed", value_.size(), most));
    std::vector<Node> nodes;
    for (std::size_t i = 0; i < value_.size(); ++i) {
      nodes.emplace_back(value_[i], file_, fmt::format("{}[{}]", key_, i));
    }
    return nodes;
  }

  bool isNull() const { return value_.is_null(); }

  std::string text() const {
    if (!value_.is_string()) fail(fmt::format("must be a string, but is {}", value_.type_name()));
    return value_.get<std::string>();
  }

  double number() const {
    if (!value_.is_number()) fail(fmt::format("must be a number, but is {}", value_.type_name()));
    return value_.get<double>();
  }

  std::uint64_t natural() const {
    if (!value_.is_number_unsigned())
      fail(fmt::format("must be a whole number >= 0, but is {}", value_.dump()));
    return value_.get<std::uint64_t>();
  }

  std::map<std::string, double> numbersByName() const {
    if (!value_.is_object()) fail(fmt::format("must be an object, but is {}", value_.type_name()));
    std::map<std::string, double> result;
    for (const auto& item : value_.items()) result[item.key()] = at(item.key().c_str()).number();
    return result;
  }

  VectorXd vector() const {
    const std::vector<Node> entries = items(Network::kMaxNodes);
    VectorXd result(static_cast<Index>(entries.size()));
    for (std::size_t i = 0; i < entries.size(); ++i) result[static_cast<Index>(i)] = entries[i].number();
    return result;
  }

  MatrixXd matrix() const {
    std::vector<VectorXd> rows;
    for (const Node& node : items(Network::kMaxNodes)) {
      rows.push_back(node.vector());
      if (rows.back().size() != rows.front().size()) {
        node.fail(fmt::format("has {} entries, but the row before has {}", rows.back().size(),
                              rows.front().size()));
      }
    }
    MatrixXd result(static_cast<Index>(rows.size()), rows.empty() ? 0 : rows.front().size());
    for (std::size_t r = 0; r < rows.size(); ++r) result.row(static_cast<Index>(r)) = rows[r];
    return result;
  }

 private:
  const json& value_;
  const std::string& file_;
  std::string key_;
};

Normalisation normalisationFrom(const Node& node) {
  node.requireKeys({"min", "max"});
  return {node.at("min").vector(), node.at("max").vector()};
}

Network networkFrom(const Node& node) {
  node.requireKeys({"input", "output", "layers"});
  Network network{normalisationFrom(node.at("input")), normalisationFrom(node.at("output")), {}};
  for (const Node& layer : node.at("layers").items(Network::kMaxLayers)) {
    layer.requireKeys({"weights", "bias"});
    network.layers.push_back({layer.at("weights").matrix(), layer.at("bias").vector()});
  }
  return network;
}

std::optional<Calibration> calibrationFrom(const Node& node) {
  if (node.isNull()) return std::nullopt;
  node.requireKeys({"slope", "offset"});
  return Calibration{node.at("slope").number(), node.at("offset").number()};
}

Constellation::Cells cellsFrom(const Node& node) {
  Constellation::Cells cells;
  const std::string hex = node.text();
  if (hex.size() != cells.size() / 4 || hex.find_first_not_of("0123456789abcdef") != std::string::npos)
    node.fail(fmt::format("must be {} hexadecimal digits", cells.size() / 4));
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const char digit = hex[i / 4];
    cells[i] = ((digit <= '9' ? digit - '0' : digit - 'a' + 10) >> (i % 4)) & 1;
  }
  return cells;
}

GraspPlace placeFrom(const Node& node) {
  const VectorXd row = node.vector();
  if (row.size() != 9) node.fail(fmt::format("has {} numbers, but must have 9", row.size()));
  return {row.segment<3>(0), row.segment<3>(3), row.segment<3>(6)};
}

Recollection recollectionFrom(const Node& node) {
  node.requireKeys({"unit_m", "cells", "places", "surprises"});
  Recollection recollection{{node.at("unit_m").number(), cellsFrom(node.at("cells"))}, {}, {}};
  for (const Node& place : node.at("places").items(Recollection::kMaxGrasps))
    recollection.places.push_back(placeFrom(place));
  recollection.surprises = node.at("surprises").vector();
  return recollection;
}

// Before anything else, so that a file of a later format is told apart from a damaged one.
void checkFormat(const json& content, const Node& root) {
  if (!content.is_object() || content.value("format", json()) != json(kFormat)) {
    root.fail(fmt::format("is not a model: there is no key 'format' that says '{}'", kFormat));
  }
  if (!content.contains("format_version")) root.fail("lacks the key 'format_version'");
  const std::uint64_t version = root.at("format_version").natural();
  if (version != Model::kFormatVersion) {
    root.at("format_version")
        .fail(fmt::format("is {}, but this program knows {} alone", version, Model::kFormatVersion));
  }
}

Model modelFrom(const Node& root) {
  root.requireKeys({"format", "format_version", "version", "name", "trained_on", "command", "data_hash",
                    "seed", "created", "features", "metrics", "networks", "calibration"},
                   {"recollections"});
  Model model;
  model.version = root.at("version").text();
  model.name = root.at("name").text();
  model.trained_on = root.at("trained_on").text();
  model.command = root.at("command").text();
  model.data_hash = root.at("data_hash").text();
  model.seed = root.at("seed").natural();
  model.created = root.at("created").text();
  for (const Node& feature : root.at("features").items(Network::kMaxNodes))
    model.features.push_back(feature.text());
  model.metrics = root.at("metrics").numbersByName();
  for (const Node& network : root.at("networks").items(Ensemble::kMaxNetworks))
    model.ensemble.networks.push_back(networkFrom(network));
  model.ensemble.calibration = calibrationFrom(root.at("calibration"));
  if (root.has("recollections")) {
    for (const Node& node : root.at("recollections").items(Recollection::kMaxObjects))
      model.recollections.push_back(recollectionFrom(node));
  }
  return model;
}

json parseJson(const std::string& text, const std::string& file) {
  const auto limitDepth = [&](int depth, json::parse_event_t, json&) {
    if (depth > kMaxDepth) {
      throw InputError(
          fmt::format("model file '{}': nested deeper than {} levels; {}", file, kMaxDepth, kRemedy));
    }
    return true;
  };
  try {
    return json::parse(text, limitDepth);
  } catch (const json::exception& error) {
    throw InputError(fmt::format("model file '{}': not valid JSON, damaged or cut short ({}); {}", file,
                                 error.what(), kRemedy));
  }
}

void checkModel(const Model& model, const std::string& file) {
  const auto fail = [&](const std::string& what) {
    throw InputError(fmt::format("model file '{}': {}", file, what));
  };
  try {
    model.ensemble.validate();
    for (const Recollection& recollection : model.recollections) recollection.validate();
  } catch (const InputError& error) {
    fail(error.what());
  }
  if (model.features.size() != static_cast<std::size_t>(model.ensemble.inputs())) {
    fail(fmt::format("key 'features' has {} names for {} inputs; {}", model.features.size(),
                     model.ensemble.inputs(), kRemedy));
  }
  for (const auto& [name, value] : model.metrics) {
    if (!std::isfinite(value))
      fail(fmt::format("key 'metrics.{}' is {}, but must be finite; leave it out", name, value));
  }
}

// --- files

std::string readAll(const std::filesystem::path& file) {
  const auto fail = [&](const std::string& why) {
    return InputError(
        fmt::format("model file '{}': {}; check the path and its permissions", file.string(), why));
  };
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) throw fail("there is no such regular file");
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) throw fail(error.message());
  if (size > kMaxFileBytes)
    throw fail(fmt::format("has {} bytes, more than the {} of the largest model", size, kMaxFileBytes));
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw fail("cannot be opened");
  std::string text(size, '\0');
  if (!stream.read(text.data(), static_cast<std::streamsize>(size))) throw fail("cannot be read");
  return text;
}

}  // namespace

Model parseModel(const std::string& text, const std::string& name_for_errors) {
  const json content = parseJson(text, name_for_errors);
  const Node root(content, name_for_errors, "");
  checkFormat(content, root);
  Model model = modelFrom(root);
  checkModel(model, name_for_errors);
  const std::string expected = modelVersion(model);
  if (model.version != expected) {
    root.at("version").fail(
        fmt::format("is '{}', but the content's is '{}': it was changed", model.version, expected));
  }
  return model;
}

Model readModel(const std::filesystem::path& file) { return parseModel(readAll(file), file.string()); }

Model writeModel(const Model& model, const std::filesystem::path& file) {
  checkModel(model, file.string());
  Model written = model;
  try {
    written.version = modelVersion(model);
    json content = contentOf(model);
    content["version"] = written.version;
    const std::string text = content.dump(1) + "\n";
    if (text.size() > kMaxFileBytes) {
      throw InputError(fmt::format(
          "model file '{}': {} bytes are more than the {} that can be read back; train a smaller network",
          file.string(), text.size(), kMaxFileBytes));
    }
    writeDurably(file, text);
  } catch (const json::exception& error) {
    throw InputError(fmt::format("model file '{}': a text is not valid UTF-8 ({}); correct it", file.string(),
                                 error.what()));
  }
  return written;
}

std::string modelVersion(const Model& model) { return blake2bHex(contentOf(model).dump()).substr(0, 8); }

std::string blake2bHex(std::string_view bytes) {
  if (sodium_init() < 0) throw std::runtime_error("libsodium cannot be initialised");
  std::array<unsigned char, 32> digest;
  crypto_generichash(digest.data(), digest.size(), reinterpret_cast<const unsigned char*>(bytes.data()),
                     bytes.size(), nullptr, 0);
  std::array<char, 2 * digest.size() + 1> hex;
  return sodium_bin2hex(hex.data(), hex.size(), digest.data(), digest.size());
}

}  // namespace boxgrasp
