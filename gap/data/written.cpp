#include "gap/data/written.h"

#include "base/error.h"
#include "base/files/text_file.h"
#include "base/text/csv.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <ranges>

namespace puckloop::gap {

namespace {

std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += c == '\n' ? ' ' : c;
    }
    return out + "\"";
}

std::string toml_number(double value) {
    std::string text = fmt::format("{}", value);
    if (text.find_first_of(".en") == std::string::npos) text += ".0";
    return text;
}

std::string instrument_line(const WrittenInstrument& instrument) {
    std::vector<std::string> fields;
    if (std::isfinite(instrument.floor)) fields.push_back("floor = " + toml_number(instrument.floor));
    if (std::isfinite(instrument.ceiling)) fields.push_back("ceiling = " + toml_number(instrument.ceiling));
    if (instrument.quantum > 0) fields.push_back("quantum = " + toml_number(instrument.quantum));
    if (fields.empty()) return {};
    return fmt::format("{} = {{ {} }}\n", instrument.column, fmt::join(fields, ", "));
}

std::string file_of(const WrittenRun& run, std::size_t index) {
    return (run.name.empty() ? fmt::format("run{:02}", index + 1) : run.name) + ".csv";
}

std::string run_text(const WrittenRun& run, std::size_t index) {
    std::string text = "\n[[run]]\n";
    if (!run.name.empty()) text += fmt::format("name = {}\n", quoted(run.name));
    text += fmt::format("file = {}\n", quoted(file_of(run, index)));
    if (!run.session.empty()) text += fmt::format("session = {}\n", quoted(run.session));
    for (const auto& [name, value] : run.constants)
        text += fmt::format("{} = {}\n", name, toml_number(value));
    std::vector<std::string> fields;
    for (const auto& [name, value] : run.conditions)
        fields.push_back(fmt::format("{} = {}", name, quoted(value)));
    return fields.empty() ? text : text + fmt::format("conditions = {{ {} }}\n", fmt::join(fields, ", "));
}

}  // namespace

WrittenColumn& WrittenRun::column(std::string_view wanted, std::string_view unit) {
    for (WrittenColumn& known : columns)
        if (known.name == wanted) return known;
    columns.push_back({std::string(wanted), {}, std::string(unit)});
    return columns.back();
}

void WrittenRun::row(std::initializer_list<std::pair<const char*, double>> cells) {
    for (const auto& [column_name, value] : cells)
        column(column_name, "").values.push_back(value);
}

const WrittenColumn* WrittenRun::find(std::string_view wanted) const {
    for (const WrittenColumn& known : columns)
        if (known.name == wanted) return &known;
    return nullptr;
}

std::string experiment_toml(const WrittenExperiment& e) {
    std::string text =
        fmt::format("kind = {}\n", quoted(e.kind_file.empty() ? e.kind : e.kind_file.filename().string()));
    const std::pair<const char*, const std::string&> texts[] = {{"title", e.title},
                                                                {"robot", e.robot},
                                                                {"description", e.description},
                                                                {"source", e.source},
                                                                {"licence", e.licence}};
    for (const auto& [key, value] : texts)
        if (!value.empty()) text += fmt::format("{} = {}\n", key, quoted(value));
    if (e.brief) text += "brief = true\n";
    if (!e.assumed.empty())
        text += fmt::format("assumed = [{}]\n", fmt::join(e.assumed | std::views::transform(quoted), ", "));
    if (!e.nominal.empty()) text += "\n[nominal]\n";
    for (const auto& [name, value] : e.nominal)
        text += fmt::format("{} = {}\n", quoted(name), toml_number(value));
    if (!e.instruments.empty()) text += "\n[instrument]\n";
    for (const WrittenInstrument& instrument : e.instruments)
        text += instrument_line(instrument);
    std::string units;
    for (const WrittenColumn& column : e.runs.front().columns)
        if (!column.unit.empty()) units += fmt::format("{} = {}\n", column.name, quoted(column.unit));
    if (!units.empty()) text += "\n[columns]\n" + units;
    for (std::size_t k = 0; k < e.runs.size(); ++k)
        text += run_text(e.runs[k], k);
    return text;
}

void write_folder(const WrittenExperiment& experiment, const std::filesystem::path& folder, int digits) {
    make_folder(folder);
    for (std::size_t k = 0; k < experiment.runs.size(); ++k) {
        std::vector<CsvColumn> columns;
        for (const WrittenColumn& column : experiment.runs[k].columns)
            columns.push_back({column.name, column.values});
        write_file(folder / file_of(experiment.runs[k], k), csv_text(columns, digits));
    }
    if (!experiment.kind_file.empty()) {
        const auto text = read_whole_file(experiment.kind_file);
        if (!text)
            throw RunError(experiment.kind_file.string() +
                           ": cannot be read, to be copied beside experiment.toml");
        write_file(folder / experiment.kind_file.filename(), *text);
    }
    write_file(folder / "experiment.toml", experiment_toml(experiment));
}

}  // namespace puckloop::gap
