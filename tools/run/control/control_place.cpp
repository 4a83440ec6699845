#include "tools/run/control/control_place.h"

#include "base/error.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <random>

namespace puckloop::tools {

namespace {

namespace fs = std::filesystem;

constexpr const char* kNote = "control.json";

void write_note(const fs::path& note, const nlohmann::json& content) {
    std::ofstream(note) << content.dump() << '\n';
}

}  // namespace

std::string new_control_path() {
    std::random_device source;
    const std::string name = fmt::format("puckloop-{}-{:08x}{:08x}/act", ::getpid(), source(), source());
    const char* runtime = std::getenv("XDG_RUNTIME_DIR");
    std::error_code ignored;
    for (const fs::path& folder : {fs::path(runtime != nullptr ? runtime : ""), fs::path("/tmp")}) {
        const std::string path = (folder / name).string();
        if (folder.is_absolute() && fs::is_directory(folder, ignored) &&
            ::access(folder.c_str(), W_OK) == 0 && path.size() < sizeof(sockaddr_un::sun_path))
            return path;
    }
    return "/tmp/" + name;
}

ControlPlace::ControlPlace(std::string socket, const fs::path& results)
    : socket_(std::move(socket)), note_(results / kNote) {
    std::error_code ignored;
    fs::remove(note_, ignored);
    if (socket_.empty()) return;
    const std::string folder = fs::path(socket_).parent_path().string();
    if (::mkdir(folder.c_str(), S_IRWXU) != 0)
        throw RunError(fmt::format("cannot make {}: {}", folder, std::strerror(errno)));
    write_note(note_, {{"socket", socket_}});
}

ControlPlace::~ControlPlace() {
    if (socket_.empty()) return;
    std::error_code ignored;
    fs::remove(socket_, ignored);
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
    if (note.is_object() && note.value("ended", false)) throw InputError("", run, "the run has ended");
    const auto socket = note.is_object() ? note.find("socket") : note.end();
    if (!note.is_object() || socket == note.end() || !socket->is_string())
        throw InputError((folder / kNote).string(), "", "is damaged", "{\"socket\": \"...\"}");
    return socket->get<std::string>();
}

}  // namespace puckloop::tools
