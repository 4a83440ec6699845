#include "scenarios/reader/faults/event_file.h"

#include "scenarios/reader/events/command_text.h"
#include "scenarios/reader/events/event_tables.h"
#include "scenarios/reader/faults/fault_tables.h"

#include <fmt/format.h>

namespace puckloop::scenarios {

void apply_event_file(const std::filesystem::path& file, Scenario& scenario) {
    scenario.events.events = read_event_file(file);
    std::size_t index = 0;
    for (const TomlValue& table : fault_tables_of(file))
        scenario.faults.push_back(read_fault(file.string(), index++, table, scenario));
}

std::vector<TomlValue> fault_tables_of(const std::filesystem::path& file) {
    const TomlValue root = read_toml(file);
    Reader top(file.string(), "", root);
    std::vector<TomlValue> tables;
    for (const TomlValue* table : top.tables("fault"))
        tables.push_back(*table);
    return tables;
}

std::string fault_toml(const TomlValue& table) {
    std::string text = "\n[[fault]]\n";
    for (const auto& [key, value] : std::get<TomlTable>(table.data))
        text += fmt::format("{} = {}\n", key, toml_value(value));
    return text;
}

}  // namespace puckloop::scenarios
