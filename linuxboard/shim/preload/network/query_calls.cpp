// res_query() and its kin: questions to a name server, which the C library asks by system calls of its own,
// past this library. Here they go to the board's name server as a program's own datagrams do.
//
// Deviations: 1. By UDP alone; what has no room in an answer is cut. 2. The board has no domains to search
// in, so that res_search() asks for the name as it is.

#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/network/sockets.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/wire/interfaces.h"

#include <arpa/nameser.h>
#include <netdb.h>
#include <poll.h>
#include <resolv.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

using namespace puckloop::shim;

namespace {

constexpr int kPatience = 5000, kTries = 2;  // ms; RES_TIMEOUT, RES_DFLRETRY
constexpr int kLongestQuestion = NS_HFIXEDSZ + NS_MAXCDNAME + NS_QFIXEDSZ;

int failed(int error) {
    h_errno = error;
    return -1;
}

/// Answer to the question `id`, or -1: none came.
ssize_t await_answer(int fd, std::uint16_t id, unsigned char* answer, std::size_t room) {
    pollfd one{fd, POLLIN, 0};
    while (poll(&one, 1, kPatience) == 1) {
        const ssize_t size = recv(fd, answer, room, 0);
        if (size < 0) return -1;
        if (size >= NS_HFIXEDSZ && ns_get16(answer) == id) return size;
    }
    return fail(ETIMEDOUT);
}

int exchange(const unsigned char* question, int size, unsigned char* answer, int room) {
    if (size < NS_HFIXEDSZ || room < NS_HFIXEDSZ) return fail(EINVAL);
    const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (fd < 0) return -1;
    sockaddr_in server{};
    server.sin_family = AF_INET;
    server.sin_addr.s_addr = htonl(wire::kResolver);
    server.sin_port = htons(NS_DEFAULTPORT);
    ssize_t got = connect(fd, reinterpret_cast<const sockaddr*>(&server), sizeof server);
    for (int i = 0; got == 0 && i < kTries; ++i) {
        got = send(fd, question, static_cast<std::size_t>(size), 0) < 0 ? -1 : 0;
        if (got < 0) break;
        got = await_answer(fd, static_cast<std::uint16_t>(ns_get16(question)), answer,
                           static_cast<std::size_t>(room));
        if (got < 0 && errno == ETIMEDOUT && i + 1 < kTries) got = 0;
    }
    const int error = errno;
    close(fd);
    errno = error;
    return static_cast<int>(got);
}

/// RFC 1035, 4.1: one question, with recursion desired. 0: the name is none.
int make_question(const char* name, int kind, int type, unsigned char (&question)[kLongestQuestion]) {
    std::memset(question, 0, sizeof question);
    random_bytes(question, NS_INT16SZ);
    constexpr int kFlags = 2, kQuestions = 4;
    question[kFlags] = 1;
    question[kQuestions + 1] = 1;
    int at = NS_HFIXEDSZ;
    while (*name != '\0') {
        const std::size_t length = std::strcspn(name, ".");
        if (length == 0 || length > NS_MAXLABEL ||
            at + static_cast<int>(length) + 2 > NS_HFIXEDSZ + NS_MAXCDNAME)
            return 0;
        question[at++] = static_cast<unsigned char>(length);
        std::memcpy(question + at, name, length);
        at += static_cast<int>(length);
        name += length;
        if (*name == '.') ++name;
    }
    ++at;  // the root
    ns_put16(static_cast<unsigned>(type), question + at);
    ns_put16(static_cast<unsigned>(kind), question + at + NS_INT16SZ);
    return at + NS_QFIXEDSZ;
}

int ask(const char* name, int kind, int type, unsigned char* answer, int room) {
    mark_call("res_query");
    unsigned char question[kLongestQuestion];
    const int size = make_question(std::strcmp(name, ".") == 0 ? "" : name, kind, type, question);
    if (size == 0) return failed(NO_RECOVERY);
    const int got = exchange(question, size, answer, room);
    if (got < 0) return failed(errno == ECONNREFUSED || errno == ETIMEDOUT ? TRY_AGAIN : NETDB_INTERNAL);
    HEADER head;
    std::memcpy(&head, answer, sizeof head);
    if (head.rcode == NXDOMAIN) return failed(HOST_NOT_FOUND);
    if (head.rcode == SERVFAIL) return failed(TRY_AGAIN);
    if (head.rcode != NOERROR) return failed(NO_RECOVERY);
    return head.ancount == 0 ? failed(NO_DATA) : got;
}

/// As the calls with a state of the caller's leave it.
int ask(res_state state, const char* name, int kind, int type, unsigned char* answer, int room) {
    const int got = ask(name, kind, type, answer, room);
    state->res_h_errno = got < 0 ? h_errno : NETDB_SUCCESS;
    return got;
}

/// A name and a domain, either of which may be missing.
bool join(const char* name, const char* domain, char (&whole)[NS_MAXDNAME]) {
    const std::size_t length = std::strlen(name), more = domain != nullptr ? std::strlen(domain) : 0;
    if (length + more + 2 > sizeof whole) return failed(NO_RECOVERY) == 0;
    std::memcpy(whole, name, length);
    whole[length] = '.';
    std::memcpy(whole + length + 1, domain != nullptr ? domain : "", more);
    whole[length + (more > 0 ? more + 1 : 0)] = '\0';
    return true;
}

}  // namespace

