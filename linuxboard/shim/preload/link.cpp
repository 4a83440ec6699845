#include "linuxboard/shim/preload/link.h"

#include "linuxboard/shim/preload/host.h"

#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace puckloop::shim {

namespace {
int socket_fd = -1;
int page_fd = -1;
std::uint32_t slot_index = 0;
int passed_fd = -1;
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

int link_descriptors() {
    return std::max(socket_fd, page_fd) + 1;
}

std::uint32_t own_slot() {
    return slot_index;
}

int take_passed() {
    const int fd = passed_fd;
    passed_fd = -1;
    return fd;
}

void print_link(char* text, std::size_t size, std::uint32_t slot) {
    std::snprintf(text, size, "%d,%d,%u", socket_fd, page_fd, slot);
}

void place_link(int socket) {
    host_call(SYS_dup3, socket, socket_fd, 0);
    host_call(SYS_close, socket);
}

void change_link(int socket, std::uint32_t slot) {
    place_link(socket);
    slot_index = slot;
    own().host = static_cast<std::int32_t>(host_call(SYS_getpid));
}

[[noreturn]] void refuse(const char* text) {
    char line[400];
    std::snprintf(line, sizeof line, "puckloop shim: %s\n", text);
    host_complain(line);
    host_call(SYS_exit_group, wire::kRefusedStatus);
    __builtin_unreachable();
}

bool connect_link() {
    const char* text = std::getenv(wire::kLinkVariable);
    if (text == nullptr) return false;
    unsigned slot = 0;
    if (std::sscanf(text, "%d,%d,%u", &socket_fd, &page_fd, &slot) != 3 || slot >= wire::kMaximumProcesses)
        return false;
    void* mapped = mmap(nullptr, sizeof(wire::Page), PROT_READ | PROT_WRITE, MAP_SHARED, page_fd, 0);
    if (mapped == MAP_FAILED) refuse("the descriptors of the link to the run were closed: not run");
    shared_page = static_cast<wire::Page*>(mapped);
    if (shared_page->version != wire::kVersion) return false;
    slot_index = slot;
    const auto process = static_cast<std::int32_t>(host_call(SYS_getpid));
    if (own().host == 0) own().host = process;
    if (own().host != process)
        refuse("a child process that was not made by fork(), posix_spawn(), system() or popen(): not run");
    return true;
}

/// Like recv(), and keeps the descriptor that may come along.
long receive_reply() {
    iovec part{reply_buffer, sizeof reply_buffer};
    alignas(cmsghdr) char control[CMSG_SPACE(sizeof(int))];
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control;
    message.msg_controllen = sizeof control;
    const long count = host_call(SYS_recvmsg, socket_fd, reinterpret_cast<long>(&message));
    const cmsghdr* header = count > 0 ? CMSG_FIRSTHDR(&message) : nullptr;
    if (header != nullptr && header->cmsg_type == SCM_RIGHTS)
        std::memcpy(&passed_fd, CMSG_DATA(header), sizeof passed_fd);
    return count;
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
        count = request.op == wire::Op::Fork
                    ? receive_reply()
                    : host_call(SYS_recvfrom, socket_fd, reinterpret_cast<long>(reply_buffer),
                                sizeof reply_buffer);
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
