// Files that are of the network on the board, and not the host's: /etc/hosts, /etc/resolv.conf, /proc/net.
// Where a fault is about names, /etc/hosts does not have those of other computers.

#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/network/sockets.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <arpa/inet.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstring>
#include <string>

namespace puckloop::shim {

namespace {

std::string hosts_text() {
    std::string text = "127.0.0.1\tlocalhost\n";
    for (std::uint32_t i = 0; i < page().host_count; ++i) {
        if (page().asks_for_names != 0 && page().hosts[i].address != page().network_address) continue;
        char number[INET_ADDRSTRLEN];
        const in_addr address{htonl(page().hosts[i].address)};
        inet_ntop(AF_INET, &address, number, sizeof number);
        text += std::string(number) + "\t" + page().hosts[i].name + "\n";
    }
    return text;
}

/// A table of the kernel's, asked for at a socket of this library's own.
std::string table_text(wire::NetworkTable table) {
    wire::Request request;
    request.op = wire::Op::Socket;
    request.handle = static_cast<int>(device_call(request));
    if (request.handle < 0) return "";
    request.op = wire::Op::GetOption;
    request.a = wire::kNetworkTables;
    request.b = static_cast<std::uint32_t>(table);
    std::string text(wire::kMaximumData, '\0');
    std::size_t size = 0;
    device_call(request, nullptr, 0, text.data(), text.size(), false, &size);
    text.resize(size);
    request.op = wire::Op::Close;
    device_call(request);
    return text;
}

bool make_text(const char* path, std::string& text) {
    if (std::strcmp(path, "/etc/hosts") == 0)
        text = hosts_text();
    else if (std::strcmp(path, "/etc/resolv.conf") == 0)
        text = "nameserver 127.0.0.53\n";
    else {
        constexpr const char* kFolders[] = {"/proc/net/", "/proc/self/net/"};
        constexpr std::pair<const char*, wire::NetworkTable> kTables[] = {
            {"dev", wire::NetworkTable::Interfaces},
            {"route", wire::NetworkTable::Routes},
            {"arp", wire::NetworkTable::Neighbours},
            {"tcp", wire::NetworkTable::Streams},
            {"udp", wire::NetworkTable::Datagrams}};
        for (const char* folder : kFolders)
            for (const auto& [name, table] : kTables)
                if (active() && path == std::string(folder) + name) {
                    text = table_text(table);
                    return true;
                }
        return false;
    }
    return true;
}

}  // namespace

int open_network_file(const char* path) {
    if (!is_linked() || page().networked == 0 || !is_text(path) || path[0] != '/') return -1;
    std::string text;
    if ((std::strncmp(path, "/etc/", 5) != 0 && std::strncmp(path, "/proc/", 6) != 0) ||
        !make_text(path, text))
        return -1;
    const int fd = memfd_create(std::strrchr(path, '/') + 1, MFD_CLOEXEC);
    if (fd < 0) return -1;
    const bool written = REAL(write)(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size());
    lseek(fd, 0, SEEK_SET);
    if (written) return fd;
    REAL(close)(fd);
    return -1;
}

}  // namespace puckloop::shim
