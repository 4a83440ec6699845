#include "linuxboard/shim/preload/host/link.h"

#include "linuxboard/shim/preload/host/host.h"

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
wire::Channel* own_channel = nullptr;
linuxboard::Patience patience;
constexpr int kNodeGoneStatus = 125;
/// The kernel ends this process with the node (PR_SET_PDEATHSIG); should that have failed, this finds out.
constexpr std::int64_t kLookForNode = 1'000'000'000;  // ns

struct Host {
    static long call(long number, long a, long b, long c, long d, long e, long f) {
        return host_call(number, a, b, c, d, e, f);
    }
    static std::int64_t nanoseconds() { return host_nanoseconds(); }
};

[[noreturn]] void give_up(const char* what, int error) {
    char text[160];
    std::snprintf(text, sizeof text, "puckloop shim: %s%s%s\n", what, error != 0 ? ": " : "",
                  error != 0 ? std::strerror(error) : "");
    host_complain(text);
    host_call(SYS_exit_group, kNodeGoneStatus);
    __builtin_unreachable();
}

bool node_is_gone() {
    char byte = 0;
    return host_call(SYS_recvfrom, socket_fd, reinterpret_cast<long>(&byte), sizeof byte,
                     MSG_PEEK | MSG_DONTWAIT) == 0;
}

/// Hands the turn to the node and waits until it comes back.
void ask_node() {
    using linuxboard::Turn;
    Turn& turn = channel().turn;
    turn.pass<Host>(Turn::Node);
    while (!turn.await<Host>(Turn::Program, patience, kLookForNode))
        if (node_is_gone()) give_up("the run is gone", 0);
}

void put_request(const wire::Request& request, const void* data, std::size_t size) {
    wire::Channel& link = channel();
    link.request = request;
    link.request_size = static_cast<std::uint32_t>(std::min<std::size_t>(size, wire::kMaximumData));
    if (size > 0) std::memcpy(link.request_data, data, link.request_size);
}

/// The descriptor that goes with the reply to Fork.
void receive_descriptor() {
    char byte = 0;
    iovec part{&byte, sizeof byte};
    alignas(cmsghdr) char control[CMSG_SPACE(sizeof(int))];
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control;
    message.msg_controllen = sizeof control;
    long count = -1;
    do {
        count = host_call(SYS_recvmsg, socket_fd, reinterpret_cast<long>(&message));
    } while (count < 0 && errno == EINTR);
    const cmsghdr* header = count > 0 ? CMSG_FIRSTHDR(&message) : nullptr;
    if (header == nullptr || header->cmsg_type != SCM_RIGHTS)
        give_up("no link for a new process", count < 0 ? errno : 0);
    std::memcpy(&passed_fd, CMSG_DATA(header), sizeof passed_fd);
}
}  // namespace

wire::Page& page() {
    return *shared_page;
}

wire::Channel& channel() {
    return *own_channel;
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

void* map_shared(void* address, std::size_t length, int protection, int flags, std::uint64_t offset) {
    return reinterpret_cast<void*>(host_call(SYS_mmap, reinterpret_cast<long>(address),
                                             static_cast<long>(length), protection, flags, page_fd,
                                             static_cast<long>(offset)));
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

static void use_slot(std::uint32_t slot) {
    slot_index = slot;
    own_channel = wire::channel_of(page(), slot);
}

void change_link(int socket, std::uint32_t slot) {
    place_link(socket);
    use_slot(slot);
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
    void* mapped = mmap(nullptr, wire::kSharedSize, PROT_READ | PROT_WRITE, MAP_SHARED, page_fd, 0);
    if (mapped == MAP_FAILED) refuse("the descriptors of the link to the run were closed: not run");
    shared_page = static_cast<wire::Page*>(mapped);
    if (shared_page->version != wire::kVersion) return false;
    use_slot(slot);
    const auto process = static_cast<std::int32_t>(host_call(SYS_getpid));
    if (own().host == 0) own().host = process;
    if (own().host != process)
        refuse("a child process that was not made by fork(), posix_spawn(), system() or popen(): not run");
    return true;
}

void send_only(const wire::Request& request) {
    put_request(request, nullptr, 0);
    channel().turn.pass<Host>(linuxboard::Turn::Node);
}

void exchange(const wire::Request& request, const void* data, std::size_t size, wire::Reply& reply,
              Completed completed) {
    const int saved_errno = errno;
    put_request(request, data, size);
    do {
        ask_node();
        reply = channel().reply;
        const char* cursor = channel().reply_data;
        for (std::uint32_t i = 0; i < reply.count; ++i) {
            wire::Completion completion;
            std::memcpy(&completion, cursor, sizeof completion);
            cursor += sizeof completion;
            const bool has_descriptor = request.op == wire::Op::Fork && completion.error == 0;
            if (has_descriptor && completion.thread == request.thread) receive_descriptor();
            completed(completion, cursor);
            cursor += completion.length;
        }
    } while (reply.more != 0);
    errno = saved_errno;
}

}  // namespace puckloop::shim
