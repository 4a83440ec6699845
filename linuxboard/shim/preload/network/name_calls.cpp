// Names of computers: getaddrinfo() and its older kin know the computers of the run's network and no others;
// no name server is asked. Where a fault is about names, those of other computers are as if one were: the
// node decides whether an answer comes.

#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/network/sockets.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <strings.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

using namespace puckloop::shim;

namespace puckloop::shim {

bool is_numeric(const char* text, std::uint32_t& address) {
    in_addr found{};
    if (inet_aton(text, &found) == 0) return false;
    address = ntohl(found.s_addr);
    return true;
}

namespace {
/// Without regard to case, and to the dot of a name that is complete.
bool same_name(const char* name, const char* known) {
    const std::size_t length = std::strlen(known);
    if (strncasecmp(name, known, length) != 0 || length == 0) return false;
    return name[length] == '\0' || std::strcmp(name + length, ".") == 0;
}
}  // namespace

std::uint32_t address_of_name(const char* name) {
    if (same_name(name, "localhost")) return INADDR_LOOPBACK;
    for (std::uint32_t i = 0; i < page().host_count; ++i)
        if (same_name(name, page().hosts[i].name)) return page().hosts[i].address;
    if (same_name(name, page().host_name)) return page().network_address;
    return 0;
}

const char* name_of_address(std::uint32_t address) {
    if (address == INADDR_LOOPBACK) return "localhost";
    for (std::uint32_t i = 0; i < page().host_count; ++i)
        if (page().hosts[i].address == address) return page().hosts[i].name;
    return nullptr;
}

}  // namespace puckloop::shim

namespace {

struct Service {
    std::uint16_t port = 0;  // of the host's byte order
    int type = 0;            // 0: any
};

/// A port's number or name; an error of getaddrinfo(), or 0.
int find_service(const char* name, int flags, int type, Service& service) {
    if (name == nullptr) return 0;
    char* end = nullptr;
    const unsigned long number = std::strtoul(name, &end, 10);
    if (*name != '\0' && *end == '\0') {
        service.port = static_cast<std::uint16_t>(number);
        return number <= 0xffff ? 0 : EAI_SERVICE;
    }
    if ((flags & AI_NUMERICSERV) != 0) return EAI_NONAME;
    servent entry{}, *found = nullptr;
    char buffer[1024];
    const char* protocol = type == SOCK_DGRAM ? "udp" : "tcp";
    if (getservbyname_r(name, protocol, &entry, buffer, sizeof buffer, &found) != 0 || found == nullptr)
        return EAI_SERVICE;
    service.port = ntohs(static_cast<std::uint16_t>(found->s_port));
    return 0;
}

constexpr std::size_t kLongestName = 253;  // RFC 1035

bool is_of_board(std::uint32_t address) {
    return address == INADDR_LOOPBACK || address == page().network_address;
}

int find_node(const char* node, int flags, std::uint32_t& address) {
    if (node == nullptr) {
        address = (flags & AI_PASSIVE) != 0 ? INADDR_ANY : INADDR_LOOPBACK;
        return 0;
    }
    if (is_numeric(node, address)) return 0;
    if ((flags & AI_NUMERICHOST) != 0) return EAI_NONAME;
    address = address_of_name(node);
    if (page().asks_for_names != 0 && !is_of_board(address)) {
        wire::Request request;
        request.op = wire::Op::Resolve;
        if (device_call(request, node, std::min<std::size_t>(std::strlen(node), kLongestName)) < 0)
            return EAI_AGAIN;
    }
    if (address != 0) return 0;
    note("no computer of the network has the name '%.100s'", node);
    return EAI_NONAME;
}

struct Kind {
    int type;
    int protocol;
};
constexpr Kind kKinds[] = {{SOCK_STREAM, IPPROTO_TCP}, {SOCK_DGRAM, IPPROTO_UDP}, {SOCK_RAW, IPPROTO_IP}};

sockaddr_in place_of(std::uint32_t address, std::uint16_t port) {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_port = htons(port);
    place.sin_addr.s_addr = htonl(address);
    return place;
}

/// IPv6 by number: known, as of any C library, though no socket can have it.
bool find_six(const char* node, const addrinfo& wish, std::uint16_t port, sockaddr_in6& place) {
    if (wish.ai_family == AF_INET || (wish.ai_family == AF_UNSPEC && node == nullptr)) return false;
    place = {};
    place.sin6_family = AF_INET6;
    place.sin6_port = htons(port);
    if (node != nullptr) return inet_pton(AF_INET6, node, &place.sin6_addr) == 1;
    place.sin6_addr = (wish.ai_flags & AI_PASSIVE) != 0 ? in6addr_any : in6addr_loopback;
    return true;
}

/// As the C library makes it, so that its freeaddrinfo() frees it.
template <typename Place>
addrinfo* new_entry(const Kind& kind, int family, const Place& place) {
    auto* memory = static_cast<char*>(std::malloc(sizeof(addrinfo) + sizeof place));
    if (memory == nullptr) return nullptr;
    auto* entry = reinterpret_cast<addrinfo*>(memory);
    std::memcpy(memory + sizeof(addrinfo), &place, sizeof place);
    *entry = {};
    entry->ai_family = family;
    entry->ai_socktype = kind.type;
    entry->ai_protocol = kind.protocol;
    entry->ai_addrlen = sizeof place;
    entry->ai_addr = reinterpret_cast<sockaddr*>(memory + sizeof(addrinfo));
    return entry;
}

}  // namespace

