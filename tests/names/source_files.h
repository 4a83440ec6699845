#pragma once
// The project's own files, as the checks of words and of docs read them.

#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::names {

struct SourceFile {
    std::string path;  ///< relative to the project's folder, with '/'
    std::vector<std::string> lines;
    /// Whether its name ends so.
    bool ends_with(std::string_view end) const { return path.ends_with(end); }
    /// Whether it is in this folder, or in one below.
    bool in(std::string_view folder) const { return path.starts_with(std::string(folder) + "/"); }
};

/// Every file of code, build and docs, sorted by path; builds, results and hidden folders left out.
std::vector<SourceFile> source_files();

/// The string literals of a line, one after the other, without their quotes. A line that is a comment, or
/// includes a header, has none.
std::vector<std::string> literals(const std::string& line);

/// What a line has behind "//", outside literals; empty: no comment.
std::string comment(const std::string& line);

}  // namespace puckloop::names