SHIM_EXPORT int res_query(const char* name, int kind, int type, unsigned char* answer, int room) noexcept {
    return networked() ? ask(name, kind, type, answer, room)
                       : REAL(res_query)(name, kind, type, answer, room);
}
SHIM_EXPORT int res_search(const char* name, int kind, int type, unsigned char* answer, int room) noexcept {
    return networked() ? ask(name, kind, type, answer, room)
                       : REAL(res_search)(name, kind, type, answer, room);
}
SHIM_EXPORT int res_querydomain(const char* name, const char* domain, int kind, int type,
                                unsigned char* answer, int room) noexcept {
    if (!networked()) return REAL(res_querydomain)(name, domain, kind, type, answer, room);
    char whole[NS_MAXDNAME];
    return join(name, domain, whole) ? ask(whole, kind, type, answer, room) : -1;
}
SHIM_EXPORT int res_send(const unsigned char* question, int size, unsigned char* answer, int room) noexcept {
    return networked() ? exchange(question, size, answer, room)
                       : REAL(res_send)(question, size, answer, room);
}
SHIM_EXPORT int res_nquery(res_state state, const char* name, int kind, int type, unsigned char* answer,
                           int room) noexcept {
    return networked() ? ask(state, name, kind, type, answer, room)
                       : REAL(res_nquery)(state, name, kind, type, answer, room);
}
SHIM_EXPORT int res_nsearch(res_state state, const char* name, int kind, int type, unsigned char* answer,
                            int room) noexcept {
    return networked() ? ask(state, name, kind, type, answer, room)
                       : REAL(res_nsearch)(state, name, kind, type, answer, room);
}
SHIM_EXPORT int res_nquerydomain(res_state state, const char* name, const char* domain, int kind, int type,
                                 unsigned char* answer, int room) noexcept {
    if (!networked()) return REAL(res_nquerydomain)(state, name, domain, kind, type, answer, room);
    char whole[NS_MAXDNAME];
    return join(name, domain, whole) ? ask(state, whole, kind, type, answer, room) : -1;
}
SHIM_EXPORT int res_nsend(res_state state, const unsigned char* question, int size, unsigned char* answer,
                          int room) noexcept {
    return networked() ? exchange(question, size, answer, room)
                       : REAL(res_nsend)(state, question, size, answer, room);
}

/// The C library has read the host's /etc/resolv.conf, past this library.
static void name_server(res_state state) {
    state->nscount = 1;
    state->nsaddr_list[0] = {};
    state->nsaddr_list[0].sin_family = AF_INET;
    state->nsaddr_list[0].sin_addr.s_addr = htonl(wire::kResolver);
    state->nsaddr_list[0].sin_port = htons(NS_DEFAULTPORT);
    state->dnsrch[0] = nullptr;
}
SHIM_EXPORT int __res_ninit(res_state state) noexcept {
    const int result = REAL(__res_ninit)(state);
    if (networked() && result == 0) name_server(state);
    return result;
}
SHIM_EXPORT int __res_init() noexcept {
    const int result = REAL(__res_init)();
    if (networked() && result == 0) name_server(&_res);
    return result;
}

// By the names that programs have from before glibc 2.34.
extern "C" {
#define OLD_NAME(name) __attribute__((visibility("default"), alias(#name))) decltype(::name) __##name;
OLD_NAME(res_query)
OLD_NAME(res_search)
OLD_NAME(res_querydomain)
OLD_NAME(res_send)
OLD_NAME(res_nquery)
OLD_NAME(res_nsearch)
OLD_NAME(res_nquerydomain)
OLD_NAME(res_nsend)
#undef OLD_NAME
}
