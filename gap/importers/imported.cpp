#include "gap/importers/imported.h"

#include "base/csv.h"
#include "base/error.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <system_error>

namespace puckloop::gap::importers {

namespace {

void write_text(const std::filesystem::path& file, const std::string& text) {
    std::ofstream stream(file, std::ios::binary);
    stream << text;
    stream.close();
    if (!stream) throw RunError(fmt::format("{}: cannot be written", file.string()));
}

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

std::string csv_of(const ImportedRun& run) {
    std::vector<CsvColumn> columns;
    for (const auto& [name, values] : run.columns)
        columns.push_back({name, values});
    return csv_text(columns);
}

std::string instrument_line(const ImportedInstrument& instrument) {
    std::string fields;
    const auto add = [&](const char* name, double value) {
        fields += fmt::format("{}{} = {}", fields.empty() ? "" : ", ", name, toml_number(value));
    };
    if (std::isfinite(instrument.floor)) add("floor", instrument.floor);
    if (std::isfinite(instrument.ceiling)) add("ceiling", instrument.ceiling);
    if (instrument.quantum > 0) add("quantum", instrument.quantum);
    return fmt::format("{} = {{ {} }}\n", instrument.column, fields);
}

std::string toml_of(const ImportedExperiment& e) {
    std::string text = fmt::format("kind = {}\n", quoted(e.kind));
    const std::pair<const char*, const std::string&> texts[] = {{"title", e.title},
                                                                {"robot", e.robot},
                                                                {"description", e.description},
                                                                {"source", e.source},
                                                                {"licence", e.licence}};
    for (const auto& [key, value] : texts)
        if (!value.empty()) text += fmt::format("{} = {}\n", key, quoted(value));
    std::string assumed;
    for (const std::string& name : e.assumed)
        assumed += (assumed.empty() ? "" : ", ") + quoted(name);
    if (!assumed.empty()) text += fmt::format("assumed = [{}]\n", assumed);
    if (!e.nominal.empty()) text += "\n[nominal]\n";
    for (const auto& [name, value] : e.nominal)
        text += fmt::format("{} = {}\n", quoted(name), toml_number(value));
    if (!e.instruments.empty()) text += "\n[instrument]\n";
    for (const ImportedInstrument& instrument : e.instruments)
        text += instrument_line(instrument);
    for (const ImportedRun& run : e.runs) {
        text += fmt::format("\n[[run]]\nname = {}\nfile = {}\n", quoted(run.name), quoted(run.name + ".csv"));
        if (!run.session.empty()) text += fmt::format("session = {}\n", quoted(run.session));
        for (const auto& [name, value] : run.constants)
            text += fmt::format("{} = {}\n", name, toml_number(value));
        std::string fields;
        for (const auto& [name, value] : run.conditions)
            fields += fmt::format("{}{} = {}", fields.empty() ? "" : ", ", name, quoted(value));
        if (!fields.empty()) text += fmt::format("conditions = {{ {} }}\n", fields);
    }
    return text;
}

}  // namespace

void refuse_edited(const ImportedExperiment& experiment, const std::filesystem::path& out) {
    const std::filesystem::path file = out / experiment.folder / "experiment.toml";
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return;
    std::ifstream stream(file, std::ios::binary);
    const std::string known{std::istreambuf_iterator<char>(stream), {}};
    if (known != toml_of(experiment))
        throw InputError(file.string(), "", "is there already, another or edited, and would be written over",
                         "a new folder");
}

void write_experiment(const ImportedExperiment& experiment, const std::filesystem::path& out) {
    const std::filesystem::path folder = out / experiment.folder;
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw RunError(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
    for (const ImportedRun& run : experiment.runs)
        write_text(folder / (run.name + ".csv"), csv_of(run));
    write_text(folder / "experiment.toml", toml_of(experiment));
}

}  // namespace puckloop::gap::importers
