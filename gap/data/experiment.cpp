#include "gap/data/experiment.h"

#include "base/text/suggest.h"
#include "base/text/toml_file.h"
#include "gap/data/csv.h"
#include "gap/data/problems.h"
#include "gap/data/wheel_units.h"
#include "gap/kinds/columns.h"
#include "gap/kinds/description.h"
#include "gap/kinds/read_kind.h"
#include "scenarios/values/reader.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>

namespace puckloop::gap {

namespace {

using scenarios::Dimension;
using scenarios::Reader;

constexpr const char* kNumber = "a finite number";
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// What the whole file says, before the runs.
struct Frame {
    std::string file;
    std::map<std::string, std::string> conditions;
    std::map<std::string, std::map<std::string, double>> codes;  // of session and unit names, as they appear
    // In how many files:
    int with_decimal_commas = 0;
    std::map<std::string, int> like_thousands;  // by column
    std::map<std::string, int> unused;          // by what is said of a column
};

[[noreturn]] void fail_at(const std::string& file, int line, const std::string& problem,
                          const std::string& expected = {}) {
    throw InputError(file, fmt::format("line {}", line), problem, expected);
}

double as_number(const Reader& reader, const std::string& key, const TomlValue& value,
                 const char* wanted = kNumber) {
    if (const auto* whole = std::get_if<std::int64_t>(&value.data)) return static_cast<double>(*whole);
    if (const auto* real = std::get_if<double>(&value.data); real != nullptr && std::isfinite(*real))
        return *real;
    fail_at(reader.file(), value.line, fmt::format("{} is not a number", key), wanted);
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
            fail_at(reader.file(), value.line, fmt::format("condition {} is not a text", key),
                    "a text or a number");
        conditions[key] = text;
    }
}

const ColumnInfo& known_column(Reader& reader, const Kind& kind, const std::string& name) {
    if (const ColumnInfo* info = find_column(kind, name)) return *info;
    std::vector<std::string_view> names;
    for (const ColumnInfo& column : columns_of(kind))
        names.emplace_back(column.name);
    reader.fail(
        name, fmt::format("kind {} has no column \"{}\"{}", kind_name(kind), name, did_you_mean(name, names)),
        kind == Kind::Described ? "a column of its file" : "a column of docs/gap.md");
}

/// [columns] x_m = { from = "x", unit = "mm" }, or x_m = "mm".
void read_columns(const TomlValue& table, Experiment& experiment, const std::string& file) {
    Reader reader(file, "columns", table);
    for (const auto& [name, value] : reader.everything()) {
        const ColumnInfo& info = known_column(reader, experiment.kind, name);
        std::string from = name, unit;
        if (value.is_string()) {
            unit = std::get<std::string>(value.data);
        } else {
            if (!value.is_table())
                fail_at(file, value.line, fmt::format("column {} is neither unit nor table", name),
                        "\"mm\", say, or { from = \"name in the file\", unit = \"mm\" }");
            Reader entry(file, "column " + name, value);
            from = entry.text("from", name);
            unit = entry.text("unit", info.unit);
            entry.finish();
        }
        if (!unit_to_si(unit, info.unit) && !is_wheel_unit(name, unit)) {
            const std::string_view besides = wheel_units(name);
            fail_at(file, value.line, fmt::format("column {} cannot be in \"{}\"", name, unit),
                    fmt::format("{}{}{}", fmt::join(unit_names(info.unit), ", "), besides.empty() ? "" : ", ",
                                besides));
        }
        experiment.stated[name] = {from, unit, value.line};
    }
}

void read_instruments(const TomlValue& table, Experiment& experiment, const std::string& file) {
    Reader reader(file, "instrument", table);
    for (const auto& [name, value] : reader.everything()) {
        known_column(reader, experiment.kind, name);
        if (!value.is_table())
            fail_at(file, value.line, fmt::format("instrument {} is not a table", name),
                    "{ floor = 0, ceiling = 4095, quantum = 1 }, or some of these");
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

/// What a described kind says of its instruments, where the experiment does not.
void add_described_instruments(Experiment& experiment) {
    const Description* own = experiment.kind.description();
    if (own == nullptr) return;
    for (const DescribedObservable& one : own->observables)
        if (const Instrument& ends = one.instrument;
            !std::isnan(ends.floor) || !std::isnan(ends.ceiling) || ends.quantum > 0)
            experiment.instruments.emplace(own->columns[one.column].name, ends);
}

/// A number given for the whole run becomes a column; names of sessions and units become numbers 1, 2, ...
void read_constants(Reader& reader, const Kind& kind, const TomlValue& table, Frame& frame, Run& run) {
    for (const ColumnInfo& info : columns_of(kind))
        (void)reader.has(info.name);  // known, for what is suggested in the place of an unknown key
    for (const auto& [key, value] : std::get<TomlTable>(table.data)) {
        if (find_column(kind, key) == nullptr) continue;
        const bool named = key == "session" || key == "unit";
        double number = 0.0;
        if (named && value.is_string()) {
            const auto& name = std::get<std::string>(value.data);
            auto& codes = frame.codes[key];
            number = codes.emplace(name, static_cast<double>(codes.size() + 1)).first->second;
            run.conditions.emplace(key, name);
        } else {
            number = as_number(reader, key, value, named ? "a number, or a name in quotes" : kNumber);
        }
        if (run.columns.contains(key))
            fail_at(frame.file, value.line,
                    fmt::format("{} is given for the run and as a column of {}", key, run.file));
        run.columns[key].assign(run.rows, number);
    }
}

bool same_letters(std::string_view a, std::string_view b) {
    const auto small = [](unsigned char letter) { return std::tolower(letter); };
    return std::ranges::equal(a, b, {}, small, small);
}

/// All columns that are not there, in one line; with them what has other capitals, which a caution would name
/// later.
void require_columns(const Kind& kind, const Run& run, const std::vector<std::string>& in_file,
                     const std::filesystem::path& path, const Frame& frame) {
    const std::vector<std::string_view> names(in_file.begin(), in_file.end());
    std::string missing, capitals;
    for (const ColumnInfo& info : columns_of(kind)) {
        if (run.has(info.name)) continue;
        if (info.required)
            missing += fmt::format("{} \"{}\" ({}{})", missing.empty() ? "has no column" : ", none",
                                   info.name, info.meaning, did_you_mean(info.name, names));
        else
            for (const std::string_view name : names)
                if (name != info.name && same_letters(name, info.name))
                    capitals += fmt::format("; {} for \"{}\"", info.name, name);
    }
    if (!missing.empty())
        throw InputError(path.string(), "header", missing,
                         fmt::format("{}, or where to find it in [columns] of {}{}",
                                     missing.find(", none") == std::string::npos ? "it" : "each", frame.file,
                                     capitals));
}

Run read_run(const TomlValue& table, std::size_t index, Experiment& experiment, Frame& frame,
             Problems& problems) {
    Reader reader(frame.file, fmt::format("run {}", index + 1), table);
    Run run;
    run.file = reader.text("file");
    if (run.file.empty()) reader.fail("file", "file names nothing", "a CSV file of the experiment's folder");
    run.name = reader.text("name", std::filesystem::path(run.file).stem().string());
    run.conditions = frame.conditions;
    read_conditions(reader, run.conditions);
    const std::filesystem::path path = experiment.folder / run.file;
    CsvTable csv = read_csv(path, problems);
    run.rows = csv.rows();
    frame.with_decimal_commas += csv.decimal_commas ? 1 : 0;
    for (const std::string& name : csv.like_thousands)
        ++frame.like_thousands[name];
    std::map<std::string, std::string> used;  // CSV name: canonical name
    for (const ColumnInfo& info : columns_of(experiment.kind)) {
        const auto stated = experiment.stated.find(info.name);
        const auto& [from, unit, line] =
            stated == experiment.stated.end() ? Stated{info.name, info.unit} : stated->second;
        const auto place = std::ranges::find(csv.names, from);
        if (place == csv.names.end()) continue;
        const auto to_si = unit_to_si(unit, info.unit);
        auto& values = run.columns[info.name] =
            csv.columns[static_cast<std::size_t>(place - csv.names.begin())];
        for (double& value : values)
            if (to_si) value = value * to_si->factor + to_si->offset;
        if (const auto [other, fresh] = used.emplace(from, info.name); !fresh)
            throw InputError(frame.file, "",
                             fmt::format("{} and {} are both the column \"{}\" of {}", other->second,
                                         info.name, from, run.file),
                             "a column of its own for each");
    }
    for (const auto& [name, stated] : experiment.stated)
        if (!run.has(name) && std::ranges::find(csv.names, stated.from) == csv.names.end() &&
            find_column(experiment.kind, name)->required)
            throw InputError(path.string(), "header", fmt::format("has no column \"{}\"", stated.from),
                             fmt::format("it, as {} says", frame.file));
    read_constants(reader, experiment.kind, table, frame, run);
    for (const auto& [name, stated] : experiment.stated)  // t_s is known by now
        if (run.has(name) && is_wheel_unit(name, stated.unit)) to_steps(experiment, run, name, stated.unit);
    require_columns(experiment.kind, run, csv.names, path, frame);
    std::vector<std::string_view> absent;
    for (const ColumnInfo& info : columns_of(experiment.kind))
        if (!run.has(info.name)) absent.emplace_back(info.name);
    for (const std::string& name : csv.names)
        if (!used.contains(name) && !name.empty())
            ++frame.unused[fmt::format("column \"{}\" is not used{}", name, did_you_mean(name, absent))];
    reader.finish();
    return run;
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
    std::array<char, 4096> start{};
    const auto read = opened(file, kRemedy).read(start.data(), start.size()).gcount();
    if (is_binary({start.data(), static_cast<std::size_t>(read)}))
        throw InputError(file, "", "is binary, not text", kRemedy);
    return read_toml(file);
}

}  // namespace

Experiment read_folder(const std::filesystem::path& folder, Problems& problems) {
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
    experiment.kind =
        kind_stated(top.text("kind"), folder, frame.file, fmt::format("line {}", top.line_of("kind")));
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
    if (top.flag("brief", false))
        experiment.caution(
            "this is a brief recording, to see what is recorded: too few and too short runs for a "
            "verdict, whichever it is");
    read_assumed(top, experiment);
    if (const TomlValue* table = top.table("columns")) read_columns(*table, experiment, frame.file);
    if (const TomlValue* table = top.table("nominal"))
        flatten(top, "", std::get<TomlTable>(table->data), experiment.nominal);
    if (const TomlValue* table = top.table("instrument")) read_instruments(*table, experiment, frame.file);
    add_described_instruments(experiment);
    read_conditions(top, frame.conditions);
    const auto runs = top.tables("run");
    if (runs.empty()) top.fail("run", "no run", "at least one [[run]] with its file");
    top.finish();
    for (std::size_t i = 0; i < runs.size(); ++i)
        problems.attempt(
            [&] { experiment.runs.push_back(read_run(*runs[i], i, experiment, frame, problems)); });
    const bool whole = experiment.runs.size() == runs.size();
    for (const auto& [name, stated] : experiment.stated)
        problems.attempt([&] {
            if (whole && !experiment.has(name))
                fail_at(frame.file, stated.line,
                        fmt::format("{} is to be the column \"{}\", which no file has", name, stated.from),
                        "a column of the CSV files");
        });
    for (const auto& [text, files] : frame.unused)
        experiment.caution("{} ({} file{})", text, files, files == 1 ? "" : "s");
    if (frame.with_decimal_commas > 0)
        experiment.caution("commas inside cells are read as decimal commas (0,5 is 0.5) in {} of {} files",
                           frame.with_decimal_commas, runs.size());
    for (const auto& [name, files] : frame.like_thousands)
        experiment.caution("column \"{}\" has three digits behind every comma in {} of {} files: read as "
                           "decimals (1,200 is 1.2), not as thousands",
                           name, files, runs.size());
    return experiment;
}

}  // namespace puckloop::gap
