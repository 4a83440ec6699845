#include "linuxboard/shim/preload/link.h"

#include "linuxboard/shim/preload/host.h"

#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace puckloop::shim {

namespace {
int socket_fd = -1;
int page_fd = -1;
wire::Page* shared_page = nullptr;
// Replies can complete the calls of several threads at once.
constexpr std::size_t kReplySize = 256 * 1024;
char reply_buffer[kReplySize];
char request_buffer[sizeof(wire::Request) + wire::kMaximumData];
constexpr int kNodeGoneStatus = 125;

[[noreturn]] void give_up(const char* what, int error) {
    char text[160];
    std::snprintf(text, sizeof text, "puckloop shim: %s%s%s\n", what, error != 0 ? ": " : "",
                  error != 0 ? std::strerror(error) : "");
    host_complain(text);
    host_call(SYS_exit_group, kNodeGoneStatus);
    __builtin_unreachable();
}

void send_request(const wire::Request& request, const void* data, std::size_t size) {
    std::memcpy(request_buffer, &request, sizeof request);
    if (size > 0) std::memcpy(request_buffer + sizeof request, data, size);
    const long sent = host_call(SYS_sendto, socket_fd, reinterpret_cast<long>(request_buffer),
                                static_cast<long>(sizeof request + size), MSG_NOSIGNAL);
    if (sent < 0) give_up("cannot ask the run", errno);
}
}  // namespace

wire::Page& page() {
    return *shared_page;
}

bool is_linked() {
    return shared_page != nullptr && shared_page->version == wire::kVersion;
}

bool is_link_descriptor(int fd) {
    return fd >= 0 && (fd == socket_fd || fd == page_fd);
}

bool connect_link() {
    const char* text = std::getenv(wire::kLinkVariable);
    int socket = -1;
    int memory = -1;
    int pid = 0;
    if (text == nullptr || std::sscanf(text, "%d,%d,%d", &socket, &memory, &pid) != 3) return false;
    void* mapped = mmap(nullptr, sizeof(wire::Page), PROT_READ | PROT_WRITE, MAP_SHARED, memory, 0);
    if (mapped == MAP_FAILED) return false;
    shared_page = static_cast<wire::Page*>(mapped);
    if (pid != static_cast<int>(host_call(SYS_getpid))) return false;
    socket_fd = socket;
    page_fd = memory;
    return shared_page->version == wire::kVersion;
}

void send_only(const wire::Request& request) {
    send_request(request, nullptr, 0);
}

void exchange(const wire::Request& request, const void* data, std::size_t size, wire::Reply& reply,
              Completed completed) {
    const int saved_errno = errno;
    send_request(request, data, size);
    long count = -1;
    do {
        count = host_call(SYS_recvfrom, socket_fd, reinterpret_cast<long>(reply_buffer), sizeof reply_buffer);
    } while (count < 0 && errno == EINTR);
    if (count < static_cast<long>(sizeof reply))
        give_up(count == 0 ? "the run is gone" : "no answer from the run", count < 0 ? errno : 0);
    const char* cursor = reply_buffer;
    std::memcpy(&reply, cursor, sizeof reply);
    cursor += sizeof reply;
    for (std::uint32_t i = 0; i < reply.count; ++i) {
        wire::Completion completion;
        std::memcpy(&completion, cursor, sizeof completion);
        cursor += sizeof completion;
        completed(completion, cursor);
        cursor += completion.length;
    }
    errno = saved_errno;
}

}  // namespace puckloop::shim
