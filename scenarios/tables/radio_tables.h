#pragma once
// Radio modules and the air between them: [radio], [tam.xbee], [coordinator].

#include "scenarios/description/scenario.h"
#include "scenarios/values/reader.h"

#include <string>

namespace puckloop::scenarios {

/// [tam.xbee] of one TAM; `table` may be null: a module with the values that TAMs are delivered with. `index`
/// counts the TAMs from 0.
XBeeModule read_tam_module(const std::string& file, const std::string& tam, const TomlValue* table,
                           std::size_t index, int network);

/// [radio].
RadioMedium read_radio(Reader& top);

/// [coordinator], if there is one.
std::optional<CoordinatorPlace> read_coordinator(Reader& top);

}  // namespace puckloop::scenarios
