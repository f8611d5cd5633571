// What was learnt, as one HTML page that fetches nothing.
#pragma once

#include "boxgrasp/ranking/model_file.h"
#include "study.h"
#include "sweep.h"

namespace boxgrasp {

struct ReportedStudy {
  const StudyCommand& command;
  const StudyData& data;
  const StudyResult& result;
  const Learnt& learnt;
  const Model& model;
  const std::vector<SweepPoint>& sweep;  // empty: none
};

// Throws InputError when the file cannot be written; Stopped.
void writeReport(const ReportedStudy& study, const std::filesystem::path& file, const StopToken& stop);

}  // namespace boxgrasp
