#include "gap/importers/importers.h"

#include "base/error.h"
#include "base/suggest.h"

#include <fmt/format.h>

#include <filesystem>

namespace puckloop::gap::importers {

const std::vector<Importer>& importers() {
    static const std::vector<Importer> list{kEpuckBoxBearing, kArgosEpuckRab, kThymioSensors, kOptiodom,
                                            kThymioVicon,     kRohBearing,    kUnifrTiming};
    return list;
}

const Importer& importer_for(const std::filesystem::path& folder, const std::string& set) {
    std::vector<std::string_view> names;
    for (const Importer& importer : importers()) {
        if (!set.empty() && importer.name == set) return importer;
        names.push_back(importer.name);
    }
    if (!set.empty()) {
        const std::string near = nearest_name(set, names);
        throw InputError("", "", fmt::format("unknown data set \"{}\"", set),
                         near.empty() ? fmt::format("one of {}", fmt::join(names, ", "))
                                      : fmt::format("did you mean \"{}\"?", near));
    }
    std::error_code ignored;
    if (!std::filesystem::is_directory(folder, ignored))
        throw InputError(folder.string(), "", "is not a folder", "a folder with a published data set");
    for (const Importer& importer : importers())
        if (importer.recognises(folder)) return importer;
    std::string known;
    for (const Importer& importer : importers())
        known += fmt::format("{}{} ({})", known.empty() ? "" : ", ", importer.name, importer.recognised_by);
    throw InputError(folder.string(), "", "holds no data set known here", known);
}

std::vector<ImportedExperiment> import_set(const std::filesystem::path& folder, const std::string& set,
                                           const std::filesystem::path& out) {
    std::vector<ImportedExperiment> experiments = importer_for(folder, set).read(folder);
    // An importer chosen by --set may find none of its files.
    if (experiments.empty()) throw InputError(folder.string(), "", "holds nothing of this data set");
    for (const ImportedExperiment& experiment : experiments) {
        if (experiment.runs.empty())
            throw InputError(folder.string(), "", fmt::format("holds no run for {}", experiment.folder));
        refuse_edited(experiment, out);
    }
    for (const ImportedExperiment& experiment : experiments)
        write_experiment(experiment, out);
    return experiments;
}

}  // namespace puckloop::gap::importers
