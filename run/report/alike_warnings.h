#pragma once
// Twenty robots with one program have one thing to warn of.

#include <string>
#include <vector>

namespace puckloop::tools {

/// Warnings of the form "NODE: text" of nodes of one kind (what their names have after the last point) whose
/// texts are the same but for whole numbers become one line, where the first of them was:
/// "robot0.linux and 19 more: 4 of 1478 to 2396 I2C transfers failed".
std::vector<std::string> alike_as_one(const std::vector<std::string>& warnings);

}  // namespace puckloop::tools
