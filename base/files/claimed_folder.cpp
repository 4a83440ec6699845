#include "base/files/claimed_folder.h"

#include "base/error.h"
#include "base/files/new_file.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>

namespace puckloop {

namespace fs = std::filesystem;

namespace {

constexpr const char* kOwnFolder = "a folder of its own for the results";

void refuse_second_name(const fs::path& file) {
    std::error_code failed;
    if (!fs::is_regular_file(fs::symlink_status(file, failed))) return;
    const auto names = fs::hard_link_count(file, failed);
    if (!failed && names > 1)
        throw InputError(file.string(), "",
                         "has another name (a hard link), under which it would be written over", kOwnFolder);
}

void write_mark(const fs::path& file, const std::set<std::string>& names) {
    constexpr mode_t kMode = 0666;
    const int descriptor =
        ::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, kMode);
    std::string text;
    for (const std::string& name : names)
        text += name + '\n';
    const bool written =
        descriptor >= 0 && ::ftruncate(descriptor, 0) == 0 &&
        ::pwrite(descriptor, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size());
    const int reason = errno;
    if (descriptor >= 0) ::close(descriptor);
    if (!written)
        throw InputError(file.string(), "", "cannot be written: " + why_not_written(reason),
                         "a folder that can be written");
}

}  // namespace

void refuse_to_empty(const fs::path& folder, const std::string& mark, std::string_view expected) {
    std::error_code failed;
    const fs::file_status there = fs::symlink_status(folder, failed);
    if (!fs::exists(there)) return;
    if (!fs::is_directory(there))
        throw InputError(folder.string(), "", "is no folder, and would be replaced by one", expected);
    if (!holds_only_results(folder, mark))
        throw InputError(folder.string(), "", "holds other things than a run's results, and would be emptied",
                         expected);
}

std::set<std::string> listed_names(const std::string& text) {
    std::set<std::string> names;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        names.insert(line.starts_with("./") ? line.substr(2) : line);
    return names;
}

std::string read_mark(const fs::path& folder, const std::string& mark) {
    const fs::path file = folder / mark;
    std::error_code failed;
    const fs::file_status status = fs::symlink_status(file, failed);
    if (!fs::exists(status)) return {};
    if (!fs::is_regular_file(status))
        throw InputError(file.string(), "", "cannot be opened: is no plain file, as a mark of puckloop is",
                         kOwnFolder);
    refuse_second_name(file);
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

void refuse_foreign_results(const fs::path& folder, const std::string& mark,
                            const std::vector<std::string>& names) {
    std::error_code failed;
    const bool marked = fs::exists(fs::symlink_status(folder / mark, failed));
    const std::set<std::string> ours = listed_names(read_mark(folder, mark));
    for (const std::string& name : names) {
        const fs::path file = folder / name;
        const fs::file_status status = fs::symlink_status(file, failed);
        if (fs::is_symlink(status)) throw InputError(file.string(), "", why_not_written(ELOOP), kOwnFolder);
        if (fs::is_other(status))  // opening a pipe would wait for its reader
            throw InputError(file.string(), "", "is a pipe, a socket or a device, no file", kOwnFolder);
        if (fs::exists(status) && !ours.contains(name))
            throw InputError(
                file.string(), "",
                fmt::format("is there already, and the folder has {}: it would be written over",
                            marked ? fmt::format("a mark of puckloop ({}) that does not list it", mark)
                                   : fmt::format("no mark of puckloop ({})", mark)),
                kOwnFolder);
        refuse_second_name(file);
    }
}

void claim_folder(const fs::path& folder, const std::string& mark, const std::vector<std::string>& names) {
    std::error_code failed;
    fs::create_directories(folder, failed);
    if (failed)
        throw InputError(folder.string(), "", "cannot be made: " + failed.message(),
                         "a folder that can be written");
    refuse_foreign_results(folder, mark, names);
    std::set<std::string> ours = listed_names(read_mark(folder, mark));
    ours.insert(names.begin(), names.end());
    write_mark(folder / mark, ours);
}

bool holds_only_results(const fs::path& folder, const std::string& mark) {
    const std::set<std::string> ours = listed_names(read_mark(folder, mark));
    std::error_code failed;
    const fs::directory_iterator all(folder, failed);
    return std::all_of(begin(all), end(all), [&](const fs::directory_entry& entry) {
        const std::string name = entry.path().filename().string();
        return name == mark || ours.contains(name);
    });
}

}  // namespace puckloop