SHIM_EXPORT int getaddrinfo(const char* node, const char* service, const addrinfo* hints,
                            addrinfo** results) {
    if (!networked()) return REAL(getaddrinfo)(node, service, hints, results);
    mark_call("getaddrinfo");
    charge(page().charges.device);
    const addrinfo none{};
    const addrinfo& wish = hints != nullptr ? *hints : none;
    if (node == nullptr && service == nullptr) return EAI_NONAME;
    if (wish.ai_family != AF_UNSPEC && wish.ai_family != AF_INET && wish.ai_family != AF_INET6)
        return EAI_FAMILY;
    if ((wish.ai_flags & AI_CANONNAME) != 0 && node == nullptr) return EAI_BADFLAGS;
    Service port;
    if (const int error = find_service(service, wish.ai_flags, wish.ai_socktype, port)) return error;
    std::uint32_t address = 0;
    sockaddr_in6 six{};
    const bool is_six = find_six(node, wish, port.port, six);
    if (!is_six) {
        if (const int error = find_node(node, wish.ai_flags, address)) return error;
        if (wish.ai_family == AF_INET6) return EAI_ADDRFAMILY;
    }
    addrinfo* first = nullptr;
    addrinfo** next = &first;
    for (const Kind& kind : kKinds) {
        if (wish.ai_socktype != 0 && wish.ai_socktype != kind.type) continue;
        const bool given = wish.ai_protocol != 0 && kind.type != SOCK_RAW;
        if (given && wish.ai_protocol != kind.protocol) continue;
        *next =
            is_six ? new_entry(kind, AF_INET6, six) : new_entry(kind, AF_INET, place_of(address, port.port));
        if (*next == nullptr) {
            freeaddrinfo(first);
            return EAI_MEMORY;
        }
        next = &(*next)->ai_next;
    }
    if (first == nullptr) return wish.ai_socktype != 0 ? EAI_SOCKTYPE : EAI_SERVICE;
    if ((wish.ai_flags & AI_CANONNAME) != 0) first->ai_canonname = strdup(node);
    *results = first;
    return 0;
}

SHIM_EXPORT int getnameinfo(const sockaddr* address, socklen_t length, char* host, socklen_t host_size,
                            char* service, socklen_t service_size, int flags) {
    if (!networked() || address == nullptr || address->sa_family != AF_INET)
        return REAL(getnameinfo)(address, length, host, host_size, service, service_size, flags);
    charge(page().charges.device);
    if (length < sizeof(sockaddr_in)) return EAI_FAMILY;
    const auto* place = reinterpret_cast<const sockaddr_in*>(address);
    if (host != nullptr && host_size > 0) {
        const char* name =
            (flags & NI_NUMERICHOST) != 0 ? nullptr : name_of_address(ntohl(place->sin_addr.s_addr));
        if (name == nullptr && (flags & NI_NAMEREQD) != 0) return EAI_NONAME;
        char number[INET_ADDRSTRLEN];
        if (name == nullptr) name = inet_ntop(AF_INET, &place->sin_addr, number, sizeof number);
        if (std::strlen(name) >= host_size) return EAI_OVERFLOW;
        std::strcpy(host, name);
    }
    if (service != nullptr && service_size > 0) {
        servent entry{}, *found = nullptr;
        char buffer[1024];
        if ((flags & NI_NUMERICSERV) == 0)
            getservbyport_r(place->sin_port, (flags & NI_DGRAM) != 0 ? "udp" : "tcp", &entry, buffer,
                            sizeof buffer, &found);
        const int size = found != nullptr
                             ? std::snprintf(service, service_size, "%s", found->s_name)
                             : std::snprintf(service, service_size, "%u", ntohs(place->sin_port));
        if (size >= static_cast<int>(service_size)) return EAI_OVERFLOW;
    }
    return 0;
}

