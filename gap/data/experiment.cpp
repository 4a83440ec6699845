#include "gap/data/experiment.h"

#include "base/error.h"
#include "base/suggest.h"
#include "base/toml_file.h"
#include "gap/data/columns.h"
#include "gap/data/csv.h"
#include "gap/data/problems.h"
#include "gap/sync/frames.h"
#include "gap/sync/pauses.h"
#include "gap/validate/check.h"
#include "scenarios/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <stdexcept>

namespace puckloop::gap {

namespace {

using scenarios::Dimension;
using scenarios::Reader;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Where a canonical column comes from: [columns] x_m = { from = "x", unit = "mm" }.
struct Origin {
    std::string from, unit;
    int line = 0;
};

/// What the whole file says, before the runs.
struct Frame {
    std::string file;
    std::map<std::string, Origin, std::less<>> origins;
    std::map<std::string, std::string> conditions;
    std::map<std::string, double> codes[2];  // of session and unit names, in order of appearance
    int with_decimal_commas = 0;             // files
};

double as_number(const Reader& reader, const std::string& key, const TomlValue& value) {
    if (const auto* whole = std::get_if<std::int64_t>(&value.data)) return static_cast<double>(*whole);
    if (const auto* real = std::get_if<double>(&value.data); real != nullptr && std::isfinite(*real))
        return *real;
    throw InputError(reader.file(), fmt::format("line {}", value.line),
                     fmt::format("{} is not a number", key), "a finite number");
}

/// "proximity.curve" = 1 and [nominal.proximity] curve = 1 alike.
void flatten(const Reader& reader, const std::string& prefix, const TomlTable& table,
             std::map<std::string, double>& out) {
    for (const auto& [key, value] : table) {
        const std::string name = prefix.empty() ? key : prefix + "." + key;
        if (value.is_table())
            flatten(reader, name, std::get<TomlTable>(value.data), out);
        else
            out[name] = as_number(reader, name, value);
    }
}

std::string as_text(const TomlValue& value) {
    if (const auto* text = std::get_if<std::string>(&value.data)) return *text;
    if (const auto* whole = std::get_if<std::int64_t>(&value.data)) return fmt::format("{}", *whole);
    if (const auto* real = std::get_if<double>(&value.data)) return fmt::format("{}", *real);
    if (const auto* flag = std::get_if<bool>(&value.data)) return *flag ? "yes" : "no";
    return "";
}

void read_conditions(Reader& reader, std::map<std::string, std::string>& conditions) {
    const TomlValue* table = reader.table("conditions");
    if (table == nullptr) return;
    for (const auto& [key, value] : std::get<TomlTable>(table->data)) {
        const std::string text = as_text(value);
        if (text.empty())
            throw InputError(reader.file(), fmt::format("line {}", value.line),
                             fmt::format("condition {} is not a text", key), "a text or a number");
        conditions[key] = text;
    }
}

const ColumnInfo& known_column(Reader& reader, Kind kind, const std::string& name) {
    if (const ColumnInfo* info = find_column(kind, name)) return *info;
    std::vector<std::string_view> names;
    for (const ColumnInfo& column : columns_of(kind))
        names.emplace_back(column.name);
    reader.fail(
        name, fmt::format("kind {} has no column \"{}\"{}", kind_name(kind), name, did_you_mean(name, names)),
        "a column of docs/gap.md");
}

void read_columns(const TomlValue& table, Kind kind, Frame& frame) {
    Reader reader(frame.file, "columns", table);
    for (const auto& [name, value] : reader.everything()) {
        const ColumnInfo& info = known_column(reader, kind, name);
        Origin origin{name, info.unit, value.line};
        if (value.is_string()) {
            origin.unit = std::get<std::string>(value.data);
        } else {
            Reader entry(frame.file, "column " + name, value);
            origin.from = entry.text("from", name);
            origin.unit = entry.text("unit", info.unit);
            entry.finish();
        }
        double factor = 1.0, offset = 0.0;
        if (!unit_to_si(origin.unit, info.unit, factor, offset))
            throw InputError(frame.file, fmt::format("line {}", value.line),
                             fmt::format("column {} cannot be in \"{}\"", name, origin.unit),
                             units_of(info.unit));
        frame.origins[name] = origin;
    }
}

void read_instruments(const TomlValue& table, Experiment& experiment, const std::string& file) {
    Reader reader(file, "instrument", table);
    for (const auto& [name, value] : reader.everything()) {
        known_column(reader, experiment.kind, name);
        Reader entry(file, "instrument " + name, value);
        Instrument instrument{entry.quantity("floor", Dimension::Number, kNone),
                              entry.quantity("ceiling", Dimension::Number, kNone),
                              entry.quantity("quantum", Dimension::Number, 0.0)};
        if (instrument.quantum < 0 || instrument.floor >= instrument.ceiling)
            entry.fail("floor", "floor, ceiling and quantum do not fit",
                       "floor below ceiling, quantum not negative");
        entry.finish();
        experiment.instruments[name] = instrument;
    }
}

/// A number given for the whole run becomes a column; names of sessions and units become numbers 1, 2, ...
void read_constants(Reader& reader, Kind kind, const TomlValue& table, Frame& frame, Run& run) {
    for (const ColumnInfo& info : columns_of(kind))
        (void)reader.has(info.name);  // known, for what is suggested in the place of an unknown key
    for (const auto& [key, value] : std::get<TomlTable>(table.data)) {
        if (find_column(kind, key) == nullptr) continue;
        double number = 0.0;
        if ((key == "session" || key == "unit") && value.is_string()) {
            auto& codes = frame.codes[key == "session" ? 0 : 1];
            number = codes.emplace(std::get<std::string>(value.data), static_cast<double>(codes.size() + 1))
                         .first->second;
            run.conditions.emplace(key, std::get<std::string>(value.data));
        } else {
            number = as_number(reader, key, value);
        }
        if (run.columns.contains(key))
            throw InputError(frame.file, fmt::format("line {}", value.line),
                             fmt::format("{} is given for the run and as a column of {}", key, run.file));
        run.columns[key].assign(run.rows, number);
    }
}

Run read_run(const TomlValue& table, std::size_t index, Experiment& experiment, Frame& frame,
             Problems* problems) {
    Reader reader(frame.file, fmt::format("run {}", index + 1), table);
    Run run;
    run.file = reader.text("file");
    run.name = reader.text("name", std::filesystem::path(run.file).stem().string());
    run.conditions = frame.conditions;
    read_conditions(reader, run.conditions);
    const std::filesystem::path path = experiment.folder / run.file;
    CsvTable csv = read_csv(path, problems);
    run.rows = csv.rows();
    frame.with_decimal_commas += csv.decimal_commas ? 1 : 0;
    std::map<std::string, std::string> used;  // CSV name: canonical name
    for (const ColumnInfo& info : columns_of(experiment.kind)) {
        const auto origin = frame.origins.find(info.name);
        const std::string from = origin == frame.origins.end() ? info.name : origin->second.from;
        const auto place = std::find(csv.names.begin(), csv.names.end(), from);
        if (place == csv.names.end()) continue;
        double factor = 1.0, offset = 0.0;
        if (origin != frame.origins.end()) unit_to_si(origin->second.unit, info.unit, factor, offset);
        auto& values = run.columns[info.name] =
            csv.columns[static_cast<std::size_t>(place - csv.names.begin())];
        for (double& value : values)
            value = value * factor + offset;
        if (const auto [other, fresh] = used.emplace(from, info.name); !fresh)
            throw InputError(frame.file, "",
                             fmt::format("{} and {} are both the column \"{}\" of {}", other->second,
                                         info.name, from, run.file),
                             "a column of its own for each");
    }
    for (const auto& [name, origin] : frame.origins)
        if (!run.has(name) && std::find(csv.names.begin(), csv.names.end(), origin.from) == csv.names.end() &&
            find_column(experiment.kind, name)->required)
            throw InputError(path.string(), "header", fmt::format("has no column \"{}\"", origin.from),
                             fmt::format("it, as {} says", frame.file));
    read_constants(reader, experiment.kind, table, frame, run);
    const std::vector<std::string_view> names(csv.names.begin(), csv.names.end());
    for (const ColumnInfo& info : columns_of(experiment.kind))
        if (info.required && !run.has(info.name))
            throw InputError(path.string(), "header",
                             fmt::format("has no column \"{}\" ({}){}", info.name, info.meaning,
                                         did_you_mean(info.name, names)),
                             fmt::format("it, or where to find it in [columns] of {}", frame.file));
    std::vector<std::string_view> absent;
    for (const ColumnInfo& info : columns_of(experiment.kind))
        if (!run.has(info.name)) absent.emplace_back(info.name);
    for (const std::string& name : csv.names) {
        if (used.contains(name) || name.empty()) continue;
        experiment.caution("{}: column \"{}\" is not used{}", run.file, name, did_you_mean(name, absent));
    }
    reader.finish();
    return run;
}

void tidy(std::vector<std::string>& cautions) {
    std::vector<std::string> once;
    std::map<std::string, int> unused;  // the same column in many files: one line
    for (const auto& caution : cautions) {
        const auto at = caution.find(": column \"");
        if (at == std::string::npos || caution.find("\" is not used", at) == std::string::npos)
            once.push_back(caution);
        else
            ++unused[caution.substr(at + 2)];
    }
    for (const auto& [text, count] : unused)
        once.push_back(fmt::format("{} ({} file{})", text, count, count == 1 ? "" : "s"));
    cautions = std::move(once);
}

}  // namespace

const std::vector<double>& Run::column(std::string_view column_name) const {
    static const std::vector<double> none;
    const auto place = columns.find(column_name);
    return place == columns.end() ? none : place->second;
}

std::string Run::condition(const std::string& condition_name) const {
    const auto place = conditions.find(condition_name);
    return place == conditions.end() ? "" : place->second;
}

std::size_t Experiment::rows() const {
    std::size_t sum = 0;
    for (const Run& run : runs)
        sum += run.rows;
    return sum;
}

double Experiment::nominal_or(const std::string& name, double otherwise) const {
    const auto stated = nominal.find(name);
    return stated == nominal.end() ? otherwise : stated->second;
}

bool Experiment::has(std::string_view column) const {
    return std::any_of(runs.begin(), runs.end(), [&](const Run& run) { return run.has(column); });
}

stats::Range Experiment::range(std::string_view column) const {
    stats::Range all;
    for (const Run& run : runs)
        all.take(run.column(column));
    return all;
}

namespace {

/// assumed = ["distance_m"]
void read_assumed(Reader& top, Experiment& experiment) {
    experiment.assumed = top.texts("assumed");
    for (const std::string& name : experiment.assumed) {
        const ColumnInfo* info = find_column(experiment.kind, name);
        if (info == nullptr || info->role != Role::Truth)
            top.fail("assumed", fmt::format("{} is no truth of kind {}", name, kind_name(experiment.kind)),
                     "a truth column of docs/gap.md");
        experiment.caution(
            "{} was not measured but assumed: whatever is found may be an error of it, so nothing is named",
            name);
    }
}

/// What is no TOML at all, with what makes one.
TomlValue read_description(const std::string& file) {
    constexpr const char* kRemedy = "the description that `puckloop gap new KIND DIR` begins, docs/gap.md";
    std::error_code ignored;
    using enum std::filesystem::file_type;
    const auto type = std::filesystem::status(file, ignored).type();
    if (type == not_found) throw InputError(file, "", "is not there", kRemedy);
    if (type == directory) throw InputError(file, "", "is a folder, not a file", kRemedy);
    if (type != regular) throw InputError(file, "", "is a pipe or device, which may never end", kRemedy);
    std::array<char, 4096> start{};
    const auto read = std::ifstream(file, std::ios::binary).read(start.data(), start.size()).gcount();
    if (is_binary({start.data(), static_cast<std::size_t>(read)}))
        throw InputError(file, "", "is binary, not text", kRemedy);
    return read_toml(file);
}

Experiment read_folder(const std::filesystem::path& folder, Problems* problems) {
    std::error_code ignored;
    const auto type = std::filesystem::status(folder, ignored).type();
    if (type == std::filesystem::file_type::not_found)
        throw InputError(folder.string(), "", "is not there", "a folder with experiment.toml");
    if (type != std::filesystem::file_type::directory)
        throw InputError(folder.string(), "", "is not a folder", "the folder that holds experiment.toml");
    Frame frame;
    frame.file = (folder / "experiment.toml").string();
    const TomlValue root = read_description(frame.file);
    Reader top(frame.file, "", root);
    Experiment experiment;
    experiment.folder = folder;
    const std::string kind = top.text("kind");
    try {
        experiment.kind = kind_named(kind);
    } catch (const std::invalid_argument& error) {
        top.fail("kind", error.what(), "proximity, motion, rab, microphone, ground, accelerometer or timing");
    }
    experiment.title = top.text("title", "");
    if (experiment.title.empty())  // "DIR/" has no file name of its own
        experiment.title = std::filesystem::absolute(folder / "experiment.toml")
                               .lexically_normal()
                               .parent_path()
                               .filename()
                               .string();
    experiment.robot = top.text("robot", "");
    experiment.description = top.text("description", "");
    experiment.source = top.text("source", "");
    experiment.licence = top.text("licence", "");
    read_assumed(top, experiment);
    if (const TomlValue* table = top.table("columns")) read_columns(*table, experiment.kind, frame);
    if (const TomlValue* table = top.table("nominal"))
        flatten(top, "", std::get<TomlTable>(table->data), experiment.nominal);
    if (const TomlValue* table = top.table("instrument")) read_instruments(*table, experiment, frame.file);
    read_conditions(top, frame.conditions);
    const auto runs = top.tables("run");
    if (runs.empty()) top.fail("run", "no run", "at least one [[run]] with its file");
    top.finish();
    for (std::size_t i = 0; i < runs.size(); ++i)
        attempt(problems,
                [&] { experiment.runs.push_back(read_run(*runs[i], i, experiment, frame, problems)); });
    const bool whole = experiment.runs.size() == runs.size();
    for (const auto& [name, origin] : frame.origins)
        attempt(problems, [&] {
            if (whole && !experiment.has(name))
                throw InputError(
                    frame.file, fmt::format("line {}", origin.line),
                    fmt::format("{} is to be the column \"{}\", which no file has", name, origin.from),
                    "a column of the CSV files");
        });
    tidy(experiment.cautions);
    if (frame.with_decimal_commas > 0)
        experiment.caution("commas inside cells are read as decimal commas (0,5 is 0.5) in {} of {} files",
                           frame.with_decimal_commas, runs.size());
    return experiment;
}

}  // namespace

Experiment read_experiment(const std::filesystem::path& folder) {
    Experiment experiment = read_folder(folder, nullptr);
    check(experiment);
    align_times(experiment);
    find_pauses(experiment);
    return experiment;
}

Experiment survey_experiment(const std::filesystem::path& folder, Problems& problems) {
    Experiment experiment = read_folder(folder, &problems);
    if (!experiment.runs.empty()) check(experiment, &problems);
    return experiment;
}

}  // namespace puckloop::gap
