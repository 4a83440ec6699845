#include "tools/gap/folders.h"

#include "base/error.h"
#include "base/files/new_file.h"

#include <fmt/format.h>

#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <regex>
#include <system_error>
#include <vector>

namespace puckloop::tools {

namespace fs = std::filesystem;

namespace {

/// What an analysis that was killed left half written: its files and runs carry its process's number.
void remove_rests(const fs::path& folder) {
    static const std::regex kRest(R"((?:[a-z]+\.[a-z]+|puckloop)\.([0-9]{1,9})\.part|rerun\.([0-9]{1,9}))");
    std::error_code failed;
    std::vector<fs::path> rests;
    for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed)) {
        std::smatch found;
        const std::string name = at->path().filename().string();
        if (!std::regex_match(name, found, kRest)) continue;
        const pid_t process = std::stoi(found[1].matched ? found[1] : found[2]);
        if (::kill(process, 0) != 0 && errno == ESRCH) rests.push_back(at->path());
    }
    for (const fs::path& rest : rests)
        fs::remove_all(rest, failed);
}

}  // namespace

void prepare_folder(const fs::path& folder) {
    std::error_code failed;
    if (folder.empty()) throw InputError("", "--out", "is empty", "a folder");
    fs::create_directories(folder, failed);
    if (failed)
        throw InputError(folder.string(), "", "cannot be made: " + failed.message(),
                         "a folder that can be written");
    remove_rests(folder);
    const fs::path trial = folder / fmt::format("puckloop.{}.part", ::getpid());
    errno = 0;
    bool written = false;
    if (std::FILE* const file = new_file(trial); file != nullptr) {
        written = std::fputs("trial", file) >= 0;
        written = std::fclose(file) == 0 && written;
    }
    const int reason = errno;
    fs::remove(trial, failed);
    if (!written)
        throw InputError(folder.string(), "",
                         fmt::format("cannot be written: {}", std::strerror(reason != 0 ? reason : EIO)),
                         "a folder that can be written");
}

void refuse_experiment_in(const fs::path& folder) {
    std::error_code failed;
    const fs::path known = folder / "experiment.toml";
    if (fs::exists(known, failed))
        throw InputError(known.string(), "", "is there already and would be written over", "a new folder");
    static const std::regex kRun(R"(run[0-9]+\.csv)");
    for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed))
        if (std::regex_match(at->path().filename().string(), kRun))
            throw InputError(at->path().string(), "", "is there already and would be written over",
                             "a new folder");
}

void refuse_foreign_files(const fs::path& folder) {
    std::error_code failed;
    for (fs::recursive_directory_iterator at(folder, failed), end; !failed && at != end;
         at.increment(failed)) {
        if (at->is_directory(failed)) continue;
        const std::string name = at->path().filename().string();
        if (name == "experiment.toml" || (name.starts_with("run") && name.ends_with(".csv"))) continue;
        throw InputError(at->path().string(), "", "is no file of a made experiment and would be removed",
                         "a --scratch folder of its own");
    }
}

fs::path beside(const fs::path& file) {
    return fmt::format("{}.{}.part", file.string(), ::getpid());
}

void write_beside(const fs::path& file, const std::string& text) {
    make_new_file(beside(file));
    std::ofstream stream(beside(file), std::ios::binary);
    stream << text;
    stream.close();
    if (!stream)
        throw RunError(
            fmt::format("{}: cannot write: {}", file.string(), std::strerror(errno != 0 ? errno : EIO)));
}

void put_in_place(const fs::path& file) {
    std::error_code failed;
    fs::rename(beside(file), file, failed);
    if (failed) throw RunError(fmt::format("{}: cannot write: {}", file.string(), failed.message()));
}

}  // namespace puckloop::tools