namespace {

/// Everything that a hostent points to, in the caller's buffer; ERANGE if it is too small.
int fill(const char* name, std::uint32_t address, hostent* entry, char* buffer, std::size_t size) {
    struct Room {
        char* addresses[2];
        char* aliases[1];
        in_addr number;
    };
    const std::size_t shift =
        (alignof(Room) - reinterpret_cast<std::uintptr_t>(buffer) % alignof(Room)) % alignof(Room);
    const std::size_t length = std::strlen(name) + 1;
    if (size < shift + sizeof(Room) + length) return ERANGE;
    auto* room = reinterpret_cast<Room*>(buffer + shift);
    char* text = buffer + shift + sizeof(Room);
    std::memcpy(text, name, length);
    room->number.s_addr = htonl(address);
    room->addresses[0] = reinterpret_cast<char*>(&room->number);
    room->addresses[1] = nullptr;
    room->aliases[0] = nullptr;
    *entry = {text, room->aliases, AF_INET, sizeof room->number, room->addresses};
    return 0;
}

int find_host(const char* name, int family, hostent* entry, char* buffer, std::size_t size, hostent** result,
              int* error) {
    charge(page().charges.device);
    *result = nullptr;
    std::uint32_t address = 0;
    const int failed = family == AF_INET ? find_node(name, 0, address) : EAI_NONAME;
    if (failed != 0) {
        *error = h_errno = failed == EAI_AGAIN ? TRY_AGAIN : HOST_NOT_FOUND;
        return 0;
    }
    const int full = fill(name, address, entry, buffer, size);
    if (full != 0) {
        *error = NETDB_INTERNAL;
        return full;
    }
    *result = entry;
    return 0;
}

hostent* keep(int (*find)(void*, hostent*, char*, std::size_t, hostent**, int*), void* what) {
    static hostent entry;
    static char buffer[512];
    hostent* result = nullptr;
    int error = 0;
    find(what, &entry, buffer, sizeof buffer, &result, &error);
    if (result == nullptr) h_errno = error;
    return result;
}

int find_by_address(const void* address, socklen_t length, int family, hostent* entry, char* buffer,
                    std::size_t size, hostent** result, int* error) {
    charge(page().charges.device);
    *result = nullptr;
    in_addr number{};
    const bool known = family == AF_INET && length == sizeof number && get_from_program(number, address);
    const char* name = known ? name_of_address(ntohl(number.s_addr)) : nullptr;
    if (name == nullptr) {
        *error = h_errno = HOST_NOT_FOUND;
        return 0;
    }
    const int full = fill(name, ntohl(number.s_addr), entry, buffer, size);
    if (full == 0) *result = entry;
    return full;
}

}  // namespace

SHIM_EXPORT int gethostbyname2_r(const char* name, int family, hostent* entry, char* buffer, size_t size,
                                 hostent** result, int* error) {
    if (!networked()) return REAL(gethostbyname2_r)(name, family, entry, buffer, size, result, error);
    return find_host(name, family, entry, buffer, size, result, error);
}

SHIM_EXPORT int gethostbyname_r(const char* name, hostent* entry, char* buffer, size_t size, hostent** result,
                                int* error) {
    if (!networked()) return REAL(gethostbyname_r)(name, entry, buffer, size, result, error);
    return find_host(name, AF_INET, entry, buffer, size, result, error);
}

SHIM_EXPORT hostent* gethostbyname(const char* name) {
    if (!networked()) return REAL(gethostbyname)(name);
    return keep(
        [](void* what, hostent* entry, char* buffer, std::size_t size, hostent** result, int* error) {
            return find_host(static_cast<const char*>(what), AF_INET, entry, buffer, size, result, error);
        },
        const_cast<char*>(name));
}

SHIM_EXPORT hostent* gethostbyname2(const char* name, int family) {
    if (!networked()) return REAL(gethostbyname2)(name, family);
    if (family == AF_INET) return gethostbyname(name);
    h_errno = HOST_NOT_FOUND;
    return nullptr;
}

SHIM_EXPORT int gethostbyaddr_r(const void* address, socklen_t length, int family, hostent* entry,
                                char* buffer, size_t size, hostent** result, int* error) {
    if (!networked())
        return REAL(gethostbyaddr_r)(address, length, family, entry, buffer, size, result, error);
    return find_by_address(address, length, family, entry, buffer, size, result, error);
}

SHIM_EXPORT hostent* gethostbyaddr(const void* address, socklen_t length, int family) {
    if (!networked()) return REAL(gethostbyaddr)(address, length, family);
    if (family != AF_INET || length != sizeof(in_addr)) {
        h_errno = HOST_NOT_FOUND;
        return nullptr;
    }
    return keep(
        [](void* what, hostent* entry, char* buffer, std::size_t size, hostent** result, int* error) {
            return find_by_address(what, sizeof(in_addr), AF_INET, entry, buffer, size, result, error);
        },
        const_cast<void*>(address));
}
