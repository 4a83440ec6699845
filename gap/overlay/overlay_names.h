#pragma once
// Which of the forward models' parameters an overlay hands on to a run (gap/overlay/overlay.cpp does it).

#include <string_view>

namespace puckloop::gap {

/// True: it stands under [parameters], [uart], [linux] or [clock]. False: under [measurement], which a run
/// passes over.
bool overlay_takes(std::string_view parameter);

}  // namespace puckloop::gap
