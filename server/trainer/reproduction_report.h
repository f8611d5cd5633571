// The report of a reproduction: a function of what its steps printed, and nothing else.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace boxgrasp {

struct ReportedStep {
  std::string name;
  std::string kind;  // "summary", "stability", "constellations", "evaluate", "spread", "grasps", "rates",
                     // "ablation", "scene", "label"
  std::string subject, command;
  std::string build;  // of the program that ran it
  double time_s = 0.0;
  std::string error;      // empty: it ended well
  nlohmann::json output;  // what it printed
};

struct ReproducedStudy {
  std::string program, build;  // version, and build of the program that writes the report
  bool quick = false;
  std::vector<ReportedStep> steps;
  std::map<std::string, std::string> pictures;  // by the step's name: PNG, or SVG text
};

// One page of HTML that needs no other file. A cell that shows one number of a step says where it stands:
// data-from="<step>#<JSON pointer>". Missing and failed steps leave a note in their section.
std::string reproductionReport(const ReproducedStudy& study);

// The range that a share is in with 95 % confidence, when `held` of `of` trials were held (Wilson's score).
struct ShareRange {
  double low = 0.0, high = 1.0;
};
ShareRange wilson(std::size_t held, std::size_t of);

}  // namespace boxgrasp
