#pragma once
// A folder for results: what a user keeps in it is not written over.

#include <filesystem>
#include <string>
#include <vector>

namespace puckloop {

/// Makes `folder`, and in it the file `mark`, which shows that `names` in it are puckloop's to write over.
/// InputError if the folder cannot be made or written, if it has one of the names but no mark, or if one of
/// them is a link. `names` are names of files or folders in it.
void claim_folder(const std::filesystem::path& folder, const std::string& mark,
                  const std::vector<std::string>& names);

/// The check alone: InputError for the first of `names` that is a link, or that is there although the folder
/// has no `mark`.
void refuse_foreign_results(const std::filesystem::path& folder, const std::string& mark,
                            const std::vector<std::string>& names);

}  // namespace puckloop
