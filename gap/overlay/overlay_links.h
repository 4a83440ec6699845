#pragma once
// The part of an overlay that acts on links, clocks and Linux boards: [uart], [linux] and [clock].

#include <map>
#include <string>

namespace puckloop::gap {

/// Takes those parameters out of `fitted` that a run has there, told as TOML tables; `nominal` is what the
/// experiment says of its robot. What would make a frame faster than the simulator's stays.
std::string links_overlay(const std::map<std::string, double>& nominal,
                          std::map<std::string, double>& fitted);

}  // namespace puckloop::gap
