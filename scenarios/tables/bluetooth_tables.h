#pragma once
// Bluetooth: [robot.pic.bluetooth] and [bluetooth].

#include "scenarios/description/scenario.h"
#include "scenarios/values/reader.h"

#include <string>

namespace puckloop::scenarios {

/// The module of one robot; `index` counts robots from 0 and gives the values that are not in the table.
BluetoothModule read_bluetooth_module(const std::string& file, const std::string& where,
                                      const TomlValue& table, std::size_t index);

/// [bluetooth], and what the modules of all robots have to be together.
void read_bluetooth(Reader& top, Scenario& scenario);

}  // namespace puckloop::scenarios
