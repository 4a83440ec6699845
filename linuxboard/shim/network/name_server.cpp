#include "linuxboard/shim/network/name_server.h"

#include "protocols/network/dns_message.h"

#include <algorithm>

namespace puckloop::linuxboard {

using protocols::DnsStatus;

namespace {
std::string in_small_letters(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return text;
}
}  // namespace

NameServer::NameServer(const NetworkSpec& spec) {
    constexpr protocols::IpAddress kLoopbackAddress = 0x7f000001;
    addresses_["localhost"] = kLoopbackAddress;
    names_[kLoopbackAddress] = "localhost";
    for (const NetworkName& one : spec.names) {
        const auto address = protocols::address_of(one.address);
        if (!address) continue;  // place_of() reports it
        addresses_.emplace(in_small_letters(one.name), *address);
        names_.emplace(*address, one.name);
    }
}

std::optional<NameServer::Answer> NameServer::answer(std::string_view datagram) const {
    const auto question = protocols::decode_dns_question(datagram);
    if (!question) return std::nullopt;
    Answer answer;
    answer.name = question->name;
    const auto refuse = [&](DnsStatus status) {
        answer.datagram = protocols::encode_dns_answer(*question, status);
        return answer;
    };
    if (!question->readable) return refuse(DnsStatus::BadFormat);
    if (question->opcode() != 0) return refuse(DnsStatus::NotImplemented);
    if (question->kind != protocols::kDnsInternet && question->kind != protocols::kDnsAny)
        return refuse(DnsStatus::Refused);
    const bool all = question->type == protocols::kDnsAny;
    std::optional<std::string> data;
    bool known = false;
    std::uint16_t type = protocols::kDnsAddress;
    if (const auto pointer = protocols::address_of_pointer(question->name)) {
        type = protocols::kDnsPointer;
        const auto found = names_.find(*pointer);
        known = found != names_.end();
        if (known) data = protocols::dns_data(found->second);
    } else {
        const auto found = addresses_.find(in_small_letters(question->name));
        known = found != addresses_.end();
        if (known) data = protocols::dns_data(found->second);
    }
    if (!known) {
        answer.unknown = true;
        return refuse(DnsStatus::NoSuchName);
    }
    if (!all && question->type != type) data.reset();  // the name is known, such a record of it is not
    answer.datagram = protocols::encode_dns_answer(*question, DnsStatus::Ok, data, type);
    return answer;
}

}  // namespace puckloop::linuxboard
