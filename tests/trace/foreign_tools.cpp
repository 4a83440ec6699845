#include "foreign_tools.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

namespace puckloop::tests {

namespace {

std::vector<std::string> sigrok(const std::string& sr, const std::string& decoder,
                                const std::string& annotations) {
    const Called called = shell(fmt::format("sigrok-cli -i {} -P {} -A {}", sr, decoder, annotations));
    REQUIRE(called.status == 0);
    std::vector<std::string> lines;
    for (const std::string& line : lines_of(called.out))
        lines.push_back(line.substr(line.find(": ") + 2));
    return lines;
}

std::string uart(const std::string& line, unsigned baud, const std::string& parity) {
    return fmt::format("uart:rx={}:baudrate={}:parity={}", line, baud, parity);
}

}  // namespace

std::vector<unsigned> sigrok_uart(const std::string& sr, const std::string& line, unsigned baud,
                                  const std::string& parity) {
    std::vector<unsigned> bytes;
    for (const std::string& text : sigrok(sr, uart(line, baud, parity), "uart=rx-data"))
        bytes.push_back(static_cast<unsigned>(std::stoul(text, nullptr, 16)));
    return bytes;
}

std::size_t sigrok_uart_count(const std::string& sr, const std::string& line, unsigned baud,
                              const std::string& parity, const std::string& annotation) {
    return sigrok(sr, uart(line, baud, parity), "uart=" + annotation).size();
}

std::vector<std::string> sigrok_i2c(const std::string& sr, const std::string& bus) {
    std::vector<std::string> words;
    for (const std::string& text :
         sigrok(sr, fmt::format("i2c:scl={0}/scl:sda={0}/sda", bus), "i2c=addr-data")) {
        const std::size_t colon = text.find(": ");
        if (text.starts_with("Start")) words.push_back("S");
        if (text == "Stop") words.push_back("P");
        if (text == "ACK") words.push_back("A");
        if (text == "NACK") words.push_back("N");
        if (text.starts_with("Address")) words.push_back("a" + text.substr(colon + 2));
        if (text.starts_with("Data write")) words.push_back("W" + text.substr(colon + 2));
        if (text.starts_with("Data read")) words.push_back("R" + text.substr(colon + 2));
    }
    return words;
}

std::vector<std::string> tshark(const std::string& pcapng, const std::string& filter,
                                const std::string& fields) {
    const Called called =
        shell(fmt::format("tshark -r {} -Y '{}' -T fields {} 2>/dev/null", pcapng, filter, fields));
    REQUIRE(called.status == 0);
    return lines_of(called.out);
}

}  // namespace puckloop::tests
