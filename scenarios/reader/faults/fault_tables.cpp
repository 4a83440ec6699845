#include "scenarios/reader/faults/fault_tables.h"

#include "base/error.h"
#include "base/text/suggest.h"
#include "cosim/faults/spec/flash.h"
#include "cosim/i2c/i2c_fault.h"
#include "scenarios/reader/faults/fault_places.h"
#include "scenarios/reader/faults/fault_when.h"
#include "scenarios/reader/faults/fault_words.h"
#include "scenarios/values/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <numbers>
#include <vector>

namespace puckloop::scenarios {

using cosim::FaultSpec;
using cosim::KindInfo;
using cosim::ParameterInfo;
using cosim::Unit;

namespace {

constexpr std::string_view kCommandLine = "--fault";

std::string range_of(const ParameterInfo& parameter) {
    if (parameter.unit == Unit::Integer)
        return fmt::format("{} to {}", static_cast<std::int64_t>(parameter.low),
                           static_cast<std::int64_t>(parameter.high));
    return fmt::format("{:g} to {:g}{}", parameter.low, parameter.high,
                       parameter.unit == Unit::Time ? " s" : "");
}

/// "0x1A2B", as on the command line; what is none is refused.
double read_address(Reader& reader, const ParameterInfo& parameter) {
    const std::string text = reader.text(parameter.key);
    std::uint64_t value = 0;
    const char* const last = text.data() + text.size();
    const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
    if (!hexadecimal || std::from_chars(text.data() + 2, last, value, 16).ptr != last || text.size() < 3)
        reader.fail(parameter.key, fmt::format("'{}' is no whole number", text), range_of(parameter));
    return static_cast<double>(value);
}

double read_number(Reader& reader, const ParameterInfo& parameter) {
    switch (parameter.unit) {
    case Unit::Time:
        return reader.quantity(parameter.key, Dimension::Time);
    case Unit::Ratio:
        return reader.quantity(parameter.key, Dimension::Ratio);
    case Unit::Voltage:
        return reader.quantity(parameter.key, Dimension::Voltage);
    case Unit::Frequency:
        return reader.quantity(parameter.key, Dimension::Frequency);
    case Unit::Integer:
        if (!reader.has(parameter.key))
            reader.fail(parameter.key, fmt::format("'{}' is missing", parameter.key), range_of(parameter));
        if (reader.is_text(parameter.key)) return read_address(reader, parameter);
        return static_cast<double>(reader.integer(parameter.key, 0, static_cast<std::int64_t>(parameter.low),
                                                  static_cast<std::int64_t>(parameter.high)));
    case Unit::Degrees:
        if (!reader.is_text(parameter.key)) return reader.quantity(parameter.key, Dimension::Number);
        return reader.quantity(parameter.key, Dimension::Angle) * 180.0 / std::numbers::pi;
    case Unit::Flag:
        return reader.flag(parameter.key, false) ? 1.0 : 0.0;
    default:
        return reader.quantity(parameter.key, Dimension::Number);
    }
}

/// "0x41", "65" or 65.
double read_byte(Reader& reader, const ParameterInfo& parameter) {
    return reader.is_text(parameter.key) ? byte_of(reader, parameter.key, reader.text(parameter.key))
                                         : static_cast<double>(reader.integer(parameter.key, 0, 0, 255));
}

void read_parameter(Reader& reader, const ParameterInfo& parameter, FaultSpec& fault) {
    // A byte that is missing is check_fault()'s to refuse.
    const bool optional = !parameter.required || parameter.unit == Unit::Byte;
    if (!reader.has(parameter.key) && optional) return;
    if (parameter.unit == Unit::Text) {
        std::string text = reader.text(parameter.key);
        std::vector<std::string> choices;
        for (std::size_t from = 0; !parameter.choices.empty() && from <= parameter.choices.size();) {
            const std::size_t bar = std::min(parameter.choices.find('|', from), parameter.choices.size());
            choices.emplace_back(parameter.choices.substr(from, bar - from));
            from = bar + 1;
        }
        if (!choices.empty()) text = reader.choice(parameter.key, choices.front(), choices);
        fault.set(parameter.key, text);
        return;
    }
    const double value =
        parameter.unit == Unit::Byte ? read_byte(reader, parameter) : read_number(reader, parameter);
    const bool ranged = parameter.unit != Unit::Byte && parameter.unit != Unit::Flag;
    if (ranged && !(value >= parameter.low && value <= parameter.high))
        reader.fail(parameter.key, fmt::format("{} is out of range", parameter.key), range_of(parameter));
    fault.set(parameter.key, value);
}

/// Links or nodes that can have a fault.
std::string names_of(const Scenario& scenario, bool nodes) {
    std::string names;
    for (const FaultPlace& place : fault_places(scenario))
        if (place.is_node == nodes) names += (names.empty() ? "" : ", ") + place.name;
    return names.empty() ? "none" : names;
}

/// Of link or node; what is not there is refused with what is.
FaultPlace find_place(Reader& reader, const Scenario& scenario) {
    // Asked for here, they are no misspelt 'link'.
    for (const char* key : {"kind", "name", "from", "at", "begin", "end"})
        reader.has(key);
    const bool by_node = reader.has("node");
    if (by_node && reader.has("link")) reader.fail("node", "both a link and a node are given", "one of them");
    if (!by_node && !reader.has("link"))
        reader.fail_missing("link", fmt::format("one of {}; or a node, one of {}", names_of(scenario, false),
                                                names_of(scenario, true)));
    const char* const key = by_node ? "node" : "link";
    const std::string name = reader.text(key);
    const std::vector<FaultPlace> places = fault_places(scenario);
    std::vector<std::string_view> known;
    for (const FaultPlace& place : places) {
        if (place.is_node == by_node && place.name == name) return place;
        if (place.is_node == by_node) known.push_back(place.name);
    }
    reader.fail(key, fmt::format("there is no {} '{}' that can have a fault", key, name),
                names_of(scenario, by_node) + did_you_mean(name, known));
}

void check_end(Reader& reader, const char* key, const std::string& name, const FaultPlace& place) {
    if (std::find(place.ends.begin(), place.ends.end(), name) == place.ends.end())
        reader.fail(key, fmt::format("'{}' is at no end of {}", name, place.name),
                    fmt::format("{}", fmt::join(place.ends, " or ")));
}

void read_from(Reader& reader, const FaultPlace& place, const KindInfo& kind, FaultSpec& fault) {
    if (place.ends.empty() || !reader.has("from")) return;
    fault.from = reader.text("from", "");
    if (fault.from.empty()) return;
    if (kind.mark == cosim::FaultKind::SwappedWires)
        reader.fail("from", "swapped wires have no direction", "no 'from'");
    if (kind.place == cosim::PlaceKind::Xbee && kind.name == "clash")
        reader.fail("from", "a clash comes from outside, from no module", "no 'from'");
    check_end(reader, "from", fault.from, place);
}

/// Of a medium: who receives.
void check_receiver(Reader& reader, const FaultPlace& place, const FaultSpec& fault) {
    const std::string to = fault.parameters.text("to");
    if (to.empty() || place.ends.empty()) return;
    check_end(reader, "to", to, place);
    if (to == fault.from)
        reader.fail("to", fmt::format("'{}' receives nothing of its own", to), "another one");
}

/// What a fault of the network needs there.
void check_network(Reader& reader, const KindInfo& kind, const FaultSpec& fault, const Scenario& scenario) {
    if (kind.name == "dns_silence" && !scenario.network)
        reader.fail("kind", "no names are asked for without a network", "[network]");
    if (kind.name != "access_point_away") return;
    if (!scenario.network->access_point)
        reader.fail("kind", "the network has no access point that could be away",
                    "access_point in [network], with mode = \"wifi\"");
    if (!fault.from.empty())
        reader.fail("from", "an access point is away for all", "no 'from'; or loss from one computer");
}

const KindInfo& find_kind(Reader& reader, const FaultPlace& place) {
    const std::string name = reader.text("kind", "drop");
    if (const KindInfo* kind = cosim::find_kind(name, place.kind)) return *kind;
    std::vector<std::string_view> known;
    for (const KindInfo& kind : cosim::all_kinds())
        if (kind.place == place.kind) known.push_back(kind.name);
    reader.fail("kind", fmt::format("unknown fault kind '{}' for {}", name, place.name),
                "one of " + cosim::kinds_of(place.kind) + did_you_mean(name, known));
}

/// Of a fault that flashes an image: beside the file that the fault is in, on the command line in the present
/// folder. A client's events.toml and the copies in `flashed` may be elsewhere by now, together.
std::string found_image(const Reader& reader, const std::string& named) {
    namespace fs = std::filesystem;
    const bool in_file = !reader.file().starts_with(kCommandLine);
    std::error_code none;
    const fs::path folder = in_file ? fs::absolute(reader.folder(), none) : fs::current_path(none);
    const fs::path file = (folder / named).lexically_normal(),
                   copy = folder / cosim::kFlashedFolder / file.filename();
    return in_file && !fs::exists(file, none) && fs::exists(copy, none) ? copy : file;
}

FaultSpec read_fault(Reader& reader, const Scenario& scenario) {
    const FaultPlace place = find_place(reader, scenario);
    const KindInfo& kind = find_kind(reader, place);
    FaultSpec fault;
    (place.is_node ? fault.node : fault.link) = place.name;
    if (!place.carrier.empty()) fault.node = place.carrier;
    fault.kind = kind.name;
    read_from(reader, place, kind, fault);
    read_when(reader, kind, fault);
    read_match(reader, kind, fault);
    for (const ParameterInfo& parameter : kind.parameters)
        read_parameter(reader, parameter, fault);
    if (const std::string image = fault.parameters.text("image");
        kind.name == cosim::kFlashKind && !image.empty())
        fault.set("image", found_image(reader, image));
    check_receiver(reader, place, fault);
    check_network(reader, kind, fault, scenario);
    fault.name = reader.text("name", "");
    if (fault.name.find_first_of(",\n\"") != std::string::npos)
        reader.fail("name", "a name holds a comma, a quote or a line's end", "a plain name");
    fault.may_not_fire = reader.flag("may_not_fire", false);
    reader.finish();
    cosim::complete(fault, kind);
    try {
        cosim::check_fault(fault, kind);
        if (place.kind == cosim::PlaceKind::I2c) cosim::read_i2c_fault(fault);
    } catch (const InputError& error) {
        reader.fail("kind", error.what());
    }
    return fault;
}

}  // namespace

FaultSpec read_fault(const std::string& file, std::size_t index, const TomlValue& table,
                     const Scenario& scenario) {
    Reader reader(file, fmt::format("fault {}", index + 1), table);
    FaultSpec fault = read_fault(reader, scenario);
    for (const FaultSpec& other : scenario.faults)
        if (!fault.name.empty() && other.name == fault.name)
            reader.fail("name", fmt::format("two faults have the name '{}'", fault.name),
                        "a name for each, or none");
    return fault;
}

void add_fault(std::string_view words, Scenario& scenario) {
    const TomlValue table = fault_table_of(words);
    scenario.faults.push_back(
        read_fault(fmt::format("{} \"{}\"", kCommandLine, words), scenario.faults.size(), table, scenario));
}

}  // namespace puckloop::scenarios
