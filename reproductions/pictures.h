#pragma once
// The experiments with sound as pictures (SVG) and tables (CSV).

#include "reproductions/experiments.h"

#include <string>

namespace puckloop::tools {

/// `caption`: what was measured, one line.
std::string distance_picture(const Readings& readings, const std::string& caption);
std::string calls_picture(const Readings& readings, const std::string& caption);
/// `failed`: places whose message did not get through, marked.
std::string ears_picture(const Ears& ears, const std::string& caption, const std::vector<Heard>& failed = {});

/// "trial,<at>,right,left,rear", one line per answer; `at` names the second column.
std::string readings_csv(const Readings& readings, const std::string& at);
/// "t_s,x_m,y_m", a line each time it heard.
std::string heard_csv(const Ears& ears);

}  // namespace puckloop::tools
