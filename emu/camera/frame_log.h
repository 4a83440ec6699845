#pragma once
// What a camera took, for reports and as a file.

#include "cosim/core/clock.h"
#include "emu/camera/camera.h"

#include <string>

namespace puckloop::camera {

/// {"model": "po3030k", "pictures": 2, "last": {"time_s": ..., "format": "rgb565", ...}}
std::string report_json(const Camera& camera);

/// A line per frame of which the program read anything:
/// `time_s,frame,format,step,column,row,hash`; time of its first byte, frame since the timing was last set,
/// step of the subsampling, column and row of the array where HREF begins, FNV-1a of the picture. Beside it,
/// with the ending .ppm, what was seen in the last one. Throws RunError if a file cannot be written.
void write_frame_log(const std::string& file, const Camera& camera, const cosim::ClockDomain& clock);

}  // namespace puckloop::camera
