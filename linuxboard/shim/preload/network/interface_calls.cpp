// The interfaces of a board on a network: `lo` and `wlan0`.

#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/network/sockets.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/wire/interfaces.h"

#include <ifaddrs.h>
#include <linux/sockios.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

using namespace puckloop::shim;

namespace puckloop::shim {

namespace {

using wire::Interface;
using wire::kInterfaces;

std::uint32_t address_of(const Interface& one) {
    return one.address(page().network_address);
}
std::uint32_t mask_of(const Interface& one) {
    return one.mask(static_cast<int>(page().network_prefix));
}
std::uint32_t broadcast_of(const Interface& one) {
    return address_of(one) | ~mask_of(one);
}

const Interface* find_interface(const char* name) {
    for (const Interface& one : kInterfaces)
        if (std::strcmp(one.name, name) == 0) return &one;
    return nullptr;
}

void put_place(sockaddr& to, std::uint32_t address) {
    auto& place = reinterpret_cast<sockaddr_in&>(to);
    place = {};
    place.sin_family = AF_INET;
    place.sin_addr.s_addr = htonl(address);
}

int list_interfaces(void* argument) {
    ifconf list{};
    if (!get_from_program(list, argument)) return -1;
    ifreq entries[2] = {};
    std::size_t count = 0;
    for (const Interface& one : kInterfaces) {
        std::strcpy(entries[count].ifr_name, one.name);
        put_place(entries[count++].ifr_addr, address_of(one));
    }
    int size = static_cast<int>(sizeof entries);
    if (list.ifc_req != nullptr) {
        size = std::min(size, std::max(list.ifc_len, 0)) / static_cast<int>(sizeof(ifreq)) *
               static_cast<int>(sizeof(ifreq));
        if (!copy_to_program(list.ifc_req, entries, static_cast<std::size_t>(size))) return -1;
    }
    list.ifc_len = size;
    return put_to_program(argument, list) ? 0 : -1;
}

int ask_interface(unsigned long request, void* argument) {
    ifreq wish{};
    if (!get_from_program(wish, argument)) return -1;
    wish.ifr_name[IFNAMSIZ - 1] = '\0';
    const Interface* found = find_interface(wish.ifr_name);
    if (request == SIOCGIFNAME) {
        for (const Interface& one : kInterfaces)
            if (one.index == wish.ifr_ifindex) found = &one;
    }
    if (found == nullptr) return fail(ENODEV);
    switch (request) {
    case SIOCGIFNAME:
        std::strcpy(wish.ifr_name, found->name);
        break;
    case SIOCGIFADDR:
        put_place(wish.ifr_addr, address_of(*found));
        break;
    case SIOCGIFNETMASK:
        put_place(wish.ifr_netmask, mask_of(*found));
        break;
    case SIOCGIFBRDADDR:
        put_place(wish.ifr_broadaddr, broadcast_of(*found));
        break;
    case SIOCGIFFLAGS:
        wish.ifr_flags = static_cast<short>(found->flags);
        break;
    case SIOCGIFINDEX:
        wish.ifr_ifindex = found->index;
        break;
    case SIOCGIFMTU:
        wish.ifr_mtu = found->mtu;
        break;
    case SIOCGIFMETRIC:
        wish.ifr_metric = 0;
        break;
    case SIOCGIFTXQLEN:
        wish.ifr_qlen = wire::kQueueLength;
        break;
    case SIOCGIFMAP:
        wish.ifr_map = {};
        break;
    case SIOCGIFHWADDR: {
        wish.ifr_hwaddr = {};
        wish.ifr_hwaddr.sa_family = found->is_loopback() ? ARPHRD_LOOPBACK : ARPHRD_ETHER;
        if (found->is_loopback()) break;
        const auto octets = wire::hardware_address(page().network_address);
        std::memcpy(wish.ifr_hwaddr.sa_data, octets.data(), octets.size());
        break;
    }
    default:
        return fail(EINVAL);
    }
    return put_to_program(argument, wish) ? 0 : -1;
}

int queue_of(OpenFile& file, bool unsent, void* argument) {
    wire::Request request;
    request.op = wire::Op::SocketQueue;
    request.handle = file.handle;
    request.a = unsent ? 1 : 0;
    const auto count = static_cast<int>(device_call(request));
    return count >= 0 && put_to_program(argument, count) ? 0 : -1;
}

}  // namespace

int socket_ioctl(OpenFile& file, unsigned long request, void* argument) {
    switch (request) {
    case FIONREAD:
        return queue_of(file, false, argument);
    case TIOCOUTQ:  // SIOCOUTQ
        return queue_of(file, true, argument);
    case SIOCGIFCONF:
        return list_interfaces(argument);
    case SIOCGIFNAME:
    case SIOCGIFADDR:
    case SIOCGIFNETMASK:
    case SIOCGIFBRDADDR:
    case SIOCGIFFLAGS:
    case SIOCGIFINDEX:
    case SIOCGIFMTU:
    case SIOCGIFMETRIC:
    case SIOCGIFTXQLEN:
    case SIOCGIFMAP:
    case SIOCGIFHWADDR:
        return ask_interface(request, argument);
    case SIOCSIFADDR:
    case SIOCSIFNETMASK:
    case SIOCSIFBRDADDR:
    case SIOCSIFFLAGS:
    case SIOCSIFMTU:
    case SIOCSIFHWADDR:
    case SIOCADDRT:
    case SIOCDELRT:
        return fail(EPERM);  // as for a user without rights
    default:
        note("the ioctl 0x%lx of a socket is not carried by the network", request);
        return fail(ENOTTY);
    }
}

}  // namespace puckloop::shim

