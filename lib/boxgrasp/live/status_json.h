// Messages about the server as JSON.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "boxgrasp/model_info_t.hpp"
#include "boxgrasp/status_t.hpp"
#include "boxgrasp/training_status_t.hpp"

namespace boxgrasp {

nlohmann::ordered_json statusJson(const status_t& status);
std::map<std::string, double> metricsOf(const model_info_t& model);
nlohmann::ordered_json modelJson(const model_info_t& model);
nlohmann::ordered_json trainingJson(const training_status_t& training);

}  // namespace boxgrasp
