#pragma once
// What a program leaves to the one that exec() puts in its place, or to one that it spawns: descriptors of
// devices and pipes, alarms. The host keeps the descriptors themselves; the node keeps this text meanwhile.

#include <string>

namespace puckloop::shim {

/// For a successor in this process, or (without alarms) for a new process.
std::string leave(bool same_process);
/// In the successor.
void take_over(const std::string& left);

}  // namespace puckloop::shim