SHIM_EXPORT int getifaddrs(ifaddrs** list) noexcept {
    if (!networked()) return REAL(getifaddrs)(list);
    charge(page().charges.device);
    struct Entry {
        ifaddrs head;
        sockaddr address, mask, broadcast;
        char name[8];
    };
    // One block, as the C library makes it: its freeifaddrs() frees it.
    constexpr std::size_t kCount = sizeof kInterfaces / sizeof kInterfaces[0];
    auto* entries = static_cast<Entry*>(std::calloc(kCount, sizeof(Entry)));
    if (entries == nullptr) return -1;
    for (std::size_t i = 0; i < kCount; ++i) {
        const Interface& one = kInterfaces[i];
        Entry& entry = entries[i];
        std::strcpy(entry.name, one.name);
        put_place(entry.address, address_of(one));
        put_place(entry.mask, mask_of(one));
        entry.head.ifa_next = i + 1 < kCount ? &entries[i + 1].head : nullptr;
        entry.head.ifa_name = entry.name;
        entry.head.ifa_flags = one.flags;
        entry.head.ifa_addr = &entry.address;
        entry.head.ifa_netmask = &entry.mask;
        if ((one.flags & IFF_BROADCAST) == 0) continue;
        put_place(entry.broadcast, broadcast_of(one));
        entry.head.ifa_broadaddr = &entry.broadcast;
    }
    *list = &entries[0].head;
    return 0;
}

SHIM_EXPORT unsigned if_nametoindex(const char* name) noexcept {
    if (!networked()) return REAL(if_nametoindex)(name);
    const Interface* found = is_text(name) ? find_interface(name) : nullptr;
    if (found == nullptr) errno = ENODEV;
    return found != nullptr ? static_cast<unsigned>(found->index) : 0;
}

SHIM_EXPORT char* if_indextoname(unsigned index, char* name) noexcept {
    if (!networked()) return REAL(if_indextoname)(index, name);
    for (const Interface& one : kInterfaces) {
        if (static_cast<unsigned>(one.index) != index) continue;
        std::strcpy(name, one.name);
        return name;
    }
    errno = ENXIO;
    return nullptr;
}

SHIM_EXPORT struct if_nameindex* if_nameindex() noexcept {
    if (!networked()) return REAL(if_nameindex)();
    constexpr std::size_t kCount = sizeof kInterfaces / sizeof kInterfaces[0];
    // As if_freenameindex() frees it: each name, then the list.
    auto* list = static_cast<struct if_nameindex*>(std::calloc(kCount + 1, sizeof(struct if_nameindex)));
    for (std::size_t i = 0; list != nullptr && i < kCount; ++i)
        list[i] = {static_cast<unsigned>(kInterfaces[i].index), strdup(kInterfaces[i].name)};
    return list;
}
