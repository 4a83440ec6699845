#include "gap/begin/new_folder.h"

#include "base/error.h"
#include "base/text_file.h"
#include "gap/data/columns.h"
#include "gap/data/written.h"
#include "gap/effects/effect.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>

namespace puckloop::gap {

namespace {

constexpr const char* kRoles[] = {"measured", "truth", "set up", "noted"};  // in the order of Role

/// What an instrument of the kind can report, as an example, where there is a usual one.
const std::map<Kind, const char*> kUsualInstrument{
    {Kind::Proximity, "reading = { floor = 0, ceiling = 4095, quantum = 1 }"},
    {Kind::Ground, "reading = { floor = 0, ceiling = 1023, quantum = 1 }"},
    {Kind::Microphone, "level = { floor = 0, quantum = 1 }"},
    {Kind::Motion, "x_m = { quantum = 0.0001 }   # step between two values that the tracker reports, m"},
    {Kind::Accelerometer, "ax = { floor = 0, ceiling = 4095, quantum = 1 }"}};

bool in_header(const ColumnInfo& column) {
    return column.required || column.role != Role::Covariate || std::string_view(column.name) == "t_s";
}

std::string column_lines(Kind kind) {
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
std::string advice_lines(Kind kind) {
    std::string text;
    for (const Effect* effect : effects_of(kind))
        text += fmt::format("#   {}: {}\n", effect->name, effect->separated_by);
    return text;
}

std::filesystem::path run_file(std::size_t run) {
    return fmt::format("run{}.csv", run + 1);
}

}  // namespace

std::string new_experiment_toml(Kind kind, std::size_t runs) {
    const auto& first = columns_of(kind).front();
    std::string text =
        fmt::format("# A measured experiment of kind {0}, for `puckloop gap`. Fill in the CSV files, then\n"
                    "#     puckloop gap check DIR            what is wrong or missing, at once\n"
                    "#     puckloop gap DIR --out OUT        the verdict\n\n"
                    "kind = \"{0}\"\n"
                    "title = \"\"                          # one line for the report's head\n"
                    "robot = \"\"                          # which robot: number, revision\n"
                    "# description, source, licence = \"...\" (optional)\n\n",
                    kind_name(kind));
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
    if (const auto usual = kUsualInstrument.find(kind); usual != kUsualInstrument.end())
        text += fmt::format("# {}\n", usual->second);
    text +=
        "\n# [nominal]: where this robot is known to differ from the simulator (docs/gap.md).\n[nominal]\n";
    if (kind == Kind::Motion)
        text += "# \"firmware.agenda\" = 0              # wheels keep to their commands (no staircase of "
                "speeds)\n"
                "# \"inverse_friction\" = 0             # no slip at starts; else 1 / friction of tyre and "
                "floor\n";
    text += "\n";
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

std::string new_csv_header(Kind kind) {
    std::string names = "t_s";
    for (const ColumnInfo& column : columns_of(kind))
        if (in_header(column) && std::string_view(column.name) != "t_s")
            names += fmt::format(",{}", column.name);
    return names + "\n";
}

void write_new_folder(Kind kind, std::size_t runs, const std::filesystem::path& folder) {
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
    write_file(folder / "experiment.toml", new_experiment_toml(kind, runs));
}

}  // namespace puckloop::gap
