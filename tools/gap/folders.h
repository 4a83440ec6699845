#pragma once
// Where `puckloop gap` writes: whatever fails, fails before the work and leaves what stood there.

#include <filesystem>
#include <string>

namespace puckloop::tools {

/// Makes the folder, clears it of what killed analyses left half written, and tries to write in it.
/// InputError gives the reason where that fails.
void prepare_folder(const std::filesystem::path& folder);

/// InputError where the folder holds an experiment already: measured data is not written over.
void refuse_experiment_in(const std::filesystem::path& folder);

/// InputError where the folder holds anything that a made experiment does not (experiment.toml, run*.csv and
/// folders of such): it would be taken for a case's and be removed.
void refuse_foreign_files(const std::filesystem::path& folder);

/// Beside the file under another name; `put_in_place` makes it the file, so that a full disk or a kill leaves
/// the old one whole.
void write_beside(const std::filesystem::path& file, const std::string& text);
void put_in_place(const std::filesystem::path& file);
std::filesystem::path beside(const std::filesystem::path& file);

}  // namespace puckloop::tools
