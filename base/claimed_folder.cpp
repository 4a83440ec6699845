#include "base/claimed_folder.h"

#include "base/error.h"
#include "base/new_file.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace puckloop {

namespace fs = std::filesystem;

void refuse_foreign_results(const fs::path& folder, const std::string& mark,
                            const std::vector<std::string>& names) {
    std::error_code failed;
    const bool ours = fs::exists(fs::symlink_status(folder / mark, failed));
    for (const std::string& name : names) {
        const fs::path file = folder / name;
        const fs::file_status status = fs::symlink_status(file, failed);
        if (fs::is_symlink(status))
            throw InputError(file.string(), "", why_not_written(ELOOP),
                             "a folder of its own for the results");
        if (!ours && fs::exists(status))
            throw InputError(file.string(), "",
                             fmt::format("is there already, and the folder has no mark of puckloop ({}): it "
                                         "would be written over",
                                         mark),
                             "a folder of its own for the results");
    }
}

void claim_folder(const fs::path& folder, const std::string& mark, const std::vector<std::string>& names) {
    std::error_code failed;
    fs::create_directories(folder, failed);
    if (failed)
        throw InputError(folder.string(), "", "cannot be made: " + failed.message(),
                         "a folder that can be written");
    refuse_foreign_results(folder, mark, names);
    constexpr mode_t kMode = 0666;
    const int descriptor =
        ::open((folder / mark).c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, kMode);
    if (descriptor < 0)
        throw InputError((folder / mark).string(), "", "cannot be written: " + why_not_written(errno),
                         "a folder that can be written");
    ::close(descriptor);
}

}  // namespace puckloop
