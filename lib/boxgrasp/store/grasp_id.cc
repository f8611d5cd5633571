#include "boxgrasp/store/grasp_id.h"

#include <fmt/format.h>

#include <cmath>

#include "boxgrasp/base/error.h"
#include "boxgrasp/store/number_text.h"

namespace boxgrasp {
namespace {

std::string scaleText(double scale) {
  const std::string rounded = fmt::format("{:.2f}", scale);
  return parseNumber<double>(rounded) == scale ? rounded : fmt::format("{}", scale);
}

// Takes what follows the last separator off the text; the whole text where there is none.
std::string_view takeLast(std::string_view& text, char separator) {
  const std::size_t at = text.rfind(separator);
  const std::string_view last = at == text.npos ? text : text.substr(at + 1);
  text = at == text.npos ? std::string_view() : text.substr(0, at);
  return last;
}

std::optional<ModelKey> modelKeyOf(std::string_view text) {
  const std::string_view view = takeLast(text, '/');
  const auto scale = parseNumber<double>(takeLast(text, '@'));
  if (view.empty() || !scale || !std::isfinite(*scale) || *scale <= 0 || text.empty()) return std::nullopt;
  return ModelKey{std::string(text), *scale, std::string(view)};
}

std::optional<GraspId> graspIdOf(std::string_view text) {
  const auto index = parseNumber<int>(takeLast(text, '/'));
  const auto source = parseGraspSource(takeLast(text, '/'));
  const auto model = modelKeyOf(text);
  if (!index || *index < 0 || !source || !model) return std::nullopt;
  return GraspId{*model, *source, *index};
}

}  // namespace

std::string formatModelKey(const ModelKey& key) {
  return fmt::format("{}@{}/{}", key.object, scaleText(key.scale), key.view);
}

std::string formatGraspId(const GraspId& id) {
  return fmt::format("{}/{}/{}", formatModelKey(id.model), describe(id.source), id.index);
}

GraspId parseGraspId(std::string_view text) {
  if (const auto id = graspIdOf(text)) return *id;
  throw InputError(
      fmt::format("'{}' names no grasp; a name is <object>@<scale>/<view>/<source>/<index> with the source "
                  "planner, random or approach, such as mug@1.00/whole/planner/17",
                  text));
}

ModelKey parseModelKey(std::string_view text) {
  if (const auto key = modelKeyOf(text)) return *key;
  throw InputError(
      fmt::format("'{}' names no model; a name is <object>@<scale>/<view>, such as mug@1.00/whole", text));
}

std::optional<GraspSource> parseGraspSource(std::string_view name) {
  for (const GraspSource source : {GraspSource::planner, GraspSource::random, GraspSource::approach}) {
    if (describe(source) == name) return source;
  }
  return std::nullopt;
}

}  // namespace boxgrasp
