#include "emu/image/intel_hex.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace puckloop::image {

namespace {

enum RecordType : std::uint8_t {
    Data = 0,
    EndOfFile = 1,
    ExtendedSegmentAddress = 2,
    StartSegmentAddress = 3,
    ExtendedLinearAddress = 4,
    StartLinearAddress = 5,
};

constexpr std::size_t kRecordOverhead = 5;  // length, two of address, type, checksum
constexpr std::uint32_t kOffsetSpan = 0x10000;

struct Record {
    std::uint32_t offset = 0;
    std::uint8_t type = 0;
    std::vector<std::uint8_t> data;
};

std::optional<unsigned> hex_digit(char c) {
    if (c >= '0' && c <= '9') return static_cast<unsigned>(c - '0');
    if (c >= 'a' && c <= 'f') return static_cast<unsigned>(c - 'a' + 10);
    if (c >= 'A' && c <= 'F') return static_cast<unsigned>(c - 'A' + 10);
    return std::nullopt;
}

std::string printable(char c) {
    return c >= ' ' && c <= '~' ? fmt::format("'{}'", c)
                                : fmt::format("byte 0x{:02X}", static_cast<unsigned char>(c));
}

class HexReader {
  public:
    HexReader(std::string_view text, std::string_view file) : text_(text), file_(file), segments_(file) {}

    std::vector<ByteSegment> read() {
        while (position_ < text_.size()) {
            const std::string_view line = next_line();
            if (line.empty()) continue;
            if (ended_) fail("a record after the end-of-file record", "the file to end there");
            apply(parse(line));
        }
        if (!ended_) fail("the file ends without an end-of-file record", ":00000001FF as last line");
        return segments_.joined();
    }

  private:
    std::string place() const { return fmt::format("line {}", line_number_); }
    [[noreturn]] void fail(std::string_view problem, std::string_view expected) const {
        throw InputError(file_, place(), problem, expected);
    }

    std::string_view next_line() {
        const std::size_t newline = text_.find('\n', position_);
        const std::size_t end = newline == std::string_view::npos ? text_.size() : newline;
        std::string_view line = text_.substr(position_, end - position_);
        position_ = end + 1;
        ++line_number_;
        while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t'))
            line.remove_suffix(1);
        return line;
    }

    Record parse(std::string_view line) const {
        if (line.front() != ':') fail(fmt::format("the line begins with {}", printable(line.front())), "':'");
        line.remove_prefix(1);
        std::vector<std::uint8_t> bytes;
        for (std::size_t i = 0; i < line.size(); ++i) {
            const std::optional<unsigned> digit = hex_digit(line[i]);
            if (!digit)
                fail(fmt::format("{} in column {}", printable(line[i]), i + 2), "a hexadecimal digit");
            if (i % 2 == 0)
                bytes.push_back(static_cast<std::uint8_t>(*digit << 4));
            else
                bytes.back() = static_cast<std::uint8_t>(bytes.back() | *digit);
        }
        if (line.size() % 2 != 0) fail("an odd number of digits", "two a byte");
        if (bytes.size() < kRecordOverhead)
            fail(fmt::format("a record of {} bytes", bytes.size()), "at least 5: the line is cut short");
        if (bytes.size() != kRecordOverhead + bytes[0])
            fail(fmt::format("{} data bytes where the record states {}", bytes.size() - kRecordOverhead,
                             bytes[0]),
                 "both to agree");
        unsigned sum = 0;
        for (const std::uint8_t byte : bytes)
            sum += byte;
        if ((sum & 0xFF) != 0)
            fail(fmt::format("checksum 0x{:02X} is wrong", bytes.back()),
                 fmt::format("0x{:02X}", (bytes.back() - sum) & 0xFF));
        Record record;
        record.offset = static_cast<std::uint32_t>(bytes[1] << 8 | bytes[2]);
        record.type = bytes[3];
        record.data.assign(bytes.begin() + 4, bytes.end() - 1);
        return record;
    }

