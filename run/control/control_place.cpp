#include "run/control/control_place.h"

#include "base/error.h"
#include "base/files/text_file.h"
#include "base/json.h"
#include "run/control/control_socket.h"

#include <fmt/format.h>

#include <signal.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::tools {

namespace {

namespace fs = std::filesystem;

constexpr const char* kNote = "control.json";
constexpr const char* kFolder = "puckloop-";
constexpr const char* kSocket = "act";
constexpr const char* kClientSocket = "control";
constexpr const char* kJoinedSocket = "join";  // and its port

/// The socket that a note names; empty: none, or not one that new_control_path() could have made.
std::string socket_in(const nlohmann::json& note) {
    const auto found = note.is_object() ? note.find("socket") : note.end();
    if (found == note.end() || !found->is_string()) return {};
    const fs::path socket(found->get<std::string>());
    const bool ours = socket.is_absolute() && socket.filename() == kSocket &&
                      socket.parent_path().filename().string().starts_with(kFolder) &&
                      socket.native().size() < sizeof(sockaddr_un::sun_path);
    return ours ? socket.string() : std::string();
}

/// Of a run that was killed: its socket and the private folder around it.
void remove_left_over(const fs::path& note) {
    std::ifstream file(note);
    const std::string socket = socket_in(nlohmann::json::parse(file, nullptr, false));
    if (socket.empty() || !is_left_over(socket)) return;
    std::error_code ignored;
    fs::remove(socket, ignored);
    fs::remove(client_socket_beside(socket), ignored);
    fs::remove(fs::path(socket).parent_path(), ignored);
}

bool is_dead(pid_t process) {
    return ::kill(process, 0) != 0 && errno == ESRCH;
}

/// Of a private folder's name, "puckloop-PROCESS-TOKEN"; none: it is another folder's.
std::optional<pid_t> maker_of(std::string_view name) {
    constexpr std::string_view kBegin = "puckloop-", kDigits = "0123456789";
    constexpr std::size_t kLongestNumber = 9, kToken = 16;
    if (!name.starts_with(kBegin)) return std::nullopt;
    name.remove_prefix(kBegin.size());
    const std::size_t digits = std::min(name.find('-'), name.size());
    if (digits == 0 || digits > kLongestNumber || name.size() != digits + 1 + kToken ||
        name.substr(0, digits).find_first_not_of(kDigits) != name.npos ||
        name.substr(digits + 1).find_first_not_of("0123456789abcdef") != name.npos)
        return std::nullopt;
    return std::stoi(std::string(name.substr(0, digits)));
}

/// Private folders of runs that were killed, wherever their results are: this user's, of a process that is
/// gone, with nothing in them but sockets that nobody listens to.
void remove_left_over_folders(const fs::path& place) {
    std::error_code failed;
    std::vector<fs::path> left;
    for (fs::directory_iterator at(place, failed), end; !failed && at != end; at.increment(failed)) {
        const std::optional<pid_t> maker = maker_of(at->path().filename().string());
        if (maker && is_dead(*maker)) left.push_back(at->path());
    }
    for (const fs::path& folder : left) {
        struct stat status {};
        if (::lstat(folder.c_str(), &status) != 0 || !S_ISDIR(status.st_mode) || status.st_uid != ::geteuid())
            continue;
        std::vector<fs::path> sockets{folder / kSocket, folder / kClientSocket};
        for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed))
            if (at->path().filename().string().starts_with(kJoinedSocket)) sockets.push_back(at->path());
        const auto heard = [&](const fs::path& socket) {
            return fs::exists(fs::symlink_status(socket, failed)) && !is_left_over(socket.string());
        };
        if (std::any_of(sockets.begin(), sockets.end(), heard)) continue;
        for (const fs::path& socket : sockets)
            fs::remove(socket, failed);
        fs::remove(folder, failed);  // not if there is anything else in it
    }
}

/// Where new_control_path() makes folders.
std::vector<fs::path> places() {
    const char* runtime = std::getenv("XDG_RUNTIME_DIR");
    return {fs::path(runtime != nullptr ? runtime : ""), fs::path("/tmp")};
}

void write_note(const fs::path& note, const nlohmann::json& content) {
    write_file(note, content.dump() + "\n");
}

}  // namespace

std::string new_control_path() {
    std::random_device source;
    const std::string name =
        fmt::format("{}{}-{:08x}{:08x}/{}", kFolder, ::getpid(), source(), source(), kSocket);
    std::error_code ignored;
    for (const fs::path& folder : places()) {
        const std::string path = (folder / name).string();
        if (folder.is_absolute() && fs::is_directory(folder, ignored) &&
            ::access(folder.c_str(), W_OK) == 0 && path.size() < sizeof(sockaddr_un::sun_path))
            return path;
    }
    return "/tmp/" + name;
}

std::string joined_socket_beside(const std::string& socket, unsigned port) {
    return (fs::path(socket).parent_path() / fmt::format("{}{}", kJoinedSocket, port)).string();
}

std::string client_socket_beside(const std::string& socket) {
    return (fs::path(socket).parent_path() / kClientSocket).string();
}

ControlPlace::ControlPlace(std::string socket, const fs::path& results)
    : socket_(std::move(socket)), note_(results / kNote) {
    std::error_code ignored;
    remove_left_over(note_);
    for (const fs::path& place : places())
        if (place.is_absolute()) remove_left_over_folders(place);
    fs::remove(note_, ignored);
    if (socket_.empty()) return;
    const std::string folder = fs::path(socket_).parent_path().string();
    if (::mkdir(folder.c_str(), S_IRWXU) != 0)
        throw RunError(fmt::format("cannot make {}: {}", folder, std::strerror(errno)));
    write_note(note_, nlohmann::json::object({{"socket", socket_}}));
}

void ControlPlace::name_client_socket() {
    write_note(note_, {{"socket", socket_}, {"control", client_socket_beside(socket_)}});
}

ControlPlace::~ControlPlace() {
    if (socket_.empty()) return;
    std::error_code ignored;
    fs::remove(socket_, ignored);
    fs::remove(client_socket_beside(socket_), ignored);
    fs::remove(fs::path(socket_).parent_path(), ignored);
    try {
        write_note(note_, {{"ended", true}});
    } catch (const std::exception&) {  // no place on the disk: the socket is gone all the same
    }
}

std::string control_path_of(const std::string& run) {
    std::error_code ignored;
    fs::path folder(run);
    if (!fs::is_directory(folder, ignored)) folder = fs::path("out") / run;
    if (!fs::is_directory(folder, ignored))
        throw InputError("", run, "there is no such run", "its results folder, or its name in out/");
    std::ifstream file(folder / kNote);
    if (!file) throw InputError("", run, "takes no commands", "a run started with --realtime or --paced");
    const auto note = nlohmann::json::parse(file, nullptr, false);
    if (note.is_object() && note.contains("ended") && note["ended"] == true)
        throw InputError("", run, "the run has ended");
    const std::string socket = socket_in(note);
    if (socket.empty())
        throw InputError((folder / kNote).string(), "", "is damaged", "{\"socket\": \"...\"}");
    return socket;
}

}  // namespace puckloop::tools
