// The page's parts, as text in the program.
#pragma once

namespace boxgrasp {

extern const char* const kViewerHtml;  // web/viewer.html
extern const char* const kViewerCss;   // web/viewer.css
extern const char* const kViewerJs;    // web/viewer.js
extern const char* const kThreeJs;     // three.js, of the Debian package libjs-three
extern const char* const kOrbitJs;     // its OrbitControls

}  // namespace boxgrasp