    void need_length(const Record& record, std::size_t length) const {
        if (record.data.size() != length)
            fail(fmt::format("a record of type {:02X} with {} data bytes", record.type, record.data.size()),
                 fmt::format("{}", length));
    }

    void apply(Record record) {
        switch (record.type) {
        case Data:
            if (segmented_ && record.offset + record.data.size() > kOffsetSpan)
                fail("a data record runs past the end of its 64 KB segment", "a further segment record");
            segments_.add(base_ + record.offset, std::move(record.data), place());
            break;
        case EndOfFile:
            need_length(record, 0);
            ended_ = true;
            break;
        case ExtendedSegmentAddress:
            need_length(record, 2);
            base_ = static_cast<std::uint64_t>(record.data[0] << 8 | record.data[1]) << 4;
            segmented_ = true;
            break;
        case ExtendedLinearAddress:
            need_length(record, 2);
            base_ = static_cast<std::uint64_t>(record.data[0] << 8 | record.data[1]) << 16;
            segmented_ = false;
            break;
        case StartSegmentAddress:
        case StartLinearAddress:
            need_length(record, 4);
            break;
        default:
            fail(fmt::format("record type {:02X}", record.type), "00 to 05");
        }
    }

    std::string_view text_;
    std::string_view file_;
    std::size_t position_ = 0;
    std::size_t line_number_ = 0;
    std::uint64_t base_ = 0;
    bool segmented_ = false;
    bool ended_ = false;
    ByteSegments segments_;
};

void append_record(std::string& text, std::uint32_t offset, RecordType type, const std::uint8_t* data,
                   std::size_t length) {
    unsigned sum = static_cast<unsigned>(length) + (offset >> 8) + (offset & 0xFF) + type;
    text += fmt::format(":{:02X}{:04X}{:02X}", length, offset, static_cast<unsigned>(type));
    for (std::size_t i = 0; i < length; ++i) {
        sum += data[i];
        text += fmt::format("{:02X}", data[i]);
    }
    text += fmt::format("{:02X}\n", (0u - sum) & 0xFF);
}

}  // namespace

std::vector<ByteSegment> parse_intel_hex(std::string_view text, std::string_view file) {
    return HexReader(text, file).read();
}

std::string write_intel_hex(const std::vector<ByteSegment>& segments) {
    constexpr std::size_t kRecordBytes = 16;
    std::string text;
    std::uint64_t bank = 0;
    for (const ByteSegment& segment : segments) {
        std::size_t done = 0;
        while (done < segment.bytes.size()) {
            const std::uint64_t address = segment.address + done;
            if (address / kOffsetSpan != bank) {
                bank = address / kOffsetSpan;
                const std::uint8_t high[2] = {static_cast<std::uint8_t>(bank >> 8),
                                              static_cast<std::uint8_t>(bank)};
                append_record(text, 0, ExtendedLinearAddress, high, 2);
            }
            const std::uint64_t until_aligned = kRecordBytes - address % kRecordBytes;
            const std::size_t length = std::min<std::size_t>(until_aligned, segment.bytes.size() - done);
            append_record(text, static_cast<std::uint32_t>(address % kOffsetSpan), Data, &segment.bytes[done],
                          length);
            done += length;
        }
    }
    append_record(text, 0, EndOfFile, nullptr, 0);
    return text;
}

std::string write_dspic_hex(const std::map<std::uint32_t, std::uint32_t>& words) {
    std::vector<ByteSegment> segments;
    for (const auto& [address, word] : words) {
        const std::uint64_t byte_address = std::uint64_t{address} * 2;
        if (segments.empty() || segments.back().end() != byte_address) segments.push_back({byte_address, {}});
        for (const unsigned shift : {0u, 8u, 16u})
            segments.back().bytes.push_back(static_cast<std::uint8_t>(word >> shift));
        segments.back().bytes.push_back(0);
    }
    return write_intel_hex(segments);
}

}  // namespace puckloop::image
