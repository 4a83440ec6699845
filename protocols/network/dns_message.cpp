#include "protocols/network/dns_message.h"

#include <algorithm>
#include <charconv>

namespace puckloop::protocols {

namespace {

constexpr std::size_t kHeader = 12, kLongestName = 255, kLongestLabel = 63;
constexpr std::uint16_t kResponse = 0x8000, kAuthoritative = 0x0400, kRecursionWanted = 0x0100,
                        kRecursionDone = 0x0080, kOpcode = 0x7800;
constexpr std::uint16_t kOpt = 41, kOptSize = 1232;
constexpr std::uint32_t kValid = 60;                    // s
constexpr std::uint16_t kFirstName = 0xc000 | kHeader;  // a pointer to the question's name

std::uint16_t word_at(std::string_view octets, std::size_t at) {
    return static_cast<std::uint16_t>(static_cast<unsigned char>(octets[at]) << 8 |
                                      static_cast<unsigned char>(octets[at + 1]));
}

void put_word(std::string& octets, std::uint16_t word) {
    octets += static_cast<char>(word >> 8);
    octets += static_cast<char>(word & 0xff);
}

/// Reads labels from `at` on and moves it behind them; false for what is no name.
bool read_name(std::string_view octets, std::size_t& at, std::string& name) {
    const std::size_t begin = at;
    while (at < octets.size()) {
        const auto length = static_cast<unsigned char>(octets[at++]);
        if (length == 0) return at - begin <= kLongestName;
        if (length > kLongestLabel || length > octets.size() - at) return false;
        if (!name.empty()) name += '.';
        name += octets.substr(at, length);
        at += length;
    }
    return false;
}

char lower(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

}  // namespace

std::optional<DnsQuestion> decode_dns_question(std::string_view datagram) {
    if (datagram.size() < kHeader) return std::nullopt;
    DnsQuestion question;
    question.id = word_at(datagram, 0);
    question.flags = word_at(datagram, 2);
    if ((question.flags & kResponse) != 0) return std::nullopt;
    std::size_t at = kHeader;
    constexpr std::size_t kQuestions = 4, kAdditional = 10, kTypeAndClass = 4;
    if (word_at(datagram, kQuestions) != 1 || !read_name(datagram, at, question.name) ||
        datagram.size() - at < kTypeAndClass)
        return question;
    question.type = word_at(datagram, at);
    question.kind = word_at(datagram, at + 2);
    at += kTypeAndClass;
    question.section = datagram.substr(kHeader, at - kHeader);
    // The root's name, then the type.
    question.extended = word_at(datagram, kAdditional) > 0 && datagram.size() - at > 2 && datagram[at] == 0 &&
                        word_at(datagram, at + 1) == kOpt;
    question.readable = true;
    return question;
}

std::string encode_dns_answer(const DnsQuestion& question, DnsStatus status,
                              const std::optional<std::string>& data, std::uint16_t type) {
    std::string octets;
    put_word(octets, question.id);
    put_word(octets, static_cast<std::uint16_t>(kResponse | kAuthoritative | kRecursionDone |
                                                (question.flags & (kOpcode | kRecursionWanted)) |
                                                static_cast<std::uint16_t>(status)));
    put_word(octets, question.readable ? 1 : 0);
    put_word(octets, data ? 1 : 0);
    put_word(octets, 0);
    put_word(octets, question.extended ? 1 : 0);
    octets += question.section;
    if (data) {
        put_word(octets, kFirstName);
        put_word(octets, type);
        put_word(octets, kDnsInternet);
        put_word(octets, static_cast<std::uint16_t>(kValid >> 16));
        put_word(octets, static_cast<std::uint16_t>(kValid & 0xffff));
        put_word(octets, static_cast<std::uint16_t>(data->size()));
        octets += *data;
    }
    if (question.extended) {
        octets += '\0';
        put_word(octets, kOpt);
        put_word(octets, kOptSize);
        octets.append(6, '\0');  // version and flags, no data
    }
    return octets;
}

std::string dns_data(std::uint32_t address) {
    std::string octets;
    put_word(octets, static_cast<std::uint16_t>(address >> 16));
    put_word(octets, static_cast<std::uint16_t>(address & 0xffff));
    return octets;
}

std::string dns_data(std::string_view name) {
    std::string octets;
    while (!name.empty()) {
        const std::size_t length = std::min({name.find('.'), name.size(), kLongestLabel});
        octets += static_cast<char>(length);
        octets += name.substr(0, length);
        name.remove_prefix(std::min(length + 1, name.size()));
    }
    return octets + '\0';
}

std::optional<std::uint32_t> address_of_pointer(std::string_view name) {
    std::string text(name);
    std::transform(text.begin(), text.end(), text.begin(), lower);
    constexpr std::string_view kReverse = ".in-addr.arpa";
    if (!text.ends_with(kReverse)) return std::nullopt;
    const char* at = text.data();
    const char* const end = at + (text.size() - kReverse.size());
    std::uint32_t address = 0;
    constexpr int kParts = 4, kBits = 8;
    for (int part = 0; part < kParts; ++part) {
        std::uint8_t number = 0;
        if (part > 0 && (at == end || *at++ != '.')) return std::nullopt;
        const auto [next, error] = std::from_chars(at, end, number);
        if (error != std::errc()) return std::nullopt;
        address |= std::uint32_t{number} << (kBits * part);
        at = next;
    }
    return at == end ? std::optional(address) : std::nullopt;
}

}  // namespace puckloop::protocols
