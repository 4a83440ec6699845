#include "gap/begin/new_folder.h"

#include "base/error.h"
#include "base/files/text_file.h"
#include "gap/data/written.h"
#include "gap/effects/effect.h"
#include "gap/kinds/columns.h"
#include "gap/kinds/description.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

namespace puckloop::gap {

namespace {

constexpr const char* kRoles[] = {"measured", "truth", "set up", "noted"};  // in the order of Role

/// What an instrument of the kind can report, as an example, where there is a usual one.
const std::map<Kind::Builtin, const char*> kUsualInstrument{
    {Kind::Proximity, "reading = { floor = 0, ceiling = 4095, quantum = 1 }"},
    {Kind::Ground, "reading = { floor = 0, ceiling = 1023, quantum = 1 }"},
    {Kind::Microphone, "level = { floor = 0, quantum = 1 }"},
    {Kind::Motion, "x_m = { quantum = 0.0001 }   # step between two values that the tracker reports, m"},
    {Kind::Accelerometer, "ax = { floor = 0, ceiling = 4095, quantum = 1 }"}};

/// Of a described kind all that its user named.
bool in_header(const Kind& kind, const ColumnInfo& column) {
    const Description* own = kind.description();
    const auto all = columns_of(kind);
    if (own != nullptr && &column < all.data() + own->own_columns) return true;
    return column.required || column.role != Role::Covariate || std::string_view(column.name) == "t_s";
}

/// As experiment.toml names the kind: a described one by its file, which is beside it.
std::string kind_reference(const Kind& kind) {
    const Description* own = kind.description();
    return own == nullptr ? std::string(kind_name(kind)) : own->file.filename().string();
}

/// What the instruments can report, where that is known.
std::string instrument_lines(const Kind& kind) {
    const Description* own = kind.description();
    if (own == nullptr) {
        const auto usual = kUsualInstrument.find(kind);
        return usual == kUsualInstrument.end() ? "" : fmt::format("# {}\n", usual->second);
    }
    std::string text;
    for (const DescribedObservable& one : own->observables) {
        std::vector<std::string> known;
        if (std::isfinite(one.instrument.floor))
            known.push_back(fmt::format("floor = {:g}", one.instrument.floor));
        if (std::isfinite(one.instrument.ceiling))
            known.push_back(fmt::format("ceiling = {:g}", one.instrument.ceiling));
        if (one.instrument.quantum > 0)
            known.push_back(fmt::format("quantum = {:g}", one.instrument.quantum));
        if (!known.empty())
            text += fmt::format("# {} = {{ {} }}   # as {} has it\n", own->columns[one.column].name,
                                fmt::join(known, ", "), own->file.filename().string());
    }
    return text;
}

/// Numbers of the simulator that this robot may have otherwise.
std::string nominal_lines(const Kind& kind) {
    std::string text;
    if (const Description* own = kind.description())
        for (const DescribedParameter& one : own->parameters)
            text += fmt::format("# \"{}\" = {:g}{}\n", own->full_name(one), one.neutral,
                                one.unit == "1" ? "" : "   # " + one.unit);
    if (kind == Kind::Motion)
        text += "# \"firmware.agenda\" = 0              # wheels keep to their commands (no staircase of "
                "speeds)\n"
                "# \"inverse_friction\" = 0             # no slip at starts; else 1 / friction of tyre and "
                "floor\n";
    return text;
}

std::string column_lines(const Kind& kind) {
    std::size_t width = 0;
    for (const ColumnInfo& column : columns_of(kind))
        width = std::max(width, std::string_view(column.name).size());
    std::string text;
    for (const ColumnInfo& column : columns_of(kind))
        text += fmt::format("# {:<{}}  {:<8} {:<9} {}{}\n", column.name, width, column.unit,
                            kRoles[static_cast<std::size_t>(column.role)],
                            column.required ? "REQUIRED: " : "", column.meaning);
    return text;
}

/// What to vary, from the experiments that tell the kind's causes apart.
std::string advice_lines(const Kind& kind) {
    std::string text;
    for (const Effect* effect : effects_of(kind))
        text += fmt::format("#   {}: {}\n", effect->name, effect->separated_by);
    return text;
}

std::filesystem::path run_file(std::size_t run) {
    return fmt::format("run{}.csv", run + 1);
}

}  // namespace

std::string new_experiment_toml(const Kind& kind, std::size_t runs) {
    const auto& first = columns_of(kind).front();
    std::string text =
        fmt::format("# A measured experiment of kind {0}, for `puckloop gap`. Fill in the CSV files, then\n"
                    "#     puckloop gap check DIR            what is wrong or missing, at once\n"
                    "#     puckloop gap DIR --out OUT        the verdict\n\n"
                    "kind = \"{1}\"\n"
                    "title = \"\"                          # one line for the report's head\n"
                    "robot = \"\"                          # which robot: number, revision\n"
                    "# description, source, licence = \"...\" (optional)\n\n",
                    kind_name(kind), kind_reference(kind));
    text += fmt::format(
        "# One CSV file per run: a header line, then one line per row; comma, semicolon or tab; a missing "
        "cell is\n"
        "# empty. Columns that are not needed may be deleted or left empty. All that are understood:\n"
        "#\n{}#\n"
        "# [columns]: only for a column that has another name or unit in the files.\n"
        "[columns]\n"
        "# {} = {{ from = \"name in the file\", unit = \"{}\" }}\n\n",
        column_lines(kind), first.name, first.unit);
    text += "# [instrument]: the range and step of what is read out, where known.\n[instrument]\n";
    text += instrument_lines(kind);
    text +=
        "\n# [nominal]: where this robot is known to differ from the simulator (docs/gap.md).\n[nominal]\n";
    text += nominal_lines(kind) + "\n";
    text += "# Conditions that hold for all runs, in words.\n[conditions]\n# light = \"dark\"\n\n";
    text += fmt::format("# Only runs are independent of each other: record at least four, in random order, "
                        "better ten. What separates\n"
                        "# the causes:\n{}\n",
                        advice_lines(kind));
    for (std::size_t run = 0; run < runs; ++run)
        text +=
            fmt::format("[[run]]\nfile = \"{}\"\n"
                        "order = {}                           # when it was recorded: first, second, ...\n"
                        "# session = \"morning\"                # power-up or day\n"
                        "# conditions = {{ surface = \"white\" }}  # what is special about this run\n\n",
                        run_file(run).string(), run + 1);
    return text;
}

std::string new_csv_header(const Kind& kind) {
    std::string names = "t_s";
    for (const ColumnInfo& column : columns_of(kind))
        if (in_header(kind, column) && std::string_view(column.name) != "t_s")
            names += fmt::format(",{}", column.name);
    return names + "\n";
}

void write_new_folder(const Kind& kind, std::size_t runs, const std::filesystem::path& folder) {
    std::error_code failed;
    for (std::size_t run = 0; run <= runs; ++run) {
        const auto file = folder / (run == runs ? std::filesystem::path("experiment.toml") : run_file(run));
        if (std::filesystem::exists(file, failed))
            throw InputError(file.string(), "", "is there already and would be written over", "a new folder");
    }
    std::filesystem::create_directories(folder, failed);
    if (failed)
        throw InputError(folder.string(), "", "cannot be made: " + failed.message(),
                         "a folder that can be written");
    for (std::size_t run = 0; run < runs; ++run)
        write_file(folder / run_file(run), new_csv_header(kind));
    if (const Description* own = kind.description())
        write_file(folder / own->file.filename(), read_whole_file(own->file).value_or(""));
    write_file(folder / "experiment.toml", new_experiment_toml(kind, runs));
}

}  // namespace puckloop::gap
