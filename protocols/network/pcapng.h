#pragma once
// pcapng's blocks: section header, one interface description for each sender, one enhanced packet for each
// packet (draft-ietf-opsawg-pcapng). Little-endian, padded to 32 bits; times in nanoseconds.

#include <cstdint>
#include <map>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::pcapng {

using Bytes = std::vector<std::uint8_t>;

/// By the numbers of www.tcpdump.org/linktypes.html.
enum class LinkType : std::uint16_t {
    Radiotap = 127,
    Radio = 195,
    I2c = 209,
    Can = 227,
    Ip4 = 228,
    Uart = 250,
    Export = 252
};
enum : std::uint32_t { kSection = 0x0A0D0D0A, kInterface = 1, kPacket = 6 };
enum : std::uint16_t { kEnd = 0, kComment = 1, kName = 2, kResolution = 9 };

inline void little(Bytes& out, std::uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i)
        out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

inline void pad(Bytes& out) {
    while (out.size() % 4 != 0)
        out.push_back(0);
}

inline void option(Bytes& out, std::uint16_t code, std::string_view value) {
    little(out, code, 2);
    little(out, value.size(), 2);
    out.insert(out.end(), value.begin(), value.end());
    pad(out);
}

/// Writes each block as it comes and keeps none.
class Writer {
  public:
    explicit Writer(std::ostream& out) : out_(out) {
        Bytes body;
        little(body, 0x1A2B3C4D, 4);
        little(body, 1, 2);
        little(body, 0, 2);
        little(body, ~std::uint64_t{0}, 8);  // length of the section: not given
        block(kSection, body);
    }

    std::uint32_t interface(const std::string& name, LinkType type) {
        const auto [found, is_new] = interfaces_.try_emplace(name, interfaces_.size());
        if (is_new) {
            Bytes body;
            little(body, static_cast<std::uint16_t>(type), 2);
            little(body, 0, 2);
            little(body, 0, 4);  // no limit of length
            option(body, kName, name);
            option(body, kResolution, "\x09");  // 1e-9 s
            option(body, kEnd, "");
            block(kInterface, body);
        }
        return found->second;
    }

    void packet(std::uint32_t interface, std::uint64_t nanoseconds, const Bytes& data,
                std::string_view comment = {}) {
        Bytes body;
        little(body, interface, 4);
        little(body, nanoseconds >> 32, 4);
        little(body, nanoseconds & 0xffffffff, 4);
        little(body, data.size(), 4);
        little(body, data.size(), 4);
        body.insert(body.end(), data.begin(), data.end());
        pad(body);
        if (!comment.empty()) {
            option(body, kComment, comment);
            option(body, kEnd, "");
        }
        block(kPacket, body);
    }

  private:
    void block(std::uint32_t type, const Bytes& body) {
        constexpr std::size_t kFrame = 12;
        Bytes all;
        little(all, type, 4);
        little(all, body.size() + kFrame, 4);
        all.insert(all.end(), body.begin(), body.end());
        little(all, body.size() + kFrame, 4);
        out_.write(reinterpret_cast<const char*>(all.data()), static_cast<std::streamsize>(all.size()));
    }

    std::ostream& out_;
    std::map<std::string, std::uint32_t> interfaces_;
};

}  // namespace puckloop::pcapng
