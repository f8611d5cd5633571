// A study's results as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "study.h"
#include "sweep.h"

namespace boxgrasp {

nlohmann::json studyJson(const StudyData& data, const StudyResult& result);
nlohmann::json sweepJson(const std::vector<SweepPoint>& points);

}  // namespace boxgrasp
