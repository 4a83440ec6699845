#pragma once
// The picture of an experiment: one row per TAM with a bar for each state, coloured by what the TAM was to a
// robot, and below it when a robot was inside. SVG, drawn from the event table.

#include "linuxboard/coordinator/event_log.h"

#include <string>
#include <vector>

namespace puckloop::coordinator {

/// The whole file. It ends with the last event.
std::string gantt_svg(const std::vector<Event>& events, const std::string& title);

}  // namespace puckloop::coordinator
