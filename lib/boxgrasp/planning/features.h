// What a network is fed: the quality measures, each as the model's list of features says.
#pragma once

#include <string>
#include <vector>

#include "boxgrasp/planning/plan.h"

namespace boxgrasp {

// A feature is "q1" ... "q9", as measured, or a measure without its unit: "q4/L" and "q1/L2" are divided by
// the object's size L or its square. The paper feeds raw measures; relative ones rank objects of sizes that
// the network has never seen.
std::vector<std::string> rawFeatures();
std::vector<std::string> relativeFeatures();

// L: half the diagonal of the object's root box, metres.
double objectSize(const PlannedObject& object);

// The inputs of a network with these features. Throws InputError that names the feature which is not one of
// the above.
VectorXd networkInputs(const std::vector<std::string>& features, const QualityMeasures& quality,
                       double size_m);

}  // namespace boxgrasp
