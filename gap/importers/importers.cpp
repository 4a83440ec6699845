#include "gap/importers/importers.h"

#include "base/error.h"
#include "base/text/suggest.h"
#include "gap/importers/text_table.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

namespace puckloop::gap::importers {

namespace {

/// InputError where out/folder holds an experiment.toml that this import would not write as it is.
void refuse_edited(const WrittenExperiment& experiment, const std::filesystem::path& out) {
    const std::filesystem::path file = out / experiment.folder / "experiment.toml";
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return;
    std::ifstream stream(file, std::ios::binary);
    const std::string known{std::istreambuf_iterator<char>(stream), {}};
    if (known != experiment_toml(experiment))
        throw InputError(file.string(), "", "is there already, another or edited, and would be written over",
                         "a new folder");
}

}  // namespace

const std::vector<Importer>& importers() {
    static const std::vector<Importer> list{kEpuckBoxBearing, kArgosEpuckRab, kThymioSensors, kOptiodom,
                                            kThymioVicon,     kRohBearing,    kUnifrTiming,   kDensity};
    return list;
}

const Importer& importer_for(const std::filesystem::path& folder, const std::string& set) {
    std::vector<std::string_view> names;
    for (const Importer& importer : importers()) {
        if (!set.empty() && importer.name == set) return importer;
        names.push_back(importer.name);
    }
    if (!set.empty())
        throw InputError("", "", fmt::format("unknown data set \"{}\"{}", set, did_you_mean(set, names)),
                         fmt::format("one of {}", fmt::join(names, ", ")));
    std::error_code ignored;
    if (!std::filesystem::is_directory(folder, ignored))
        throw InputError(folder.string(), "", "is not a folder", "a folder with a published data set");
    for (const Importer& importer : importers())
        if (!paths_like(folder, importer.files).empty()) return importer;
    std::string known;
    for (const Importer& importer : importers())
        known += fmt::format("{}{} ({})", known.empty() ? "" : ", ", importer.name, importer.recognised_by);
    throw InputError(folder.string(), "", "holds no data set known here", known);
}

std::vector<WrittenExperiment> import_set(const std::filesystem::path& folder, const std::string& set,
                                          const std::filesystem::path& out) {
    std::vector<WrittenExperiment> experiments = importer_for(folder, set).read(folder);
    // An importer chosen by --set may find none of its files.
    if (experiments.empty()) throw InputError(folder.string(), "", "holds nothing of this data set");
    for (const WrittenExperiment& experiment : experiments) {
        if (experiment.runs.empty())
            throw InputError(folder.string(), "", fmt::format("holds no run for {}", experiment.folder));
        refuse_edited(experiment, out);
    }
    for (const WrittenExperiment& experiment : experiments)
        write_folder(experiment, out / experiment.folder, 0);
    return experiments;
}

}  // namespace puckloop::gap::importers
