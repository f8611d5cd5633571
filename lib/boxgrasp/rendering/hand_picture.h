// Drawings of a hand by itself: what its description file says, to be looked at.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

#include "boxgrasp/hand/kinematics.h"

namespace boxgrasp {

struct HandPictureOptions {
  int panel_px = 360;  // side of one panel
  void validate() const;
};

// The hand open, half closed and closed, from its side and from before its palm, with the axes of the palm's
// frame P (x red, y green, z blue) and a scale of 50 mm.
cv::Mat3b drawHand(const HandDescription& hand, const HandPictureOptions& options = {});
std::string handSvg(const HandDescription& hand, const HandPictureOptions& options = {});

// PNG or SVG by the file's ending. Throws InputError for another ending, or when it cannot be written.
void writeHandPicture(const HandDescription& hand, const std::filesystem::path& file,
                      const HandPictureOptions& options = {});

}  // namespace boxgrasp
