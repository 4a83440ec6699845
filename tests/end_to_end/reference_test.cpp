// docs/reference: pages that list what the code has in its tables. They are made by this test
// (PUCKLOOP_WRITE_REFERENCE=1) and held to it.

#include "base/json.h"
#include "cosim/faults/kinds/kind_table.h"
#include "emu/pic/signals.h"
#include "emu/rab_board/signals.h"
#include "emu/tam_avr/signals.h"
#include "physics/description/parameters.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

using namespace puckloop;
using namespace puckloop::tests;
using Json = nlohmann::ordered_json;

namespace {

constexpr std::size_t kColumns = 100;

/// Lines of at most kColumns, `indent` spaces before all but the first.
std::string wrapped(const std::string& text, std::size_t indent) {
    std::istringstream words(text);
    std::string all, line;
    for (std::string word; words >> word;) {
        if (!line.empty() && line.size() + 1 + word.size() > kColumns) {
            all += line + "\n";
            line = std::string(indent, ' ') + word;
        } else {
            line += (line.empty() ? "" : " ") + word;
        }
    }
    return all + line + "\n";
}

std::string title_and_text(const std::string& title, const std::string& text) {
    return "# " + title + "\n" + wrapped(text, 0);
}

std::string number(double value) {
    return fmt::format("{:g}", value);
}

/// "(s|ms|us)" at the end of a quantity's pattern: "s, ms, us".
std::string units_of(const std::string& pattern) {
    const std::size_t open = pattern.rfind('('), close = pattern.rfind(')');
    if (open == std::string::npos || close < open) return "";
    std::string units;
    std::istringstream in(pattern.substr(open + 1, close - open - 1));
    for (std::string unit; std::getline(in, unit, '|');)
        if (!unit.empty()) units += (units.empty() ? "" : ", ") + unit;
    return units;
}

/// What a value may be, in words.
std::string form_of(const Json& schema) {
    if (schema.contains("enum")) {
        std::string all;
        for (const Json& one : schema["enum"])
            all += (all.empty() ? "" : ", ") + one.dump();
        return "one of " + all;
    }
    if (schema.contains("anyOf")) {
        std::set<std::string> seen;
        std::string all;
        for (const Json& one : schema["anyOf"]) {
            const std::string form = form_of(one);
            if (form.empty() || !seen.insert(form).second) continue;
            all += (all.empty() ? "" : " or ") + form;
        }
        return all;
    }
    const std::string type = schema.value("type", "");
    if (type == "string") {
        const std::string pattern = schema.value("pattern", "");
        if (pattern.empty()) return "text";
        if (pattern.find("[0-9]") == std::string::npos) return "";  // ${NAME}, of any key
        const std::string units = units_of(pattern);
        return units.empty() ? "" : "quantity in " + units;
    }
    if (type == "array") {
        const std::string of = schema.contains("items") ? form_of(schema["items"]) : "";
        const std::string count =
            schema.contains("minItems") ? std::to_string(schema["minItems"].get<int>()) + " " : "";
        return "list of " + count + (of.empty() ? "values" : of);
    }
    if (type == "integer") return "whole number";
    if (type == "boolean") return "true or false";
    return type;
}

void list_keys(std::string& page, const std::string& path, const Json& table, bool several) {
    page += fmt::format("\n## {}\n", several ? "[[" + path + "]]" : "[" + path + "]");
    if (const std::string text = table.value("description", ""); !text.empty()) page += wrapped(text, 0);
    page += "\n";
    std::set<std::string> required;
    for (const Json& key : table.value("required", Json::array()))
        required.insert(key);
    std::vector<std::pair<std::string, Json>> tables;
    const Json properties = table.value("properties", Json::object());
    for (const auto& item : properties.items()) {
        const Json& value = item.value();
        if (value.value("type", "") == "object" ||
            (value.value("type", "") == "array" && value.contains("items") &&
             value["items"].value("type", "") == "object")) {
            tables.emplace_back(item.key(), value);
            continue;
        }
        const std::string text = value.value("description", "");
        std::string form = form_of(value);
        if (required.contains(item.key())) form += form.empty() ? "required" : ", required";
        page += wrapped("* `" + item.key() + "`" + (form.empty() ? "" : " (" + form + ")") +
                            (text.empty() ? "" : ": " + text),
                        2);
    }
    if (properties.empty()) page += "Names of the user's own.\n";
    for (const auto& [name, value] : tables)
        list_keys(page, path + "." + name, value.value("type", "") == "array" ? value["items"] : value,
                  value.value("type", "") == "array");
}

std::string keys_page(const Workbench& bench) {
    const Ended schema = bench.puckloop({"schema", "scenario"});
    REQUIRE(schema.status == 0);
    std::string page = title_and_text(
        "Scenario keys", "All tables and keys, as the reader has them. [scenario.md](../scenario.md) "
                         "explains them; this list is that of `puckloop schema scenario`, which editors "
                         "complete and check by. A key may hold `\"${NAME}\"`, a variable of `[variables]`.");
    const Json json = Json::parse(schema.out);
    const Json properties = json["properties"];
    std::string top;
    for (const auto& item : properties.items()) {
        const Json& value = item.value();
        const bool several = value.value("type", "") == "array" && value.contains("items") &&
                             value["items"].value("type", "") == "object";
        if (several || value.value("type", "") == "object")
            list_keys(page, item.key(), several ? value["items"] : value, several);
        else
            top += wrapped(
                fmt::format("* `{}` ({}): {}", item.key(), form_of(value), value.value("description", "")),
                2);
    }
    if (!top.empty()) page += "\n## Before all tables\n\n" + top;
    return page;
}

std::string parameters_page() {
    std::string page =
        title_and_text("Physical parameters",
                       "Every number of the world's model: `[parameters]` and `[robot.parameters]` of a "
                       "scenario, `--set` of `run`, overlays of `gap`. Each line: unit, default, range, "
                       "source: [W] Webots' model of the e-puck, [A] ARGoS' plugin, [L] GCtronic's library, "
                       "[E] Enki, [M] measured on real robots (public logs), [S] published descriptions, [O] "
                       "practice with ODE, [R] firmware and documents of the range-and-bearing board, [I] "
                       "IRIDIA's published statistics of that board, \"?\" plausible, without a source.") +
        "\n";
    for (const physics::ParameterInfo& one : physics::parameter_table()) {
        std::vector<std::string> defaults;
        for (const double value : one.defaults)
            defaults.push_back(number(value));
        page += wrapped(
            fmt::format("* `{}`{} ({}): {}; {} to {}{}. {}", one.name,
                        one.count > 1 ? fmt::format(", `{0}0` to `{0}{1}`", one.name, one.count - 1) : "",
                        one.unit, fmt::join(defaults, ", "), number(one.min), number(one.max),
                        one.of_robot() ? "" : "; of the world alone", one.source),
            2);
    }
    return page;
}

void list_signals(std::string& page, const std::string& board, std::span<const cosim::SignalInfo> signals) {
    page += "\n## " + board + "\n\n";
    for (const cosim::SignalInfo& one : signals)
        page += wrapped(fmt::format("* `{}` ({}, {}, {} to {}): {}", one.name,
                                    one.direction == cosim::SignalDirection::Input ? "input" : "output",
                                    one.unit.empty() ? "no unit" : one.unit, number(one.min), number(one.max),
                                    one.description),
                        2);
}

std::string signals_page() {
    std::string page = title_and_text(
        "Signals", "What a board feels and does, by name: `--stimulus` and `--watch` of `exec`, `get()` and "
                   "`set()` of the Python client, columns of recorded runs. Inputs are set by the world or a "
                   "stimulus, outputs are driven by the firmware.");
    list_signals(page, "Main board", pic::signals());
    list_signals(page, "Range-and-bearing board", rab::signals());
    list_signals(page, "TAM", tam::signals());
    return page;
}

std::string unit_words(cosim::Unit unit) {
    switch (unit) {
    case cosim::Unit::Time:
        return "s";
    case cosim::Unit::Ratio:
        return "share";
    case cosim::Unit::Number:
        return "number";
    case cosim::Unit::Integer:
        return "whole number";
    case cosim::Unit::Voltage:
        return "V";
    case cosim::Unit::Frequency:
        return "Hz";
    case cosim::Unit::Degrees:
        return "degrees";
    case cosim::Unit::Flag:
        return "true or false";
    case cosim::Unit::Byte:
        return "byte";
    case cosim::Unit::Text:
        return "text";
    }
    return "";
}

std::string parameter_words(const cosim::ParameterInfo& one) {
    std::string text = "`" + std::string(one.key) + "` (" + unit_words(one.unit);
    const bool bounded =
        one.unit != cosim::Unit::Flag && one.unit != cosim::Unit::Byte && one.unit != cosim::Unit::Text;
    if (bounded) text += fmt::format(", {} to {}", number(one.low), number(one.high));
    if (!one.choices.empty()) {
        std::string choices(one.choices);
        for (std::size_t at = 0; (at = choices.find('|', at)) != std::string::npos; at += 2)
            choices.replace(at, 1, ", ");
        text += ": " + choices;
    }
    if (one.fallback && one.unit == cosim::Unit::Flag)
        text += *one.fallback != 0.0 ? ", default true" : ", default false";
    else if (one.fallback)
        text += ", default " + number(*one.fallback);
    if (one.required) text += ", required";
    return text + ")";
}

std::string faults_page() {
    const std::map<cosim::PlaceKind, std::string> places = {
        {cosim::PlaceKind::Uart, "A serial line"},
        {cosim::PlaceKind::Radio, "A radio module's way to the air"},
        {cosim::PlaceKind::I2c, "An I2C bus"},
        {cosim::PlaceKind::InfraRed, "Light of range-and-bearing boards"},
        {cosim::PlaceKind::Pic, "A main board"},
        {cosim::PlaceKind::Rab, "A range-and-bearing board"},
        {cosim::PlaceKind::Tam, "A TAM"},
        {cosim::PlaceKind::Linux, "A Linux board"},
        {cosim::PlaceKind::Xbee, "The air between radio modules"},
        {cosim::PlaceKind::Ircom, "Light of IRcom"},
        {cosim::PlaceKind::Can, "A CAN bus"},
        {cosim::PlaceKind::Network, "The network"}};
    std::map<cosim::PlaceKind, std::string> lists;
    for (const cosim::KindInfo& kind : cosim::all_kinds()) {
        std::string text = "* `" + std::string(kind.name) + "`";
        if (!kind.alias.empty()) text += ", also `" + std::string(kind.alias) + "`";
        text += kind.style == cosim::Style::Each   ? " (one by one)"
                : kind.style == cosim::Style::Hold ? " (while it lasts)"
                                                   : " (at instants)";
        std::vector<std::string> parameters;
        for (const cosim::ParameterInfo& one : kind.parameters)
            parameters.push_back(parameter_words(one));
        if (!parameters.empty()) text += fmt::format(": {}", fmt::join(parameters, "; "));
        lists[kind.place] += wrapped(text, 2);
    }
    std::string page = title_and_text(
        "Kinds of faults", "What can happen to each place of a run, with the parameters of each kind. What "
                           "they do, and the keys that say when, is in [scenario.md](../scenario.md#fault).");
    for (const auto& [place, title] : places) {
        REQUIRE(lists.contains(place));
        page += "\n## " + title + "\n\n" + lists.at(place);
    }
    return page;
}

/// Commands as `puckloop help` lists them.
std::vector<std::string> commands_of(const std::string& overview) {
    std::vector<std::string> found;
    std::istringstream in(overview);
    bool options = true;
    for (std::string line; std::getline(in, line);) {
        if (!line.empty() && line.back() == ':') options = line == "Options:";
        if (options || line.size() < 3 || line[0] != ' ' || line[1] != ' ' || line[2] == ' ' ||
            line[2] == '-')
            continue;
        found.push_back(line.substr(2, line.find(' ', 2) - 2));
    }
    return found;
}

std::string commands_page(const Workbench& bench) {
    std::string page =
        "# Commands\nEvery command with its options, as `puckloop help COMMAND` prints them.\n";
    const Ended overview = bench.puckloop({"help"});
    REQUIRE(overview.status == 0);
    page += "\n```\n" + overview.out + "```\n";
    const std::vector<std::string> commands = commands_of(overview.out);
    CHECK(commands.size() > 20);
    for (const std::string& command : commands) {
        if (command == "test" || command == "help" || command == "gap") continue;  // of other programs
        const Ended help = bench.puckloop({"help", command});
        INFO(command);
        REQUIRE(help.status == 0);
        page += "\n## " + command + "\n```\n" + help.out + "```\n";
    }
    return page;
}

void hold(const std::string& name, const std::string& page) {
    const std::string path = std::string(PUCKLOOP_SOURCE) + "/docs/reference/" + name;
    if (std::getenv("PUCKLOOP_WRITE_REFERENCE") != nullptr) {
        std::ofstream(path) << page;
        return;
    }
    std::ifstream in(path);
    std::stringstream text;
    text << in.rdbuf();
    INFO(path << " is old: run this test with PUCKLOOP_WRITE_REFERENCE=1");
    CHECK(text.str() == page);
}

}  // namespace

TEST_CASE("docs/reference lists what the code has") {
    const Workbench bench;
    hold("keys.md", keys_page(bench));
    hold("parameters.md", parameters_page());
    hold("signals.md", signals_page());
    hold("faults.md", faults_page());
    hold("commands.md", commands_page(bench));
}
