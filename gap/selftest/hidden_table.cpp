#include "gap/selftest/hidden_table.h"

#include "base/csv.h"
#include "base/error.h"

#include <fmt/format.h>

#include <fstream>

namespace puckloop::gap::selftest {

namespace {

void write_text(const std::filesystem::path& file, const std::string& text) {
    std::ofstream out(file);
    out << text;
    if (!out.flush()) throw RunError(file.string() + ": cannot be written");
}

std::string csv_of(const HiddenRun& run) {
    std::vector<CsvColumn> columns;
    for (const HiddenColumn& column : run.columns)
        columns.push_back({column.name, column.values});
    return csv_text(columns, 9);
}

}  // namespace

HiddenColumn& HiddenRun::column(std::string_view name, std::string_view unit) {
    for (HiddenColumn& known : columns)
        if (known.name == name) return known;
    columns.push_back({std::string(name), std::string(unit), {}});
    return columns.back();
}

const HiddenColumn* HiddenRun::find(std::string_view name) const {
    for (const HiddenColumn& known : columns)
        if (known.name == name) return &known;
    return nullptr;
}

void write_folder(const HiddenExperiment& experiment, const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    std::string toml =
        fmt::format("kind = \"{}\"\ntitle = \"bench test\"\nrobot = \"e-puck\"\n", experiment.kind);
    if (!experiment.nominal.empty()) toml += "\n[nominal]\n";
    for (const auto& [key, value] : experiment.nominal)
        toml += fmt::format("\"{}\" = {}\n", key, value);
    if (!experiment.instrument.empty()) toml += "\n[instrument]\n";
    for (const auto& [key, value] : experiment.instrument)
        toml += fmt::format("{} = {}\n", key, value);
    toml += "\n[columns]\n";
    for (const HiddenColumn& column : experiment.runs.front().columns)
        toml += fmt::format("{} = \"{}\"\n", column.name, column.unit);
    for (std::size_t k = 0; k < experiment.runs.size(); ++k) {
        const std::string file = fmt::format("run{:02}.csv", k + 1);
        toml += fmt::format("\n[[run]]\nfile = \"{}\"\n", file);
        std::string conditions;
        for (const auto& [key, value] : experiment.runs[k].conditions)
            conditions += fmt::format("{}{} = \"{}\"", conditions.empty() ? "" : ", ", key, value);
        if (!conditions.empty()) toml += fmt::format("conditions = {{ {} }}\n", conditions);
        write_text(folder / file, csv_of(experiment.runs[k]));
    }
    write_text(folder / "experiment.toml", toml);
}

}  // namespace puckloop::gap::selftest
