// Networks that have not seen an object, to rank its grasps as those of something new.
#pragma once

#include <map>

#include "boxgrasp/ranking/model_file.h"
#include "study.h"

namespace boxgrasp {

class LeftOut {
 public:
  // Reads the labels once. Throws InputError.
  LeftOut(const StudyCommand& command, const StopToken& stop);

  // A model learnt from all objects but this one; from all, where it is none of them. Each is learnt once.
  // It remembers them where that was asked for. Throws InputError when fewer than two objects are left (three
  // with recollections), Stopped.
  const Model& modelWithout(const std::string& object, const StopToken& stop);

 private:
  std::vector<Recollection> recollectionsOf(const GroupedSamples& rest, const std::string& object,
                                            const StopToken& stop) const;

  StudyCommand command_;
  StudyData data_;
  std::map<std::string, Model> models_;
};

}  // namespace boxgrasp
