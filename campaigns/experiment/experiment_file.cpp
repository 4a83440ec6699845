#include "campaigns/experiment/experiment_file.h"

#include "base/text/toml_file.h"
#include "scenarios/values/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>

namespace puckloop::swarm {

namespace {

using scenarios::Dimension;
using scenarios::Reader;

constexpr std::int64_t kMostSeeds = 100'000;
constexpr std::size_t kMostRuns = 1'000'000;

/// Paths with a slash are relative to the file's folder; a bare name is looked for as `puckloop run` does.
std::string resolved(const std::string& text, const std::filesystem::path& folder) {
    if (text.find('/') == std::string::npos || text.starts_with("/")) return text;
    return (folder / text).lexically_normal().string();
}

std::string variable_text(Reader& reader, const std::string& name, const TomlValue& value) {
    if (const auto* flag = std::get_if<bool>(&value.data)) return *flag ? "true" : "false";
    if (const auto* number = std::get_if<std::int64_t>(&value.data)) return std::to_string(*number);
    if (const auto* number = std::get_if<double>(&value.data)) return fmt::format("{}", *number);
    if (const auto* text = std::get_if<std::string>(&value.data)) return *text;
    reader.fail("set", fmt::format("'{}' is no single value", name), "a text, number or truth value");
}

Variant read_variant(const std::string& file, const char* kind, std::size_t index, const TomlValue& table) {
    Reader reader(file, fmt::format("{} {}", kind, index + 1), table);
    const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
    Variant variant;
    variant.line = table.line;
    variant.name = reader.text("name");
    if (variant.name.empty() || variant.name.find_first_of("\n\r,\"") != std::string::npos)
        reader.fail("name", "the name cannot be in a table", "letters, without commas and quotes");
    if (const TomlValue* set = reader.table("set"))
        for (const auto& [name, value] : std::get<TomlTable>(set->data))
            variant.variables.push_back(name + "=" + variable_text(reader, name, value));
    if (reader.has("firmware"))
        for (const std::string& text : reader.texts("firmware")) {
            const auto equals = text.find('=');
            if (equals == std::string::npos)
                reader.fail("firmware", fmt::format("'{}' is not an assignment", text), "BOARD=IMAGE");
            variant.firmware.push_back(text.substr(0, equals + 1) +
                                       resolved(text.substr(equals + 1), folder));
        }
    if (reader.has("linux"))
        for (const std::string& text : reader.texts("linux"))
            variant.program.push_back(variant.program.empty() ? resolved(text, folder) : text);
    if (reader.has("model")) variant.model = folder / reader.text("model");
    reader.finish();
    return variant;
}

/// Without such tables one, named `only`, which changes nothing.
std::vector<Variant> read_variants(Reader& top, const char* kind, const char* only, int line) {
    std::vector<Variant> variants;
    for (const TomlValue* table : top.tables(kind)) {
        variants.push_back(read_variant(top.file(), kind, variants.size(), *table));
        const auto same = [&](const Variant& one) { return one.name == variants.back().name; };
        if (std::count_if(variants.begin(), variants.end(), same) > 1)
            Reader(top.file(), fmt::format("{} {}", kind, variants.size()), *table)
                .fail("name", fmt::format("there is another '{}'", variants.back().name),
                      "names that differ");
    }
    if (variants.empty()) {
        variants.emplace_back().name = only;
        variants.back().line = line;
    }
    return variants;
}

/// A count, for 1 to that, or a list.
std::vector<std::uint64_t> read_seeds(Reader& reader, const TomlValue& table) {
    constexpr const char* kExpected = "how many (1 to that are taken), or a list of whole numbers from 0 on";
    std::set<std::uint64_t> seeds;
    if (!reader.has("seeds")) reader.fail_missing("seeds", kExpected);
    for (const auto& [key, value] : std::get<TomlTable>(table.data)) {
        if (key != "seeds") continue;
        if (const auto* count = std::get_if<std::int64_t>(&value.data)) {
            if (*count < 1 || *count > kMostSeeds)
                reader.fail("seeds", "seeds is out of range", "1 to 100000");
            for (std::int64_t seed = 1; seed <= *count; ++seed)
                seeds.insert(static_cast<std::uint64_t>(seed));
        } else if (value.is_array()) {
            for (const TomlValue& item : std::get<TomlArray>(value.data)) {
                const auto* seed = std::get_if<std::int64_t>(&item.data);
                if (seed == nullptr || *seed < 0) reader.fail("seeds", "a seed cannot be", kExpected);
                if (!seeds.insert(static_cast<std::uint64_t>(*seed)).second)
                    reader.fail("seeds", fmt::format("seed {} is there twice", *seed), "each once");
            }
        }
    }
    if (seeds.empty()) reader.fail("seeds", "seeds has no number", kExpected);
    return {seeds.begin(), seeds.end()};
}

void read_head(Reader& reader, const TomlValue& table, Experiment& experiment) {
    const std::filesystem::path folder = std::filesystem::absolute(experiment.file).parent_path();
    experiment.scenario = (folder / reader.text("scenario")).lexically_normal();
    if (reader.has("mission")) experiment.mission = (folder / reader.text("mission")).lexically_normal();
    if (reader.has("floor")) experiment.floor = (folder / reader.text("floor")).lexically_normal();
    experiment.duration = reader.optional_quantity("duration", Dimension::Time);
    if (experiment.duration && !(*experiment.duration > 0.0 && *experiment.duration <= 2'592'000.0))
        reader.fail("duration", "duration is out of range", "more than 0 s, at most 720 h");
    experiment.program_start = reader.optional_quantity("linux_start", Dimension::Time);
    if (experiment.program_start && !(*experiment.program_start >= 0.0))
        reader.fail("linux_start", "linux_start is out of range", "0 s or later");
    experiment.seeds = read_seeds(reader, table);
    experiment.score = reader.text("score", experiment.score);
    try {
        const nlohmann::json::json_pointer pointer(experiment.score);
    } catch (const nlohmann::json::parse_error&) {
        reader.fail("score", fmt::format("'{}' is no JSON pointer", experiment.score),
                    "such as \"/mission/score\"");
    }
    if (reader.has("better"))
        experiment.more_is_better = reader.choice("better", "more", {"more", "less"}) == "more";
    experiment.keep = reader.flag("keep", false);
    reader.finish();
}

}  // namespace

Experiment read_experiment(const std::filesystem::path& file, const Changes& changes) {
    const TomlValue root = read_toml(file);
    Experiment experiment;
    experiment.file = file;
    Reader top(file.string(), "", root);
    const TomlValue* head = top.table("experiment");
    if (head == nullptr) top.fail_missing("experiment", "[experiment] with a scenario and seeds");
    Reader reader(file.string(), "experiment", *head);
    read_head(reader, *head, experiment);
    experiment.programs = read_variants(top, "program", "program", head->line);
    experiment.conditions = read_variants(top, "condition", "as it is", head->line);
    top.finish();
    if (changes.duration > 0.0) experiment.duration = changes.duration;
    if (changes.seeds > 0) {
        experiment.seeds.resize(static_cast<std::size_t>(changes.seeds));
        std::iota(experiment.seeds.begin(), experiment.seeds.end(), std::uint64_t{1});
    }
    if (experiment.programs.size() * experiment.conditions.size() * experiment.seeds.size() > kMostRuns)
        reader.fail("seeds", "the experiment has too many runs", fmt::format("at most {}", kMostRuns));
    return experiment;
}

nlohmann::json to_json(const Changes& changes) {
    return {{"seeds", changes.seeds}, {"duration", changes.duration}};
}

Changes changes_from_json(const nlohmann::json& text) {
    return {text.at("seeds"), text.at("duration")};
}

std::vector<Run> runs_of(const Experiment& experiment) {
    std::vector<Run> runs;
    for (std::size_t program = 0; program < experiment.programs.size(); ++program)
        for (std::size_t condition = 0; condition < experiment.conditions.size(); ++condition)
            for (const std::uint64_t seed : experiment.seeds)
                runs.push_back({static_cast<int>(runs.size()) + 1, program, condition, seed});
    return runs;
}

nlohmann::json to_json(const Run& run) {
    return {{"id", run.id}, {"program", run.program}, {"condition", run.condition}, {"seed", run.seed}};
}

Run run_from_json(const nlohmann::json& text) {
    return {text.at("id"), text.at("program"), text.at("condition"), text.at("seed")};
}

}  // namespace puckloop::swarm
