#pragma once
// Messages of the domain name system as they are in a datagram (RFC 1035, 4; RFC 6891): questions as servers
// read them, and their answers.
//
// Deviations: 1. One question in a message, as everybody sends. 2. Addresses and names are the only data of
// answers; nothing is truncated, as nothing is long.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace puckloop::protocols {

inline constexpr std::uint16_t kDnsPort = 53;
inline constexpr std::uint16_t kDnsAddress = 1, kDnsPointer = 12, kDnsAny = 255;  ///< A, PTR, all kinds
inline constexpr std::uint16_t kDnsInternet = 1;                                  ///< class IN

/// RCODE.
enum class DnsStatus : std::uint8_t {
    Ok = 0,
    BadFormat = 1,
    NoSuchName = 3,
    NotImplemented = 4,
    Refused = 5
};

struct DnsQuestion {
    std::uint16_t id = 0;
    std::uint16_t flags = 0;  ///< the header's
    bool readable = false;    ///< what follows is there; else the format is bad
    std::string name;         ///< labels with dots between, as they were written
    std::uint16_t type = 0, kind = 0;
    std::string section;    ///< octets of name, type and class
    bool extended = false;  ///< with an OPT record (RFC 6891)

    /// 0 is a query, all else something that nobody here does.
    int opcode() const { return flags >> 11 & 0xf; }
};

/// Nothing for what is no question at all, which nobody answers.
std::optional<DnsQuestion> decode_dns_question(std::string_view datagram);

/// With `data` an answer of the type asked for (of `type`, where all were), valid for a minute.
std::string encode_dns_answer(const DnsQuestion& question, DnsStatus status,
                              const std::optional<std::string>& data = std::nullopt,
                              std::uint16_t type = kDnsAddress);

/// Data of an answer: four octets, and a name's labels.
std::string dns_data(std::uint32_t address);
std::string dns_data(std::string_view name);

/// The address that a name such as 1.0.0.10.in-addr.arpa asks for.
std::optional<std::uint32_t> address_of_pointer(std::string_view name);

}  // namespace puckloop::protocols
