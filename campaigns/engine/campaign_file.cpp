#include "campaigns/engine/campaign_file.h"

#include "base/error.h"
#include "scenarios/values/reader.h"

#include <fmt/format.h>

#include <cstdlib>
#include <set>

namespace puckloop::faults {

namespace {

using nlohmann::json;
using scenarios::Dimension;
using scenarios::Reader;

constexpr std::int64_t kMostCases = 1'000'000;
constexpr std::size_t kMostGrid = 100'000;  ///< of one sweep
constexpr int kLongestRecord = 4096;

const TomlValue* value_of(const TomlValue& table, std::string_view key) {
    for (const auto& [name, value] : std::get<TomlTable>(table.data))
        if (name == key) return &value;
    return nullptr;
}

/// A list of whole numbers `low` to `high`; none where the key is absent.
std::optional<std::vector<std::int64_t>> numbers(Reader& reader, const TomlValue& table, std::string_view key,
                                                 std::int64_t low, std::int64_t high) {
    if (!reader.has(key)) return std::nullopt;
    const TomlValue& value = *value_of(table, key);
    const std::string expected = fmt::format("a list of whole numbers from {} to {}", low, high);
    if (!value.is_array()) reader.fail(key, fmt::format("{} is no list", key), expected);
    std::vector<std::int64_t> list;
    for (const TomlValue& item : std::get<TomlArray>(value.data)) {
        const auto* number = std::get_if<std::int64_t>(&item.data);
        if (number == nullptr || *number < low || *number > high)
            reader.fail(key, fmt::format("{} has a value that cannot be", key), expected);
        list.push_back(*number);
    }
    if (list.empty()) reader.fail(key, fmt::format("{} is empty", key), expected);
    if (std::set<std::int64_t>(list.begin(), list.end()).size() != list.size())
        reader.fail(key, fmt::format("{} has a value twice", key), expected);
    return list;
}

/// `$NAME/rest` from the environment; paths with a slash relative to `folder`.
std::string resolved(Reader& reader, std::string_view key, std::string text,
                     const std::filesystem::path& folder, Campaign& campaign) {
    if (text.starts_with("$")) {
        const auto slash = std::min(text.find('/'), text.size());
        const std::string name = text.substr(1, slash - 1);
        const char* value = std::getenv(name.c_str());
        if (value == nullptr)
            reader.fail(key, fmt::format("the environment has no {}", name),
                        fmt::format("{} set to a folder or file", name));
        campaign.environment[name] = value;
        return value + text.substr(slash);
    }
    if (text.find('/') == std::string::npos || text.starts_with("/")) return text;
    return (folder / text).lexically_normal().string();
}

void read_head(Reader& reader, const TomlValue& table, Campaign& campaign) {
    const std::filesystem::path folder = std::filesystem::absolute(campaign.file).parent_path();
    campaign.scenario = (folder / reader.text("scenario")).lexically_normal();
    campaign.duration = reader.optional_quantity("duration", Dimension::Time);
    if (campaign.duration && !(*campaign.duration > 0))
        reader.fail("duration", "the duration is not above 0", "such as \"10 s\"");
    if (reader.has("firmware"))
        for (const std::string& text : reader.texts("firmware")) {
            const auto equals = text.find('=');
            if (equals == std::string::npos)
                reader.fail("firmware", fmt::format("'{}' is not an assignment", text), "BOARD=IMAGE");
            campaign.firmware.push_back(text.substr(0, equals + 1) + resolved(reader, "firmware",
                                                                              text.substr(equals + 1), folder,
                                                                              campaign));
        }
    if (reader.has("program"))
        for (const std::string& text : reader.texts("program"))
            campaign.program.push_back(resolved(reader, "program", text, folder, campaign));
    campaign.seeds = {1};
    if (const auto seeds = numbers(reader, table, "seeds", 0, std::int64_t{1} << 62))
        campaign.seeds.assign(seeds->begin(), seeds->end());
    campaign.cases = static_cast<std::size_t>(reader.integer("cases", 2000, 1, kMostCases));
    campaign.pairs = static_cast<std::size_t>(reader.integer("pairs", 0, 0, kMostCases));
    campaign.sample_seed =
        static_cast<std::uint64_t>(reader.integer("sample_seed", 1, 0, std::int64_t{1} << 62));
    reader.finish();
}

void read_limits(const std::string& file, const TomlValue& table, Limits& limits) {
    Reader reader(file, "limits", table);
    limits.silence = reader.quantity("silence", Dimension::Time, limits.silence);
    limits.pause = reader.quantity("pause", Dimension::Time, limits.pause);
    limits.resets = static_cast<int>(reader.integer("resets", limits.resets, 1, 1000));
    limits.departure = reader.quantity("departure", Dimension::Length, limits.departure);
    for (const auto& [key, value] : {std::pair{"silence", limits.silence}, std::pair{"pause", limits.pause},
                                     std::pair{"departure", limits.departure}})
        if (!(value > 0)) reader.fail(key, fmt::format("{} is not above 0", key));
    reader.finish();
}

Metric read_metric(const std::string& file, std::size_t index, const TomlValue& table) {
    Reader reader(file, fmt::format("metric {}", index + 1), table);
    Metric metric;
    metric.name = reader.text("name");
    metric.robot = reader.text("robot", "");
    metric.value = reader.text("value", "");
    metric.log = reader.text("log", "");
    if (!metric.log.empty()) metric.lines = reader.text("lines");
    if (!metric.robot.empty() + !metric.value.empty() + !metric.log.empty() != 1)
        reader.fail("name", "a metric is one of a robot's path, a value of the report and a log's lines",
                    "robot = \"robot0\", value = \"/nodes/...\" or log = \"robot0.linux\" with lines");
    try {
        const json::json_pointer pointer(metric.value);
    } catch (const json::parse_error&) {
        reader.fail("value", fmt::format("'{}' is no JSON pointer", metric.value),
                    "such as \"/nodes/robot0.pic/wheel_steps/left\"");
    }
    const TomlValue* tolerance = value_of(table, "tolerance");
    const auto* text = tolerance != nullptr ? std::get_if<std::string>(&tolerance->data) : nullptr;
    metric.relative = text != nullptr && text->find('%') != std::string::npos;
    const bool length = text != nullptr && !metric.relative;
    metric.tolerance = reader.quantity("tolerance", length ? Dimension::Length : Dimension::Ratio);
    if (!(metric.tolerance >= 0)) reader.fail("tolerance", "tolerance is below 0");
    reader.finish();
    return metric;
}

void read_over(Reader& reader, const TomlValue& table, Sweep& sweep) {
    for (const auto& [key, value] : std::get<TomlTable>(table.data)) {
        if (!value.is_array() || std::get<TomlArray>(value.data).empty())
            reader.fail("over", fmt::format("'{}' has no list of values", key), "such as kind = [\"drop\"]");
        if (sweep.fault.contains(key))
            reader.fail("over", fmt::format("'{}' is in 'fault', too", key), "one of them");
        std::vector<json> values;
        for (const TomlValue& item : std::get<TomlArray>(value.data))
            values.push_back(to_json(item));
        sweep.over.emplace_back(key, std::move(values));
    }
}

void read_times(Reader& reader, const TomlValue& table, const std::string& file, Sweep& sweep) {
    Reader grid(file, "times", table);
    const double from = grid.quantity("from", Dimension::Time), to = grid.quantity("to", Dimension::Time),
                 step = grid.quantity("step", Dimension::Time);
    grid.finish();
    if (!(from >= 0 && to >= from && step > 0) || (to - from) / step > double(kMostGrid))
        reader.fail("times", "the grid of times cannot be", "0 s <= from <= to, step above 0 s");
    for (std::size_t i = 0; from + double(i) * step <= to + step * 1e-9; ++i)
        sweep.times.push_back(fmt::format("{:.9g} s", from + double(i) * step));
}

Sweep read_sweep(const std::string& file, std::size_t index, const TomlValue& table) {
    Reader reader(file, fmt::format("sweep {}", index + 1), table);
    Sweep sweep;
    sweep.line = table.line;
    sweep.name = reader.text("name", fmt::format("sweep {}", index + 1));
    const TomlValue* fault = reader.table("fault");
    if (fault == nullptr) reader.fail("fault", "fault is missing", "keys of a [[fault]] table");
    sweep.fault = to_json(*fault);
    if (const TomlValue* over = reader.table("over")) read_over(reader, *over, sweep);
    if (const TomlValue* times = reader.table("times")) read_times(reader, *times, file, sweep);
    sweep.positions = reader.has("byte");
    if (sweep.positions) {
        const TomlValue& byte = *value_of(table, "byte");
        if (byte.is_string() && std::get<std::string>(byte.data) != "all")
            reader.fail("byte", "byte is no list of positions", "such as [0, 1, 71], or \"all\"");
        if (!byte.is_string()) {
            const auto list = numbers(reader, table, "byte", 0, kLongestRecord);
            sweep.bytes.emplace(list->begin(), list->end());
        }
    }
    sweep.records = {0};
    if (const auto list = numbers(reader, table, "record", 0, 1'000'000))
        sweep.records.assign(list->begin(), list->end());
    sweep.after = reader.quantity("after", Dimension::Time, 0.0);
    const bool begins = sweep.fault.contains("begin");
    if (sweep.positions && (begins || !sweep.times.empty()))
        reader.fail("byte", "a byte's position is when the fault begins", "no 'begin' and no 'times'");
    if (!sweep.positions && (reader.has("record") || reader.has("after")))
        reader.fail(reader.has("record") ? "record" : "after",
                    "record and after count nothing without 'byte'", "byte = [...] or \"all\"");
    if (begins && !sweep.times.empty()) reader.fail("times", "'begin' is in 'fault', too", "one of them");
    reader.finish();
    std::size_t grid = std::max<std::size_t>(1, sweep.times.size());
    for (const auto& [key, values] : sweep.over)
        grid *= values.size();
    if (grid > kMostGrid)
        reader.fail("over", fmt::format("the grid has {} faults", grid),
                    fmt::format("at most {}", kMostGrid));
    return sweep;
}

}  // namespace

json to_json(const TomlValue& value) {
    if (value.is_array()) {
        json array = json::array();
        for (const TomlValue& item : std::get<TomlArray>(value.data))
            array.push_back(to_json(item));
        return array;
    }
    if (value.is_table()) {
        json table = json::object();
        for (const auto& [key, item] : std::get<TomlTable>(value.data))
            table[key] = to_json(item);
        return table;
    }
    if (const auto* flag = std::get_if<bool>(&value.data)) return *flag;
    if (const auto* number = std::get_if<std::int64_t>(&value.data)) return *number;
    if (const auto* number = std::get_if<double>(&value.data)) return *number;
    return std::get<std::string>(value.data);
}

TomlValue to_toml(const json& value, int line) {
    TomlValue result;
    result.line = line;
    if (value.is_array()) {
        TomlArray array;
        for (const json& item : value)
            array.push_back(to_toml(item, line));
        result.data = std::move(array);
    } else if (value.is_object()) {
        TomlTable table;
        for (const auto& [key, item] : value.items())
            table.emplace_back(key, to_toml(item, line));
        result.data = std::move(table);
    } else if (value.is_boolean()) {
        result.data = value.get<bool>();
    } else if (value.is_number_integer()) {
        result.data = value.get<std::int64_t>();
    } else if (value.is_number()) {
        result.data = value.get<double>();
    } else {
        result.data = value.get<std::string>();
    }
    return result;
}

Campaign read_campaign(const std::filesystem::path& file) {
    const TomlValue root = read_toml(file);
    Campaign campaign;
    campaign.file = file;
    Reader reader(file.string(), "the campaign", root);
    const TomlValue* head = reader.table("campaign");
    if (head == nullptr) reader.fail("campaign", "there is no [campaign]", "[campaign] with a scenario");
    Reader head_reader(file.string(), "campaign", *head);
    read_head(head_reader, *head, campaign);
    if (const TomlValue* limits = reader.table("limits"))
        read_limits(file.string(), *limits, campaign.limits);
    for (const TomlValue* table : reader.tables("metric"))
        campaign.metrics.push_back(read_metric(file.string(), campaign.metrics.size(), *table));
    for (const TomlValue* table : reader.tables("sweep"))
        campaign.sweeps.push_back(read_sweep(file.string(), campaign.sweeps.size(), *table));
    reader.finish();
    if (campaign.sweeps.empty()) reader.fail("sweep", "there is no [[sweep]]", "at least one grid of faults");
    return campaign;
}

}  // namespace puckloop::faults
