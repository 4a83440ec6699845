#pragma once

namespace puckloop::tools {

/// Prints the table of physical parameters: name, default, unit, range, source.
void print_parameters();

}  // namespace puckloop::tools
