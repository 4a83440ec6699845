#pragma once
// A folder for results: what a user keeps in it is not written over. A file in it, the mark, lists what is
// puckloop's: one name per line, of files or folders; "./NAME" is one that the next run leaves there.

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop {

/// Makes `folder`, and adds `names` to its `mark`, so that they are puckloop's to write over. InputError as
/// refuse_foreign_results(), or if the folder cannot be made or written.
void claim_folder(const std::filesystem::path& folder, const std::string& mark,
                  const std::vector<std::string>& names);

/// The check alone: InputError for the first of `names` that is a link, that is there although the mark does
/// not list it, or that has a second name (a hard link) whose file would be written over; and if the mark
/// itself is no plain file or has a second name.
void refuse_foreign_results(const std::filesystem::path& folder, const std::string& mark,
                            const std::vector<std::string>& names);

/// Whether all that is in `folder` is its mark and what that lists.
bool holds_only_results(const std::filesystem::path& folder, const std::string& mark);

/// InputError for what is there at `folder` and would be lost if it were emptied for a run's results: a file,
/// a link, a folder with other things. `expected`: what to give in its place.
void refuse_to_empty(const std::filesystem::path& folder, const std::string& mark, std::string_view expected);

/// Names in the text of a mark, without "./".
std::set<std::string> listed_names(const std::string& text);

/// The text of a mark; empty if there is none. InputError as refuse_foreign_results() for the mark.
std::string read_mark(const std::filesystem::path& folder, const std::string& mark);

}  // namespace puckloop
