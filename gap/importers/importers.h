#pragma once
// Importers: one file a published data set, each recognised by its files and turned into experiment folders.
// Values are kept as they were measured; only units and layout change. What an importer had to assume stands
// in the experiment's description.

#include "gap/data/written.h"

#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::gap::importers {

struct Importer {
    const char* name;           ///< for --set and messages
    const char* what;           ///< one line
    const char* recognised_by;  ///< which files, for messages
    const char* files;          ///< of which it has some (paths_like)
    std::vector<WrittenExperiment> (*read)(const std::filesystem::path& folder);
};

const std::vector<Importer>& importers();

/// The importer of that name, or, if `set` is empty, the one that recognises the folder. InputError
/// otherwise.
const Importer& importer_for(const std::filesystem::path& folder, const std::string& set);

/// Reads the set and writes its experiments under `out`. Returns what was written.
std::vector<WrittenExperiment> import_set(const std::filesystem::path& folder, const std::string& set,
                                          const std::filesystem::path& out);

// One a data set; each in a file of that name.
extern const Importer kEpuckBoxBearing;
extern const Importer kArgosEpuckRab;
extern const Importer kThymioSensors;
extern const Importer kOptiodom;
extern const Importer kThymioVicon;
extern const Importer kRohBearing;
extern const Importer kUnifrTiming;
extern const Importer kDensity;

}  // namespace puckloop::gap::importers
