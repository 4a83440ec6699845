#include "tests/framing/record_traffic.h"

#include <catch2/catch.hpp>

#include <algorithm>

namespace puckloop::framing {

using tests::Row;
using tests::Workbench;

namespace {

constexpr double kSilence = 0.020;  // s

bool from_linux(const Row& row) {
    return row.at("from") == "robot0.linux";
}

/// Bytes on one way, as its receiver counts them into records.
struct Way {
    std::size_t bytes = 0;
    double last = 0;
    void arrive(double start, bool forgets) {
        if (forgets && start - last > kSilence) bytes = 0;
        last = start;
        ++bytes;
    }
};

}  // namespace

std::vector<Row> uart_rows(const Workbench& bench, const std::string& name) {
    std::vector<Row> rows = bench.csv(name, "trace.csv");
    std::erase_if(rows, [](const Row& row) { return row.at("kind") != "uart"; });
    return rows;
}

std::vector<Byte> bytes_of(const std::vector<Row>& rows, std::size_t record) {
    std::vector<Byte> bytes;
    std::size_t sent = 0, heard = 0;
    for (const Row& row : rows) {
        const bool to_pic = from_linux(row);
        const std::size_t ordinal = to_pic ? sent++ : heard++;
        if (to_pic && ordinal < kHello) continue;
        const std::size_t size = to_pic ? kActuatorBytes : kSensorBytes;
        const std::size_t at = to_pic ? ordinal - kHello : ordinal;
        if (at / size == record) bytes.push_back({to_pic, at % size, std::stod(row.at("start_s"))});
    }
    REQUIRE(bytes.size() == kActuatorBytes + kSensorBytes);
    std::stable_sort(bytes.begin(), bytes.end(),
                     [](const Byte& a, const Byte& b) { return a.to_pic > b.to_pic; });
    return bytes;
}

Outcome judge(const std::vector<Row>& rows, const Forgets& forgets, double fault_s, double end_s) {
    Outcome out;
    Way to_pic, from_pic;
    std::size_t hello = 0;
    bool answering = false, sending = false;  // a record of that side has begun
    double last_pic = fault_s;
    for (const Row& row : rows) {
        const double start = std::stod(row.at("start_s"));
        const bool late = start > end_s - 0.5;
        if (from_linux(row)) {
            out.linux_goes_on = out.linux_goes_on || late;
            // The program begins a record: it has taken whole sensor records only, or has some bytes left
            // over.
            if (late && !sending && from_pic.bytes % kSensorBytes != 0) out.shifted = true;
            sending = true;
            answering = false;
            if (row.at("fault") != "drop" && ++hello > kHello) to_pic.arrive(start, forgets.pic);
            continue;
        }
        out.pic_goes_on = out.pic_goes_on || late;
        if (late && !answering && to_pic.bytes % kActuatorBytes != 0) out.shifted = true;
        answering = true;
        sending = false;
        if (row.at("fault") != "drop") from_pic.arrive(start, forgets.linux);
        if (start > fault_s) {
            out.gap = std::max(out.gap, start - last_pic);
            last_pic = start;
        }
    }
    out.gap = std::max(out.gap, end_s - last_pic);
    return out;
}

}  // namespace puckloop::framing
