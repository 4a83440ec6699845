#pragma once
// JSON Schemas (2020-12) of what users write and programs read. The first line `#:schema FILE` of a TOML file
// makes editors complete and check it (Taplo, Even Better TOML).

#include "base/json.h"

namespace puckloop::tools {

/// A scenario: tables and keys of scenarios/reader.
nlohmann::ordered_json scenario_schema();
/// A [[fault]] table.
nlohmann::ordered_json fault_schema();
/// A campaign of faults: campaigns/engine/campaign_file.h.
nlohmann::ordered_json campaign_schema();
/// report.json of a run.
nlohmann::ordered_json report_schema();

}  // namespace puckloop::tools
